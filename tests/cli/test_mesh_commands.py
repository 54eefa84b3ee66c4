"""``vmesh export`` and ``vmesh import``, run as a program."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import vmesh
from tests.cli.program import fail, succeed
from tests.cli.test_commands import COFFEE
from tests.codec import samples


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("mesh") / "photo.vmesh"
    vmesh.dump(samples.color(), path)
    return path


@pytest.mark.parametrize("suffix", ["ply", "obj", "glb", "txt"])
def test_export_writes_what_the_library_writes_and_import_reads_it(
    suffix: str, file: Path, tmp_path: Path
) -> None:
    out, back, expected = (tmp_path / f"{x}.{suffix}" for x in ("out", "back", "expected"))
    assert succeed("export", file, out) == b""
    vmesh.export(vmesh.load(file), expected)
    assert out.read_bytes() == expected.read_bytes()
    succeed("import", out, back.with_suffix(".vmesh"))
    assert vmesh.load(back.with_suffix(".vmesh")) == vmesh.import_mesh(expected)


def test_a_photograph_is_encoded_on_the_way(tmp_path: Path) -> None:
    succeed("export", COFFEE, tmp_path / "coffee.ply", "--ascii", "--vertices", "200", "-e", "1")
    assert (tmp_path / "coffee.ply").read_bytes().startswith(b"ply\nformat ascii")
    mesh = vmesh.import_mesh(tmp_path / "coffee.ply")
    assert (mesh.width, mesh.height) == (600, 400)


def test_import_takes_a_size_and_a_step(file: Path, tmp_path: Path) -> None:
    succeed("export", file, tmp_path / "mesh.ply")
    options = ("--width", "64", "--color-step", "12")
    succeed("import", tmp_path / "mesh.ply", tmp_path / "large.vmesh", *options)
    mesh = vmesh.load(tmp_path / "large.vmesh")
    assert (mesh.width, mesh.height, mesh.lattice.steps[0]) == (64, 64, 12)
    assert np.array_equal(mesh.points, 4 * vmesh.load(file).points)


def test_failures_are_told_in_one_line_and_leave_no_file(file: Path, tmp_path: Path) -> None:
    source, target = tmp_path / "mesh.ply", tmp_path / "out.vmesh"
    source.write_bytes(b"ply\nformat ascii 1.0\nelement vertex 9\nend_header\n")
    assert f"vmesh: {source}: the PLY file is damaged" in fail(1, "import", source, target)
    assert "No such file" in fail(1, "import", tmp_path / "missing.obj", target)
    succeed("export", file, source)
    message = fail(1, "import", source, target, "--max-vertices", "9")
    assert f"{source}: the file has" in message or "limit is 9" in message
    assert not target.exists()


def test_wrong_usage_is_told(file: Path, tmp_path: Path) -> None:
    out = tmp_path / "out.vmesh"
    assert ".ply, .obj, .glb, .txt" in fail(2, "export", file, tmp_path / "out.stl")
    assert "its ending says the format" in fail(2, "export", file, "-")
    assert "--ascii is for PLY" in fail(2, "export", file, tmp_path / "out.obj", "--ascii")
    assert ".ply, .obj, .glb, .txt" in fail(2, "import", tmp_path / "mesh.stl", out)
    assert ".vmesh" in fail(2, "import", tmp_path / "mesh.ply", tmp_path / "out.png")
    message = fail(2, "import", tmp_path / "mesh.ply", out, "--scale", "2", "--width", "9")
    assert "--scale or a size" in message
