"""With the option of `.ci/run` no test is left out unseen."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Final

import pytest

from tests.known_skips import KNOWN, OPTION

ROOT: Final = Path(__file__).parents[1]
LISTED: Final = min(KNOWN)

FILES: Final = {
    "test_renderer.py": """
from pathlib import Path
from tests.formats.renderers import draw_with_librsvg

def test_of_a_drawing():
    draw_with_librsvg(Path("drawing.svg"), 1)
""",
    "test_browser.py": """
from tests.formats.browser import running

def test_of_a_page():
    with running():
        pass
""",
    "test_package.py": """
import pytest
pytest.importorskip("no_such_package", reason="no such package is installed")
""",
    "test_others.py": f"""
import pytest

@pytest.mark.skip(reason={LISTED!r})
def test_of_a_protected_folder():
    pass

@pytest.mark.xfail
def test_of_what_is_not_there_yet():
    assert False
""",
}
COMPLAINTS: Final = {
    "test_renderer.py::test_of_a_drawing": "program rsvg-convert is missing (package librsvg2-bin)",
    "test_browser.py::test_of_a_page": (
        "none of chromium, chromium-browser, google-chrome is installed"
    ),
    "test_package.py": "no such package is installed",
}


def run(*arguments: str | Path, folder: Path) -> tuple[int, str]:
    """Exit status and output of pytest in a folder, where it finds no programs but those there."""
    environment = {**os.environ, "PATH": str(folder), "PYTHONPATH": str(ROOT)}
    environment.pop("PYTEST_ADDOPTS", None)
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "-rs", *arguments],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    return done.returncode, done.stdout + done.stderr


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with tests that want something, and some that do not."""
    for name, text in FILES.items():
        (tmp_path / name).write_text(text)
    return tmp_path


@pytest.mark.parametrize("workers", ["0", "2"])
def test_a_test_that_is_skipped_for_want_of_something_fails_and_tells_it(
    folder: Path, workers: str
) -> None:
    options = ["-p", "tests.known_skips", OPTION, "--continue-on-collection-errors"]
    status, output = run(*options, "-n", workers, folder=folder)
    assert status == 1, output
    for test, reason in COMPLAINTS.items():
        told = f"{test}: skipped, though all that it needs should be there: {reason}"
        assert told in output, output
    # A listed reason is none to fail, nor is what is expected to fail.
    assert "2 failed, 1 skipped, 1 xfailed, 1 error" in output
    assert LISTED in output


def test_without_the_option_a_skipped_test_is_named(folder: Path) -> None:
    status, output = run("-n", "0", folder=folder)
    assert status == 0, output
    assert all(reason in output for reason in COMPLAINTS.values())


def test_the_suite_fails_without_node(tmp_path: Path) -> None:
    test = "tests/spec/test_conformance.py::test_the_decoder_in_javascript_passes_all_files"
    status, output = run(OPTION, "-n", "0", ROOT / test, folder=tmp_path)
    assert status == 1, output
    assert "program node is missing (package nodejs)" in output


def test_ci_runs_the_suite_with_the_option() -> None:
    assert f"PYTEST_ADDOPTS={OPTION} " in (ROOT / ".ci" / "run").read_text("utf-8")
