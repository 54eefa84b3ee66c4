"""Albums, paper, ids and data URIs from the command line."""

from __future__ import annotations

import os
from pathlib import Path

import pikepdf
import pytest
from PIL import Image

import vmesh
from tests.cli.program import Program
from tests.codec import samples
from tests.pictures import ramp

FAST = ("-e", "1", "--vertices", "9", "--quiet")


@pytest.fixture
def inputs(tmp_path: Path) -> list[Path]:
    """Two pictures and a mesh, each in a folder of its own."""
    paths = [tmp_path / name for name in ("x/wide.png", "y/tall.png", "z/mesh.vmesh")]
    for path in paths:
        path.parent.mkdir()
    Image.fromarray(ramp(12, 16)).save(paths[0])
    Image.fromarray(ramp(16, 12)).save(paths[1])
    vmesh.dump(samples.color(), paths[2])
    return paths


def described(path: Path) -> list[tuple[str, list[int]]]:
    """Titles of the pages of a document, and their sizes in millimetres."""
    with pikepdf.open(path) as document:
        titles = [str(item.title) for item in document.open_outline().root]
        boxes = [page.obj.MediaBox for page in document.pages]
        sizes = [[round(float(end) / 72 * 25.4) for end in box[2:]] for box in boxes]
    return list(zip(titles, sizes, strict=True))


def test_inputs_become_pages_of_one_document(
    program: Program, inputs: list[Path], tmp_path: Path
) -> None:
    paper = ("--page-size", "A5", "--margin", "10mm")
    for album in (("-o", tmp_path / "album.pdf"), (tmp_path / "last.pdf",)):
        program.succeed("to-pdf", *inputs, *album, *FAST, *paper)
        lying, standing = [210, 148], [148, 210]
        assert described(Path(album[-1])) == [
            ("wide", lying), ("tall", standing), ("mesh", standing)
        ]  # fmt: skip


def test_a_folder_becomes_an_album_too(
    program: Program, inputs: list[Path], tmp_path: Path
) -> None:
    album = tmp_path / "album.pdf"
    os.utime(inputs[1], (2e9, 2e9))
    program.succeed("to-pdf", tmp_path, "-o", album, *FAST, "--preserve")
    assert [title for title, _ in described(album)] == ["wide", "tall", "mesh"]
    assert album.stat().st_mtime == 2e9


def test_what_cannot_be_read_is_told_and_left_out_of_an_album(
    program: Program, inputs: list[Path], tmp_path: Path
) -> None:
    album = tmp_path / "album.pdf"
    inputs[1].write_bytes(b"no picture")
    missing = tmp_path / "missing.png"
    told = program.fail(1, "to-pdf", *inputs, missing, "-o", album, *FAST)
    assert len(told.splitlines()) == 2
    assert "tall.png" in told
    assert "missing.png" in told
    assert [title for title, _ in described(album)] == ["wide", "mesh"]


def test_an_album_without_pages_is_not_written(
    program: Program, inputs: list[Path], tmp_path: Path
) -> None:
    album = tmp_path / "album.pdf"
    album.write_bytes(b"kept")
    program.fail(1, "to-pdf", tmp_path / "a.png", tmp_path / "b.png", "-o", album, *FAST)
    assert album.read_bytes() == b"kept"
    told = program.fail(1, "to-pdf", *inputs, "-o", album, *FAST, "--no-overwrite")
    assert "album.pdf" in told
    assert album.read_bytes() == b"kept"


def test_an_album_replaces_none_of_its_inputs(
    program: Program, inputs: list[Path], tmp_path: Path
) -> None:
    link = tmp_path / "link.pdf"
    link.hardlink_to(inputs[0])
    before = inputs[0].read_bytes()
    assert "source" in program.fail(1, "to-pdf", *inputs[1:], inputs[0], "-o", link, *FAST)
    assert inputs[0].read_bytes() == before


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--page-size", "A11"), "expected a page size"),
        (("--page-size", "A4", "--page-width", "9cm"), "a size or a width"),
        (("--orientation", "portrait"), "page size"),
        (("--margin", "wide"), "expected a length"),
        (("--margin", "3cm", "--page-size", "6x6cm"), "leave no room"),
    ],
)
def test_paper_without_sense_is_refused(
    program: Program, inputs: list[Path], options: tuple[str, ...], message: str
) -> None:
    assert message in program.fail(2, "to-pdf", inputs[2], inputs[2].with_name("a.pdf"), *options)


def test_ids_begin_as_asked(program: Program, inputs: list[Path], tmp_path: Path) -> None:
    drawing = tmp_path / "a.svg"
    program.succeed("to-svg", inputs[0], drawing, *FAST, "--id-prefix", "logo")
    assert 'id="logo-a"' in drawing.read_text()
    told = program.fail(2, "to-svg", inputs[0], drawing, *FAST, "--id-prefix", "2nd")
    assert "expected ids to begin with a letter" in told


def test_a_data_uri_is_printed_or_written(
    program: Program, inputs: list[Path], tmp_path: Path
) -> None:
    printed = program.succeed("to-svg", inputs[2], "-", "--data-uri", "--quiet")
    assert printed == vmesh.data_uri(vmesh.load(inputs[2]))
    assert printed.startswith("data:image/svg+xml,<svg")
    assert not set(printed) & set("\"'#&\\\n`")
    program.succeed(
        "to-svg", inputs[2], inputs[2], "-o", tmp_path / "uris", "--data-uri", "-e", "1"
    )
    assert (tmp_path / "uris" / "mesh.txt").read_text() == printed
    assert ".txt" in program.fail(2, "to-svg", inputs[2], tmp_path / "a.svg", "--data-uri")
