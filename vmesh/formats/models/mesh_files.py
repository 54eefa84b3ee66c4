"""Mesh <-> the files of modelling programs, PLY, OBJ and glTF, through trimesh."""

from __future__ import annotations

import io
import logging
import warnings
from collections.abc import Iterator
from types import ModuleType
from typing import Any, BinaryIO, Final

import numpy as np

from vmesh.arrays import UInt8Array
from vmesh.errors import LimitError, MeshError, VmeshError
from vmesh.formats.models.gltf import (
    COLOR,
    finish_tree,
    linear_from_srgb,
    srgb_from_linear,
    with_renamed_colors,
)
from vmesh.formats.models.plane import Surface, surface_of
from vmesh.limits import DEFAULT_LIMITS, Limits
from vmesh.mesh import Mesh

# Most text of two triangles and a vertex with all that programs say of it.
_BYTES_PER_VERTEX: Final = 1024
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
    trimesh = import_trimesh()
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
            scene = trimesh.load_scene(
                io.BytesIO(_prepared(data, kind, limits)), file_type=kind, **_AS_IT_IS
            )
            return _joined(list(_parts(scene, limits)))
    except (MeshError, LimitError, MemoryError):
        raise
    except Exception as error:
        # Damaged files make trimesh and NumPy raise errors of all kinds.
        raise MeshError(f"the {kind.upper()} file is damaged: {error}") from None


def _prepared(data: bytes, kind: str, limits: Limits) -> bytes:
    """A file as trimesh is to read it."""
    if kind == "glb":
        return with_renamed_colors(data, limits)
    if kind == "obj":  # names and comments may be in any encoding
        return data.decode("utf-8", "replace").encode()
    return data


def _parts(scene: Any, limits: Limits) -> Iterator[Surface]:
    """The surfaces of a scene, in the coordinates of the scene."""
    n_vertices = 0
    for node in scene.graph.nodes_geometry:
        matrix, name = scene.graph[node]
        part = scene.geometry[name]
        if not hasattr(part, "faces"):  # points and lines
            continue
        n_vertices += len(part.vertices)
        limits.check_vertices(n_vertices)
        points = part.vertices @ matrix[:3, :3].T + matrix[:3, 3]
        triangles = np.asarray(part.faces, dtype=np.int64)
        yield Surface(np.asarray(points), triangles, _colors_of(part))


def _colors_of(part: Any) -> UInt8Array:
    """RGBA of the vertices, shape (n, 4), uint8."""
    linear = part.vertex_attributes.get(COLOR)
    if linear is not None and len(linear) == len(part.vertices):
        return srgb_from_linear(linear)
    if part.visual.kind != "vertex":
        raise MeshError("expected a colour at every vertex, found none")
    return np.asarray(part.visual.vertex_colors, dtype=np.uint8)


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
