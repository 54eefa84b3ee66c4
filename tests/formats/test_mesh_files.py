"""Meshes x formats of modelling programs: what comes back, and what programs of others see."""

from __future__ import annotations

import builtins
import logging
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

import meshio
import numpy as np
import numpy.typing as npt
import pygltflib
import pytest

import vmesh
from tests.codec import samples
from tests.pictures import noise
from vmesh.arrays import UInt8Array
from vmesh.formats.raster.rendering import with_alpha
from vmesh.mesh import Mesh


def deep(n_components: int, depth: int = 16) -> Mesh:
    mesh = samples.implied(noise(12, 15), 40)
    random = np.random.default_rng(5)
    colors = random.integers(0, 1 << depth, (mesh.n_vertices, n_components))
    return Mesh.from_colors(
        15, 12, mesh.vertices, mesh.triangles, colors, depth=depth, subdivision=mesh.subdivision
    )


def on_the_finest_lattice() -> Mesh:
    mesh = samples.color()
    vertices = mesh.vertices << 7
    is_inner = ((vertices > 0) & (vertices < 16 * 256)).all(axis=1)
    vertices[is_inner] += np.random.default_rng(2).integers(-20, 20, (is_inner.sum(), 2), np.int32)
    return mesh.replaced(vertices=vertices, subdivision=8).canonical()


def one_triangle() -> Mesh:
    colors = np.array([[255, 0, 0], [0, 255, 0], [0, 0, 255]])
    return Mesh.from_colors(4, 4, [[0, 0], [4, 0], [0, 4]], [[0, 1, 2]], colors)


MESHES: Final[dict[str, Callable[[], Mesh]]] = {
    **{name: make for name, make in samples.CASES.items() if name != "with metadata"},
    "16 bits, grey": lambda: deep(1),
    "16 bits": lambda: deep(3),
    "12 bits with alpha": lambda: deep(4, 12),
    "on the finest lattice": on_the_finest_lattice,
}
PARTIAL: Final[dict[str, Callable[[], Mesh]]] = {
    "one triangle": one_triangle,
    "with a hole": lambda: samples.color().replaced(triangles=samples.color().triangles[1:]),
    "tilted": lambda: samples.color().transform((0.8, 0.6, -0.6, 0.8, 0, 0)),
}
FORMATS: Final[dict[str, dict[str, Any]]] = {
    "binary.ply": {},
    "text.ply": {"ascii": True},
    "mesh.obj": {},
    "mesh.glb": {},
}


def assert_same_in_8_bits(first: Mesh, second: Mesh) -> None:
    assert (first.width, first.height) == (second.width, second.height)
    assert np.array_equal(first.points, second.points)
    assert np.array_equal(first.triangles, second.triangles)
    assert np.array_equal(with_alpha(first.plain_colors), with_alpha(second.plain_colors))


@pytest.mark.parametrize("name", FORMATS)
@pytest.mark.parametrize("case", MESHES)
def test_a_mesh_comes_back_exactly(case: str, name: str, tmp_path: Path) -> None:
    mesh, path = MESHES[case](), tmp_path / name
    if mesh.n_components == 4 and path.suffix == ".obj":
        with pytest.raises(ValueError, match="OBJ holds no alpha"):
            vmesh.export(mesh, path)
        assert not path.exists()
        return
    vmesh.export(mesh, path, **FORMATS[name])
    back = vmesh.import_mesh(path)
    assert_same_in_8_bits(back, mesh)
    assert vmesh.loads(vmesh.dumps(back)) == back


@pytest.mark.parametrize("case", MESHES)
def test_a_text_brings_back_every_level(case: str, tmp_path: Path) -> None:
    mesh = MESHES[case]()
    vmesh.export(mesh, tmp_path / "mesh.txt")
    assert vmesh.import_mesh(tmp_path / "mesh.txt") == mesh


@pytest.mark.parametrize("name", [*FORMATS, "mesh.txt"])
def test_a_photograph_comes_back(name: str, tmp_path: Path, chelsea: UInt8Array) -> None:
    mesh = vmesh.encode(chelsea, vertices=1500, effort=1)
    vmesh.export(mesh, tmp_path / name, **FORMATS.get(name, {}))
    back = vmesh.import_mesh(tmp_path / name)
    assert_same_in_8_bits(back, mesh)
    assert np.array_equal(vmesh.render(back), vmesh.render(mesh))


@pytest.mark.parametrize("name", [*FORMATS, "mesh.txt"])
@pytest.mark.parametrize("case", PARTIAL)
def test_what_covers_no_canvas_is_exported_but_not_imported(
    case: str, name: str, tmp_path: Path
) -> None:
    vmesh.export(PARTIAL[case](), tmp_path / name, **FORMATS.get(name, {}))
    with pytest.raises(ValueError, match=r"do not cover the canvas|area"):
        vmesh.import_mesh(tmp_path / name)


@pytest.mark.parametrize("grey", [0, 1, 2, 3, 9, 10, 11, 128, 254, 255])
def test_each_grey_and_alpha_survives_linear_light(grey: int, tmp_path: Path) -> None:
    square = [[0, 0], [1, 0], [0, 1], [1, 1]]
    colors = [[grey, 255 - grey, x, x] for x in (grey, 0, 77, 254)]
    mesh = Mesh.from_colors(1, 1, square, [[0, 1, 3], [0, 3, 2]], colors)
    vmesh.export(mesh, tmp_path / "mesh.glb")
    assert np.array_equal(vmesh.import_mesh(tmp_path / "mesh.glb").colors, mesh.colors)


