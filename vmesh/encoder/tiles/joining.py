"""The meshes of the tiles of a picture as one mesh, whose triangles keep to their tiles.

Neighbours choose the vertices of the side that they share without regard to each other. The joined
mesh has the vertices of both: a triangle becomes a fan where the other tile has vertices on its
edge::

    u         u             from u to v the line between two tiles,
    | \\       | \\           p a vertex of the tile on the left
    |   w     p - w
    | /       | /
    v         v

A tile that knows nothing of its neighbours has many vertices in its outermost rings of pixels. The
slivers between them and the side would show as a seam in an enlarged picture, so these vertices are
put on the side.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from vmesh.arrays import Int32Array, Int64Array
from vmesh.encoder.draft import UNIT
from vmesh.grid import Grid
from vmesh.mesh.areas import doubled_areas
from vmesh.mesh.canonical_order import raster_keys, sorted_triangles

# Vertices at most so many half pixels from a line are put on it. With 1 a notch is left here and
# there where an edge of the picture crosses the line. kodim05, 15 and 23 in tiles of 256 pixels
# have 23.26, 31.45 and 34.77 dB with 1, 23.24, 31.39 and 34.76 with 3 (4,000 vertices); 26.98,
# 34.46 and 38.83 with 1, 26.99, 34.35 and 38.67 with 3 (12,000).
NEAR: Final = 3


def join(
    grid: Grid, geometries: Sequence[tuple[Int32Array, Int32Array]], near: int = NEAR
) -> tuple[Int32Array, Int32Array]:
    """Vertices, (n, 2), and triangles, (m, 3), int32, of a whole picture in canonical order.

    Parameters
    ----------
    grid : Grid
    geometries : sequence of (ndarray, ndarray)
        Vertices, shape (k, 2), int32, in lattice units from the tile's corner, and triangles of
        each tile, which cover it.
    near : int
        Vertices at most so many half pixels from a line between tiles are put on it.
    """
    places, faces, n_vertices = [], [], 0
    for tile, (vertices, triangles) in zip(grid.tiles(), geometries, strict=True):
        places.append(vertices + np.array([tile.x, tile.y], dtype=np.int32) * UNIT)
        faces.append(triangles.astype(np.int64) + n_vertices)
        n_vertices += len(vertices)
    points, corners = _put_on_lines(np.concatenate(places), np.concatenate(faces), grid, near)
    _, first, rank = np.unique(raster_keys(points), return_index=True, return_inverse=True)
    points, corners = points[first], rank[corners]
    for axis in (0, 1):
        corners = _fan_out(points, corners, axis)
    return points, sorted_triangles(corners)


def _put_on_lines(
    points: Int32Array, triangles: Int64Array, grid: Grid, near: int
) -> tuple[Int32Array, Int64Array]:
    """Move vertices that are close to a line between tiles onto it; drop what then vanishes.

    A vertex stays where a triangle would be turned over, or lose its area and not lie on a line.
    """
    far = np.array([grid.width, grid.height]) * UNIT
    lines = np.rint(points / (grid.side * UNIT)).astype(np.int32) * (grid.side * UNIT)
    # The border of the canvas stays where it is, also where the last tiles are a pixel wide.
    is_free = (lines > 0) & (lines < far) & (points < far)
    moves = (np.abs(points - lines) <= near) & is_free
    while True:
        moved = np.where(moves, lines, points)
        areas = doubled_areas(moved, triangles)
        lies_on_line = (np.ptp(moved[triangles], axis=1) == 0).any(axis=1)
        is_lost = (areas < 0) | ((areas == 0) & ~lies_on_line)
        if not is_lost.any():
            break
        moves[triangles[is_lost]] = False
    used, corners = np.unique(triangles[areas > 0], return_inverse=True)
    return moved[used], corners.reshape(-1, 3)


def _fan_out(points: Int32Array, triangles: Int64Array, axis: int) -> Int64Array:
    """Split triangles at the vertices within those of their edges that are parallel to an axis.

    `points` has shape (n, 2), the triangles, before and after, (m, 3).
    """
    order = np.lexsort((points[:, axis], points[:, 1 - axis]))
    place = np.empty_like(order)
    place[order] = np.arange(len(order))
    lines = points[triangles, 1 - axis]
    is_parallel = lines == np.roll(lines, -1, axis=1)
    # No triangle has two such edges; it is turned so that such an edge is from u to v.
    turn = is_parallel.argmax(axis=1)[:, None] + np.arange(3)
    u, v, w = np.take_along_axis(triangles, turn % 3, axis=1).T
    # The vertices along the edge follow each other in the order.
    steps = np.where(is_parallel.any(axis=1), place[v] - place[u], 0)
    counts = np.maximum(np.abs(steps), 1)
    owner = np.repeat(np.arange(len(triangles)), counts)
    step = np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)
    at, way = place[u][owner], np.sign(steps)[owner]
    start = order[at + step * way]
    end = np.where(way == 0, v[owner], order[at + (step + 1) * way])
    return np.stack([start, end, w[owner]], axis=1)
