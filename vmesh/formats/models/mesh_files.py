"""Mesh <-> the files of modelling programs, PLY, OBJ and glTF, through trimesh."""

from __future__ import annotations

import io
import logging
import re
import warnings
from collections.abc import Iterator
from types import ModuleType
from typing import Any, BinaryIO, Final

import numpy as np

from vmesh.arrays import Int64Array, UInt8Array
from vmesh.errors import LimitError, MeshError, VmeshError
from vmesh.formats.models.colors import colors_of_properties, rgba_of
from vmesh.formats.models.gltf import (
    COLOR,
    finish_tree,
    linear_from_srgb,
    srgb_from_linear,
    with_renamed_colors,
)
from vmesh.formats.models.plane import Surface, surface_of
from vmesh.formats.models.ply import with_triangles
from vmesh.limits import DEFAULT_LIMITS, Limits
from vmesh.mesh import Mesh

# Most text of two triangles and a vertex with all that programs say of it.
_BYTES_PER_VERTEX: Final = 1024
_NO_COLORS: Final = "expected a colour at every vertex, found none"
_LONG_VERTEX: Final = re.compile(r"^ *v(?: +[^ \r\n]+){7}", re.MULTILINE)
_SILENCE: Final = logging.NullHandler()
_AS_IT_IS: Final = {"process": False, "maintain_order": True, "skip_materials": True}


def import_trimesh() -> ModuleType:
    """The module trimesh, which is not installed with vmesh.

    Raises
    ------
    VmeshError
        If it is not installed.
    """
    try:
        import trimesh
    except ImportError:
        raise VmeshError("PLY, OBJ and GLB files need trimesh: pip install trimesh") from None
    logging.getLogger("trimesh").addHandler(_SILENCE)  # a program's own handlers hear it still
    return trimesh


def write_ply(
    mesh: Mesh, stream: BinaryIO, *, ascii: bool = False, limits: Limits = DEFAULT_LIMITS
) -> None:
    """Write a mesh as PLY, little-endian binary or text; colours in 8 bits."""
    encoding = "ascii" if ascii else "binary_little_endian"
    _write(mesh, stream, "ply", limits, encoding=encoding)


def write_obj(mesh: Mesh, stream: BinaryIO, *, limits: Limits = DEFAULT_LIMITS) -> None:
    """Write a mesh as OBJ with lines ``v x y z r g b``; colours in 8 bits.

    Raises
    ------
    ValueError
        If it has alpha, of which OBJ knows nothing.
    """
    if mesh.n_components == 4:
        raise ValueError("OBJ holds no alpha: choose PLY or GLB")
    _write(mesh, stream, "obj", limits)


def write_glb(mesh: Mesh, stream: BinaryIO, *, limits: Limits = DEFAULT_LIMITS) -> None:
    """Write a mesh as glTF 2.0 in one file, to be shown unlit."""
    limits.check_vertices(mesh.n_vertices)
    surface = surface_of(mesh)
    colors = linear_from_srgb(surface.colors)
    made = import_trimesh().Trimesh(
        surface.points, surface.triangles, vertex_attributes={COLOR: colors}, process=False
    )
    stream.write(
        made.export(file_type="glb", tree_postprocessor=lambda tree: finish_tree(tree, colors))
    )


def _write(mesh: Mesh, stream: BinaryIO, kind: str, limits: Limits, **options: Any) -> None:
    limits.check_vertices(mesh.n_vertices)
    surface = surface_of(mesh)
    made = import_trimesh().Trimesh(
        surface.points, surface.triangles, vertex_colors=surface.colors, process=False
    )
    data = made.export(file_type=kind, **options)
    stream.write(data.encode("ascii") if isinstance(data, str) else data)


def read_surface(data: bytes, kind: str, *, limits: Limits = DEFAULT_LIMITS) -> Surface:
    """All coloured triangles of a file, at the places where its scene has them.

    Parameters
    ----------
    data : bytes
    kind : {"ply", "obj", "glb"}
        Kind of the file.
    limits : Limits

    Raises
    ------
    MeshError
        If the file cannot be read, or has no vertex colours.
    LimitError
        If it has more than `limits` allow.
    VmeshError
        If trimesh is not installed.
    """
    import_trimesh()
    if len(data) > limits.max_vertices * _BYTES_PER_VERTEX:
        raise LimitError(
            f"the file has {len(data)} bytes, but the limit is {_BYTES_PER_VERTEX} "
            f"for each of at most {limits.max_vertices} vertices"
        )
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            # Only so does NumPy refuse text that is no number.
            warnings.filterwarnings("error", message="string or file could not be read")
            parts = _parts_of_glb(data, limits) if kind == "glb" else _parts_of_text(data, kind)
            return _joined(list(_within(parts, limits)))
    except (MeshError, LimitError, MemoryError):
        raise
    except Exception as error:
        # Damaged files make trimesh and NumPy raise errors of all kinds.
        raise MeshError(f"the {kind.upper()} file is damaged: {error}") from None


