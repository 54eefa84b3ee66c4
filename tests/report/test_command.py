"""``vmesh report``, run as a program."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from PIL import Image

from tests.cli.program import fail, succeed
from tests.pictures import disc, ramp

FAST = ("-e", "1", "--vertices", "20")


@pytest.fixture
def photograph(tmp_path: Path) -> Path:
    path = tmp_path / "photo.png"
    Image.fromarray(ramp(24, 32)).save(path)
    return path


def test_photographs_stand_on_one_page_in_their_order(photograph: Path, tmp_path: Path) -> None:
    other, page = tmp_path / "a <b> disc.png", tmp_path / "page.html"
    Image.fromarray(disc(20, 20, (0, 0, 0), (9, 9, 99))).save(other)
    assert succeed("report", photograph, other, "-o", page, *FAST) == b""
    text = page.read_text("utf-8")
    assert text.index("<h2>photo.png</h2>") < text.index("<h2>a &lt;b&gt; disc.png</h2>")
    assert text.count("<section>") == 2


def test_a_page_comes_from_standard_input_and_goes_to_standard_output(photograph: Path) -> None:
    page = succeed("report", "-", "-o", "-", *FAST, given=photograph.read_bytes())
    assert page.startswith(b"<!doctype html>")
    assert b"<h2>standard input</h2>" in page


def test_a_photograph_that_fails_is_left_out_and_told(photograph: Path, tmp_path: Path) -> None:
    broken, page = tmp_path / "broken.png", tmp_path / "page.html"
    broken.write_bytes(photograph.read_bytes()[:60])
    text = fail(1, "report", broken, photograph, "-o", page, *FAST)
    assert text.startswith(f"vmesh: {broken}: the file is cut off")
    assert page.read_text("utf-8").count("<section>") == 1


def test_a_goal_that_cannot_be_met_names_the_photograph(photograph: Path, tmp_path: Path) -> None:
    page = tmp_path / "page.html"
    text = fail(1, "report", photograph, "-o", page, "-e", "1", "--target-size", "20")
    assert text.startswith(f"vmesh: {photograph}: the smallest file of this picture takes")


def test_no_page_is_written_where_all_photographs_fail(tmp_path: Path) -> None:
    page, missing = tmp_path / "page.html", tmp_path / "missing.png"
    page.write_text("an earlier page")
    assert fail(1, "report", missing, "-o", page) == (
        f"vmesh: {missing}: No such file or directory\n"
    )
    assert page.read_text() == "an earlier page"


def test_a_page_that_cannot_be_written_is_refused_first(photograph: Path, tmp_path: Path) -> None:
    assert "page.png" in fail(2, "report", photograph, "-o", tmp_path / "page.png")
    folder = tmp_path / "missing"
    assert fail(1, "report", "no.png", "-o", folder / "page.html").startswith(f"vmesh: {folder}: ")


def test_matplotlib_is_asked_for_before_anything_is_read(tmp_path: Path) -> None:
    arguments = ["vmesh", "report", "missing.png", "-o", str(tmp_path / "page.html")]
    code = (
        f"import sys; sys.modules['matplotlib'] = None; sys.argv = {arguments!r}\n"
        "from vmesh.cli.main import main; main()"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert done.stderr == ("vmesh: the plots of a report need matplotlib: pip install matplotlib\n")
