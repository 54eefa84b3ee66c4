"""The documents lead where they say: to files, headings and modules that are there."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DOCUMENTS = sorted(
    path.relative_to(ROOT).as_posix()
    for folder in (".", "docs", "docs/design", "spec", "tools/desktop", "tests/images", "vmesh/web")
    for path in (ROOT / folder).glob("*.md")
)
ARCHITECTURE = (ROOT / "ARCHITECTURE.md").read_text("utf-8")


def without_code(text: str) -> str:
    return re.sub(r"^```.*?^```", "", text, flags=re.DOTALL | re.MULTILINE)


def headings_of(path: Path) -> set[str]:
    """Headings of a document, as links name them."""
    found = re.findall(r"^#+ (.*)$", without_code(path.read_text("utf-8")), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in found}


@pytest.mark.parametrize("name", DOCUMENTS)
def test_links_lead_to_files_and_headings(name: str) -> None:
    document = ROOT / name
    for target in re.findall(r"\]\(([^)\s]*)\)", without_code(document.read_text("utf-8"))):
        if "://" in target:
            continue
        other, _, heading = target.partition("#")
        path = document.parent / other if other else document
        assert path.exists(), target
        assert not heading or heading in headings_of(path), target


@pytest.mark.parametrize("name", [name for name in DOCUMENTS if "/design/" in name])
def test_modules_that_the_design_names_are_there(name: str) -> None:
    check_modules((ROOT / name).read_text("utf-8"))


def test_modules_that_the_architecture_names_are_there() -> None:
    check_modules(ARCHITECTURE)


def check_modules(text: str) -> None:
    """Fail unless all modules and folders that a text names exist."""
    folders = ("vmesh", "tests", "tools", "benchmarks")
    files = [path.as_posix() for folder in folders for path in (ROOT / folder).rglob("*.*")]
    for named in re.findall(r"`((?:\w+/)*\w+\.(?:py|js)|(?:\w+/)+)`", text):
        if named.endswith("/"):
            assert (ROOT / named).is_dir() or any(f"/{named}" in file for file in files), named
        elif named != "cli/to_x.py":  # which is yet to be written
            assert any(file.endswith(f"/{named}") for file in files), named


def test_the_layers_of_the_architecture_are_those_of_the_imports() -> None:
    configuration = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    contracts = configuration["tool"]["importlinter"]["contracts"]
    layers = next(law["layers"] for law in contracts if law["type"] == "layers")
    drawn = ARCHITECTURE.split("## Layers")[1].split("```")[1].strip()
    assert [re.split(r"\s{2,}", line)[0] for line in drawn.splitlines()] == [
        layer.replace("vmesh.", "") for layer in layers
    ]