def areas_upwards(points: npt.NDArray[Any], triangles: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Doubled areas, positive where triangles are counter-clockwise for who looks along -z."""
    first, second = (points[triangles[:, i]] - points[triangles[:, 0]] for i in (1, 2))
    areas: npt.NDArray[Any] = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    return areas


@pytest.mark.parametrize("case", ["RGB, implied", "RGBA, implied", *PARTIAL])
@pytest.mark.parametrize("name", ["binary.ply", "text.ply"])
def test_meshio_reads_our_ply(case: str, name: str, tmp_path: Path) -> None:
    mesh = {**MESHES, **PARTIAL}[case]()
    vmesh.export(mesh, tmp_path / name, **FORMATS[name])
    seen = meshio.read(tmp_path / name)
    assert np.array_equal(seen.points[:, 0], mesh.points[:, 0])
    assert np.array_equal(seen.points[:, 1], mesh.height - mesh.points[:, 1])
    assert not seen.points[:, 2].any()
    colors = np.stack([seen.point_data[x] for x in ("red", "green", "blue", "alpha")], axis=1)
    # meshio takes the bytes of a binary file for signed ones.
    assert np.array_equal(colors.astype(np.uint8), with_alpha(mesh.plain_colors))
    triangles = seen.cells_dict["triangle"]
    assert len(triangles) == mesh.n_triangles
    assert (areas_upwards(seen.points, triangles) > 0).all()


def test_our_obj_is_lines_of_vertices_with_colours_and_of_faces(tmp_path: Path) -> None:
    vmesh.export(one_triangle(), tmp_path / "mesh.obj")
    lines = (tmp_path / "mesh.obj").read_text("ascii").splitlines()
    vertices = [[float(x) for x in line.split()[1:]] for line in lines if line.startswith("v ")]
    assert vertices == [[0, 4, 0, 1, 0, 0], [4, 4, 0, 0, 1, 0], [0, 0, 0, 0, 0, 1]]
    assert [line for line in lines if line.startswith("f ")] == ["f 3 2 1"]


@pytest.mark.parametrize("case", ["RGB, implied", "RGBA, implied", *PARTIAL])
def test_pygltflib_reads_our_glb(case: str, tmp_path: Path) -> None:
    mesh = {**MESHES, **PARTIAL}[case]()
    vmesh.export(mesh, tmp_path / "mesh.glb")
    seen = pygltflib.GLTF2().load(str(tmp_path / "mesh.glb"))
    (primitive,) = seen.meshes[0].primitives
    points = accessor(seen, primitive.attributes.POSITION, "<f4", 3)
    triangles = accessor(seen, primitive.indices, "<u4", 1).reshape(-1, 3)
    colors = accessor(seen, primitive.attributes.COLOR_0, "<u2", 4)
    assert seen.accessors[primitive.attributes.COLOR_0].normalized
    assert np.array_equal(points[:, 1], mesh.height - mesh.points[:, 1])
    assert (areas_upwards(points, triangles) > 0).all()
    expected = with_alpha(mesh.plain_colors) / 255
    assert np.abs(colors[:, 3] / 65535 - expected[:, 3]).max() < 1e-4
    assert np.abs((colors[:, :3] / 65535) ** (1 / 2.2) - expected[:, :3]).max() < 0.04
    (material,) = seen.materials
    assert "KHR_materials_unlit" in material.extensions
    assert material.alphaMode == ("BLEND" if (expected[:, 3] < 1).any() else "OPAQUE")


def accessor(gltf: Any, index: int, dtype: str, n_columns: int) -> npt.NDArray[Any]:
    """Values of an accessor, shape (count, n_columns)."""
    item = gltf.accessors[index]
    view = gltf.bufferViews[item.bufferView]
    start = (view.byteOffset or 0) + (item.byteOffset or 0)
    count = item.count * n_columns
    values = np.frombuffer(gltf.binary_blob(), dtype, count, start)
    return values.reshape(item.count, n_columns)


@pytest.mark.parametrize("suffix", [".ply", ".obj", ".glb"])
def test_a_missing_trimesh_is_named_with_the_command_that_installs_it(
    suffix: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    load = builtins.__import__

    def without_trimesh(name: str, *arguments: Any) -> Any:
        if name == "trimesh":
            raise ImportError(name)
        return load(name, *arguments)

    monkeypatch.setattr(builtins, "__import__", without_trimesh)
    path = tmp_path / f"mesh{suffix}"
    with pytest.raises(vmesh.VmeshError, match="pip install trimesh"):
        vmesh.export(one_triangle(), path)
    assert not path.exists()
    path.write_bytes(b"")
    with pytest.raises(vmesh.VmeshError, match="pip install trimesh"):
        vmesh.import_mesh(path)


def test_a_mesh_of_more_vertices_than_allowed_is_not_exported(tmp_path: Path) -> None:
    limits = vmesh.Limits(max_vertices=2)
    for name in [*FORMATS, "mesh.txt"]:
        with pytest.raises(vmesh.LimitError, match="3 vertices"):
            vmesh.export(one_triangle(), tmp_path / name, limits=limits)


def test_trimesh_says_nothing_of_its_own(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], caplog: pytest.LogCaptureFixture
) -> None:
    vmesh.export(one_triangle(), tmp_path / "mesh.ply", ascii=True)
    text = (tmp_path / "mesh.ply").read_text("ascii")
    (tmp_path / "mesh.ply").write_text(text.replace("vertex 3", "vertex 4"), "ascii")
    with caplog.at_level(logging.CRITICAL), pytest.raises(vmesh.MeshError):
        vmesh.import_mesh(tmp_path / "mesh.ply")
    assert capfd.readouterr().err == ""