def _parts_of_glb(data: bytes, limits: Limits) -> Iterator[Surface]:
    """The surfaces of a scene, in the coordinates of the scene."""
    file = io.BytesIO(with_renamed_colors(data, limits))
    scene = import_trimesh().load_scene(file, file_type="glb", **_AS_IT_IS)
    for node in scene.graph.nodes_geometry:
        matrix, name = scene.graph[node]
        part = scene.geometry[name]
        if not hasattr(part, "faces"):  # points and lines
            continue
        linear = part.vertex_attributes.get(COLOR)
        if linear is None or len(linear) != len(part.vertices):
            raise MeshError(_NO_COLORS)
        points = part.vertices @ matrix[:3, :3].T + matrix[:3, 3]
        triangles = np.asarray(part.faces, dtype=np.int64)
        yield Surface(np.asarray(points), triangles, srgb_from_linear(linear))


def _parts_of_text(data: bytes, kind: str) -> Iterator[Surface]:
    """The surfaces of a PLY or OBJ file.

    trimesh's readers are called by themselves: its meshes have colours of 8 bits, whatever the
    numbers in the file meant.
    """
    if kind == "ply":
        from trimesh.exchange.ply import load_ply

        found = [load_ply(io.BytesIO(with_triangles(data)), fix_texture=False, skip_materials=True)]
    else:
        from trimesh.exchange.obj import load_obj

        # Names and comments may be in any encoding, and trimesh expects spaces between numbers.
        text = data.decode("utf-8", "replace").replace("\t", " ")
        if _LONG_VERTEX.search(text):
            raise MeshError("a vertex has more than x y z and red green blue, whatever that means")
        file = io.BytesIO(text.encode())
        loaded = load_obj(file, skip_materials=True, maintain_order=True)
        found = list(loaded.get("geometry", {}).values())
    for part in found:
        faces = np.asarray(part.get("faces", ()))
        if faces.ndim == 2 and faces.shape[1] >= 3:  # not of points and lines
            points = np.asarray(part["vertices"], dtype=np.float64)
            yield Surface(points, _fanned(faces.astype(np.int64)), _colors_of(part))


def _fanned(faces: Int64Array) -> Int64Array:
    """Triangles of faces with any number of corners, shape (m, k)."""
    fans = [faces[:, [0, i, i + 1]] for i in range(1, faces.shape[1] - 1)]
    return np.stack(fans, axis=1).reshape(-1, 3)


def _colors_of(part: dict[str, Any]) -> UInt8Array:
    """RGBA of the vertices of what a reader of trimesh found, shape (n, 4), uint8."""
    if "_ply_raw" in part.get("metadata", {}):
        vertex = part["metadata"]["_ply_raw"]["vertex"]
        colors = colors_of_properties({name: vertex["data"][name] for name in vertex["properties"]})
    else:
        found = part.get("vertex_colors")
        colors = None if found is None else rgba_of(list(np.transpose(found)))
    if colors is None or len(colors) != len(part["vertices"]):
        raise MeshError(_NO_COLORS)
    return colors


def _within(parts: Iterator[Surface], limits: Limits) -> Iterator[Surface]:
    """Surfaces that have no more vertices than allowed."""
    n_vertices = 0
    for part in parts:
        n_vertices += len(part.points)
        limits.check_vertices(n_vertices)
        yield part


def _joined(parts: list[Surface]) -> Surface:
    """Several surfaces as one."""
    if not parts:
        raise MeshError("expected a mesh of triangles, found none")
    firsts = np.cumsum([0, *(len(part.points) for part in parts)])
    return Surface(
        np.concatenate([part.points for part in parts]),
        np.concatenate([p.triangles + first for p, first in zip(parts, firsts, strict=False)]),
        np.concatenate([part.colors for part in parts]),
    )
