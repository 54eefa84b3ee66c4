"""The scripts in `vmesh/web/dist`, which pages run, and the modules that they are built of."""

from __future__ import annotations

import gzip
import re
import shutil
from pathlib import Path
from typing import Final

import pytest

from tests.web.node import ROOT, need_package, run_node

DIST: Final = ROOT / "vmesh" / "web" / "dist"
CONFORMANCE: Final = ROOT / "spec" / "conformance"
NAMES: Final = ("page.js", "report.js", "vmesh-image.js", "vmesh.js")


def test_the_scripts_are_those_that_the_modules_build(tmp_path: Path) -> None:
    need_package("esbuild")
    run_node(ROOT / "tests" / "web" / "build.js", tmp_path)
    built = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    kept = {path.name: path.read_bytes() for path in DIST.iterdir()}
    assert tuple(sorted(built)) == NAMES
    assert built == kept, "run: npm run --prefix tests/web build"


@pytest.mark.parametrize(("name", "most"), [("vmesh.js", 9000), ("vmesh-image.js", 13_000)])
def test_the_scripts_for_pages_of_others_are_small(name: str, most: int) -> None:
    assert len(gzip.compress((DIST / name).read_bytes(), 9)) <= most


@pytest.mark.parametrize("name", NAMES)
def test_a_script_may_stand_in_a_page(name: str) -> None:
    text = (DIST / name).read_text("utf-8")
    assert not re.search(r"</script|<!--", text, re.IGNORECASE)


def test_the_built_decoder_agrees_with_its_modules_on_all_conformance_files() -> None:
    files = sorted(CONFORMANCE.rglob("*.vmesh"))
    printed = run_node(ROOT / "tests" / "web" / "compare.js", *files)
    assert printed.strip() == f"{len(files)} files"


@pytest.mark.parametrize("name", ["vmesh-image.js", "vmesh-image.mjs"])
def test_the_script_of_the_element_does_nothing_on_a_server(tmp_path: Path, name: str) -> None:
    shutil.copy(DIST / "vmesh-image.js", tmp_path / name)
    (tmp_path / "server.mjs").write_text(f"await import('./{name}'); console.log('imported');")
    assert run_node(tmp_path / "server.mjs").strip() == "imported"


def test_the_module_of_the_element_does_nothing_on_a_server(tmp_path: Path) -> None:
    module = (ROOT / "vmesh" / "web" / "viewer" / "element.js").as_uri()
    (tmp_path / "server.mjs").write_text(f"console.log(typeof (await import('{module}')))")
    assert run_node(tmp_path / "server.mjs").strip() == "object"
