"""Rules that a mesh keeps: the ranges of its fields, and the geometry that a file may hold.

Each check raises a :class:`ValueError` that names the rule.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vmesh.limits import MAX_LATTICE_SIDE, MAX_SIDE, MAX_SUBDIVISION, MAX_TILE_SIDE
from vmesh.mesh.canonical_order import raster_keys

if TYPE_CHECKING:
    from vmesh.mesh.mesh import Mesh


def check_canvas(mesh: Mesh) -> None:
    """Refuse a canvas, a lattice or tiles of a size that no file has."""
    if not (1 <= mesh.width <= MAX_SIDE and 1 <= mesh.height <= MAX_SIDE):
        raise ValueError(
            f"expected a canvas of 1 to {MAX_SIDE} pixels a side, got {mesh.width} x {mesh.height}"
        )
    if not 0 <= mesh.subdivision <= MAX_SUBDIVISION:
        raise ValueError(
            f"expected a subdivision of 0 to {MAX_SUBDIVISION}, got {mesh.subdivision}"
        )
    side = max(mesh.width, mesh.height) * mesh.unit
    if side > MAX_LATTICE_SIDE:
        raise ValueError(
            f"expected a canvas side of at most {MAX_LATTICE_SIDE} lattice units, got {side}"
        )
    if mesh.tile is not None and not 1 <= mesh.tile <= MAX_TILE_SIDE >> mesh.subdivision:
        raise ValueError(
            f"expected tiles of 1 to {MAX_TILE_SIDE >> mesh.subdivision} pixels a side, "
            f"got {mesh.tile}"
        )


def check_arrays(mesh: Mesh) -> None:
    """Refuse arrays of another shape, and vertices, indices and levels out of their ranges."""
    expected = (
        ("vertices", mesh.vertices, mesh.n_vertices, 2),
        ("triangles", mesh.triangles, mesh.n_triangles, 3),
        ("levels", mesh.levels, mesh.n_vertices, mesh.n_components),
    )
    for name, array, rows, columns in expected:
        if array.shape != (rows, columns):
            raise ValueError(f"expected {name} of shape ({rows}, {columns}), got {array.shape}")
    far = np.array([mesh.width, mesh.height]) * mesh.unit
    if ((mesh.vertices < 0) | (mesh.vertices > far)).any():
        raise ValueError("a vertex lies outside the canvas")
    if ((mesh.triangles < 0) | (mesh.triangles >= mesh.n_vertices)).any():
        raise ValueError("a triangle names a vertex that does not exist")
    lowest, highest = mesh.lattice.level_bounds()
    if ((mesh.levels < lowest) | (mesh.levels > highest)).any():
        raise ValueError("a colour level lies outside its component's range")


def check_geometry(mesh: Mesh) -> None:
    """Refuse a mesh that does not cover each point of its canvas once: :meth:`Mesh.check`."""
    if np.unique(raster_keys(mesh.vertices)).size != mesh.n_vertices:
        raise ValueError("two vertices share a position")
    _check_area(mesh)
    _check_edges(mesh)
    _check_tiles(mesh)


def _check_area(mesh: Mesh) -> None:
    areas = mesh.doubled_areas()
    if (areas <= 0).any():
        raise ValueError("a triangle has no area or is turned the wrong way")
    whole = 2 * mesh.width * mesh.height * mesh.unit**2
    # Each area is at most 2**39: sums of 2**23 of them stay within 64 bits.
    blocks = range(0, mesh.n_triangles, 1 << 23)
    if sum(int(areas[first : first + (1 << 23)].sum()) for first in blocks) != whole:
        raise ValueError("the triangles do not cover the canvas exactly")


def _check_edges(mesh: Mesh) -> None:
    start = mesh.triangles.astype(np.int64)
    end = np.roll(start, -1, axis=1)
    forward = np.sort((start * mesh.n_vertices + end).ravel())
    if (forward[1:] == forward[:-1]).any():
        raise ValueError("two triangles lie on the same side of an edge")
    backward = (end * mesh.n_vertices + start).ravel()
    place = np.minimum(np.searchsorted(forward, backward), forward.size - 1)
    lone = forward[place] != backward
    ends = mesh.vertices[np.stack([start.ravel()[lone], end.ravel()[lone]], axis=1)]
    same = ends[:, 0] == ends[:, 1]
    far = np.array([mesh.width, mesh.height]) * mesh.unit
    on_border = same & ((ends[:, 0] == 0) | (ends[:, 0] == far))
    if not on_border.any(axis=1).all():
        raise ValueError("an inner edge belongs to only one triangle")
    if not np.bincount(mesh.triangles.ravel(), minlength=mesh.n_vertices).all():
        raise ValueError("a vertex belongs to no triangle")


def _check_tiles(mesh: Mesh) -> None:
    if mesh.tile is None:
        return
    corners = mesh.vertices[mesh.triangles]
    side = mesh.tile * mesh.unit
    # Counted from the line before the lowest corner.
    reach = corners.max(axis=1) - corners.min(axis=1) // side * side
    if (reach > side).any():
        raise ValueError("a triangle crosses the line between two tiles")
