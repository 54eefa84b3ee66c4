"""Profiles and private metadata, through the commands."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pikepdf
import pytest
from PIL import Image

import vmesh
from tests.cli.program import fail, run, succeed
from tests.pages import embedded_meshes
from tests.pictures import ramp
from tests.private_metadata import SECRET, TITLE, exif_block, private_metadata, xmp_packet
from tests.profiles import grey_profile, managed, press_profile, wide_profile
from vmesh.metrics import psnr

WORD = SECRET.encode()
FEW = ("--vertices", "30", "-e", "1")


@pytest.fixture(scope="module")
def photo(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A photograph of a phone: with a place, serial numbers and a maker's note."""
    path = tmp_path_factory.mktemp("photo") / "phone.jpg"
    exif = b"Exif\0\0" + exif_block()
    Image.fromarray(ramp(24, 32)).save(
        path, exif=exif, xmp=xmp_packet(), icc_profile=wide_profile()
    )
    return path


@pytest.fixture(scope="module")
def mesh_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A mesh with all of these, and with a chunk that nobody knows."""
    path = tmp_path_factory.mktemp("mesh") / "phone.vmesh"
    metadata = private_metadata(icc=wide_profile())
    vmesh.dump(vmesh.encode(ramp(24, 32), vertices=30, effort=1, metadata=metadata), path)
    return path


def in_mesh(mesh: vmesh.Mesh) -> bytes:
    kept = mesh.metadata
    return kept.exif + kept.xmp + b"".join(content for _, content in kept.unknown)


def in_vmesh(path: Path) -> bytes:
    return in_mesh(vmesh.load(path))


def in_page(path: Path) -> bytes:
    page = path.read_text("utf-8")
    return page.encode() + b"".join(map(in_mesh, embedded_meshes(page)))


def in_pdf(path: Path) -> bytes:
    """All streams of a document, and its information."""
    with pikepdf.open(path) as pdf:
        streams = [item for item in pdf.objects if isinstance(item, pikepdf.Stream)]
        return b"".join(bytes(item.read_bytes()) for item in streams) + repr(pdf.docinfo).encode()


READERS: dict[str, Callable[[Path], bytes]] = {
    ".vmesh": in_vmesh,
    ".html": in_page,
    ".pdf": in_pdf,
}


def told(path: Path) -> bytes:
    """What a file says that is not the picture."""
    return READERS.get(path.suffix, Path.read_bytes)(path)


@pytest.mark.parametrize(
    ("strip", "secret", "title"),
    [((), True, True), (("--strip", "private"), False, True), (("--strip", "all"), False, False)],
)
def test_encode_leaves_out_what_it_is_told(
    strip: tuple[str, ...], secret: bool, title: bool, photo: Path, tmp_path: Path
) -> None:
    target = tmp_path / "out.vmesh"
    succeed("encode", photo, target, *FEW, *strip)
    assert (WORD in told(target)) == secret
    assert (TITLE.encode() in told(target)) == title
    assert vmesh.load(target).metadata.icc


@pytest.mark.parametrize("suffix", [".png", ".jpg", ".webp", ".tif"])
def test_decode_keeps_all_unless_told(suffix: str, mesh_file: Path, tmp_path: Path) -> None:
    target = tmp_path / f"out{suffix}"
    succeed("decode", mesh_file, target)
    assert WORD in told(target)
    succeed("decode", mesh_file, target, "--strip", "private")
    assert WORD not in told(target)
    with Image.open(target) as image:
        assert image.getexif()[270] == TITLE
        assert image.info["icc_profile"]
    succeed("decode", mesh_file, target, "--strip", "all")
    assert TITLE.encode() not in told(target)


@pytest.mark.parametrize(
    ("command", "suffix", "options"),
    [
        ("to-html", ".html", ()),
        ("to-pdf", ".pdf", ()),
        ("to-pdf", ".pdf", ("--backend", "cairo")),
        ("to-svg", ".svg", ()),
    ],
)
def test_documents_hold_nothing_private_unless_told(
    command: str,
    suffix: str,
    options: tuple[str, ...],
    mesh_file: Path,
    photo: Path,
    tmp_path: Path,
) -> None:
    target = tmp_path / f"out{suffix}"
    for source in (mesh_file, photo):
        encoding = () if source is mesh_file else FEW
        succeed(command, source, target, *options, *encoding)
        assert WORD not in told(target)
        assert TITLE.encode() in told(target)
    succeed(command, mesh_file, target, *options, "--strip", "none")
    assert (WORD in told(target)) == (suffix in (".html", ".pdf") and not options)
    succeed(command, mesh_file, target, *options, "--strip", "all")
    assert TITLE.encode() not in told(target)


def test_batch_leaves_out_what_it_is_told(photo: Path, tmp_path: Path) -> None:
    suffixes = ("vmesh", "png", "html", "svg", "pdf")
    to = ("--to", ",".join(suffixes), *FEW, "--quiet")
    for strip, kept in (((), ("vmesh", "png")), (("--strip", "private"), ())):
        folder = tmp_path / f"out{len(strip)}"
        succeed("batch", photo, "-o", folder, *to, *strip)
        secret = [suffix for suffix in suffixes if WORD in told(folder / f"phone.{suffix}")]
        assert secret == list(kept)


def test_reports_hold_nothing_private(photo: Path, tmp_path: Path) -> None:
    target = tmp_path / "report.html"
    succeed("report", photo, "-o", target, *FEW)
    assert embedded_meshes(target.read_text("utf-8"))
    assert WORD not in told(target)
    assert TITLE.encode() in told(target)


def test_info_names_the_profile_and_lists_other_metadata(mesh_file: Path, tmp_path: Path) -> None:
    text = succeed("info", mesh_file).decode()
    assert "ICC profile RGB built-in\n" in text
    assert "metadata EXIF, XMP, chunk q\n" in text
    figures = json.loads(succeed("info", mesh_file, "--json"))
    assert figures["profile"] == "RGB built-in"
    assert figures["metadata"] == ["icc", "exif", "xmp", "q"]
    plain = tmp_path / "plain.vmesh"
    vmesh.dump(vmesh.load(mesh_file).replaced(metadata=vmesh.Metadata()), plain)
    assert "profile" not in succeed("info", plain).decode()
    assert json.loads(succeed("info", plain, "--json"))["profile"] is None
    hostile = tmp_path / "hostile.vmesh"
    metadata = vmesh.Metadata(icc=press_profile("red \x1b[31m")[:200])
    vmesh.dump(vmesh.load(mesh_file).replaced(metadata=metadata), hostile)
    assert b"\x1b" not in succeed("info", hostile)


def test_compare_compares_colors_and_not_numbers(tmp_path: Path) -> None:
    numbers, profile = ramp(40, 60), wide_profile()
    wide, reference = tmp_path / "wide.png", tmp_path / "reference.png"
    Image.fromarray(numbers).save(wide, icc_profile=profile)
    Image.fromarray(managed(Image.fromarray(numbers), profile)).save(reference)
    mesh = tmp_path / "wide.vmesh"
    succeed("encode", wide, mesh, "-q", "95", "-e", "1")
    assert figures_of(wide, reference)["psnr_rgb"] > 50
    assert figures_of(mesh, reference)["psnr_rgb"] > 35
    assert figures_of(wide, mesh)["psnr_rgb"] > 35
    assert psnr(numbers, np.asarray(Image.open(reference))) < 30


def figures_of(first: Path, second: Path) -> Any:
    figures = json.loads(succeed("compare", first, second, "--json"))
    return {name: float("inf") if value is None else value for name, value in figures.items()}


def test_an_unfitting_profile_is_told(tmp_path: Path) -> None:
    source = tmp_path / "photo.png"
    Image.fromarray(ramp(24, 32)).save(source, icc_profile=grey_profile())
    done = run("encode", source, tmp_path / "out.vmesh", *FEW)
    assert done.returncode == 0
    assert done.stderr.decode().startswith(f"vmesh: {source}: the ICC profile 'gray built-in'")
    assert done.stderr.count(b"\n") == 1


def test_strip_takes_one_of_three_words(photo: Path, tmp_path: Path) -> None:
    assert "private" in fail(2, "encode", photo, tmp_path / "out.vmesh", "--strip", "some")
