"""What `tools/desktop` holds, tried with the programs that it is for."""

from __future__ import annotations

import configparser
import os
import re
import shlex
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import vmesh
from tests.programs import need_program, place_vmesh
from vmesh.arrays import UInt8Array
from vmesh.formats.picture.conversion import flatten
from vmesh.metrics import psnr

DESKTOP = Path(__file__).parents[2] / "tools" / "desktop"
MEDIA_TYPE = "image/vnd.vmesh"


@pytest.fixture
def mesh_file(coffee: UInt8Array, tmp_path: Path) -> Path:
    """A file whose name says nothing."""
    path = tmp_path / "mesh"
    vmesh.dump(vmesh.encode(coffee[:120, :180], vertices=300, effort=1), path)
    return path


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty home, with `vmesh` on the path."""
    place_vmesh(tmp_path / "bin")
    monkeypatch.setenv("PATH", f"{tmp_path / 'bin'}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.setenv("HOME", str(tmp_path))
    for name in ("XDG_CONFIG_HOME", "XDG_DATA_HOME"):
        monkeypatch.delenv(name, raising=False)
    return tmp_path


def output_of(*arguments: object) -> str:
    return subprocess.run(
        list(map(str, arguments)), capture_output=True, check=True
    ).stdout.decode()


def test_file_tells_a_mesh_by_its_content(mesh_file: Path) -> None:
    program = need_program("file", "file")
    magic = DESKTOP / "vmesh.magic"
    assert output_of(program, "-b", "-m", magic, mesh_file).strip() == "vmesh image, version 1.0"
    assert output_of(program, "-b", "--mime-type", "-m", magic, mesh_file).strip() == MEDIA_TYPE


def test_the_mime_database_tells_a_mesh_by_content_and_name(home: Path, mesh_file: Path) -> None:
    update = need_program("update-mime-database", "shared-mime-info")
    gio = need_program("gio", "libglib2.0-bin")
    packages = home / ".local" / "share" / "mime" / "packages"
    packages.mkdir(parents=True)
    shutil.copy(DESKTOP / "vmesh.xml", packages)
    output_of(update, packages.parent)
    named = home / "named.vmesh"
    named.write_text("of another content")
    for path, attribute in ((mesh_file, "content-type"), (named, "fast-content-type")):
        told = output_of(gio, "info", "-a", f"standard::{attribute}", path)
        assert f"standard::{attribute}: {MEDIA_TYPE}" in told


def test_the_thumbnailer_s_line_makes_a_small_png(home: Path, mesh_file: Path) -> None:
    entry = configparser.ConfigParser(interpolation=None)
    entry.read(DESKTOP / "vmesh.thumbnailer")
    section = entry["Thumbnailer Entry"]
    assert section["MimeType"] == f"{MEDIA_TYPE};"
    source, target = home / "a mesh", home / "thumbnail"
    mesh_file.rename(source)
    places = {"i": shlex.quote(str(source)), "o": shlex.quote(str(target)), "s": "64"}
    line = re.sub(r"%([ios])", lambda found: places[found[1]], section["Exec"])
    output_of(*shlex.split(line))
    with Image.open(target) as drawn:
        assert (drawn.format, drawn.size) == ("PNG", (64, 43))


@pytest.fixture
def inkscape(home: Path) -> str:
    """Inkscape with the extensions installed."""
    program = need_program("inkscape", "inkscape")
    extensions = home / ".config" / "inkscape" / "extensions"
    extensions.mkdir(parents=True)
    for path in DESKTOP.glob("vmesh_*"):
        shutil.copy(path, extensions)
    return program


def test_inkscape_opens_a_mesh(inkscape: str, home: Path, mesh_file: Path) -> None:
    source = mesh_file.rename(home / "mesh.vmesh")
    output_of(inkscape, source, f"--export-filename={home / 'drawn.png'}")
    drawn = flatten(np.asarray(Image.open(home / "drawn.png")))
    mesh = vmesh.load(source)
    shown = vmesh.render(mesh)
    # Closer than where the seams between triangles are smoothed.
    vmesh.export(mesh, home / "seams.svg")
    crisp = (home / "seams.svg").read_bytes()
    (home / "seams.svg").write_bytes(crisp.replace(b' shape-rendering="crispEdges"', b""))
    output_of(inkscape, home / "seams.svg", f"--export-filename={home / 'seams.png'}")
    seams = flatten(np.asarray(Image.open(home / "seams.png")))
    assert psnr(drawn, shown) > psnr(seams, shown)


def test_inkscape_saves_a_drawing_as_a_mesh(inkscape: str, home: Path) -> None:
    drawing = home / "drawing.svg"
    drawing.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="90" height="60" viewBox="0 0 90 60">'
        '<rect width="90" height="60" fill="#fe8"/>'
        '<circle cx="45" cy="30" r="20" fill="#26a"/></svg>'
    )
    output_of(inkscape, drawing, f"--export-filename={home / 'drawn.vmesh'}")
    pixels = vmesh.render(vmesh.load(home / "drawn.vmesh"))
    assert pixels.shape[:2] == (60, 90)
    assert np.abs(pixels[30, 45, :3].astype(int) - (0x22, 0x66, 0xAA)).max() <= 8
    assert np.abs(pixels[5, 5, :3].astype(int) - (0xFF, 0xEE, 0x88)).max() <= 8
