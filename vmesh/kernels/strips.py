"""Strips: all triangles of a mesh, written as few vertices as can be.

::

        b-------d           A strip goes from triangle to triangle. With a, b, c the corners of
       / \\     /            the last one, in the order in which they were written, the next
      /   \\   /             vertex d and its flag make a triangle:
     /     \\ /
    a-------c               0   d begins a strip: its first three corners, each with flag 0
                            1   b, c, d
                            2   a, c, d

Each triangle after the first shares a side that has the newest vertex, so any path from triangle
to triangle across their sides can be written. Paths are found greedily: go where the fewest ways
are left, so that no triangle ends up alone; at the end of a path begin the next one beside the
triangle that was drawn last, so that vertices come again soon after they came first, which makes
the result compress well.

References
----------
ISO 32000-2, 8.7.4.5.5: free-form Gouraud-shaded triangle meshes, and their edge flags. F. Evans,
S. Skiena, A. Varshney, "Optimizing triangle strips for fast rendering", IEEE Visualization 1996:
greedy paths to the neighbour with the fewest neighbours.
"""

from __future__ import annotations

import numpy as np

from vmesh.arrays import BoolArray, Int32Array, Int64Array, UInt8Array
from vmesh.kernels.jit import inner_kernel, kernel

NO_SIDE = -1


@kernel
def find_strips(triangles: Int32Array, twins: Int64Array) -> tuple[UInt8Array, Int32Array]:
    """Flags and vertices that write every triangle once.

    Parameters
    ----------
    triangles : ndarray
        Shape (m, 3), int32.
    twins : ndarray
        Shape (3 m,), int64: the half-edge across each half-edge, -1 on the border.

    Returns
    -------
    flags : ndarray
        Shape (k,), uint8, with k from m + 2 to 3 m: 0, 1 or 2.
    vertices : ndarray
        Shape (k,), int32: indices of vertices.
    """
    entries = _cover(twins, triangles.shape[0])
    return _write(triangles, entries)


@kernel
def _cover(twins: Int64Array, n_triangles: int) -> Int32Array:
    """Paths through all triangles, one after the other, shape (m, 2), int32.

    Each row is a triangle and its half-edge towards the one before, -1 where a path begins.
    """
    path = np.empty((n_triangles, 2), np.int32)
    drawn = np.zeros(n_triangles, np.bool_)
    # Triangles of the paths so far, the last on top: those on the bottom may have ways left.
    pile = np.empty(n_triangles, np.int32)
    height = 0
    first = 0
    side = NO_SIDE
    for i in range(n_triangles):
        is_start = side == NO_SIDE
        while is_start and side == NO_SIDE and height > 0:
            side = _best_way(pile[height - 1], twins, drawn)
            if side == NO_SIDE:
                height -= 1
        while side == NO_SIDE and drawn[first]:
            first += 1
        t = first if side == NO_SIDE else side // 3
        path[i, 0], path[i, 1] = t, NO_SIDE if is_start else side
        drawn[t] = True
        pile[height] = t
        height += 1
        side = _best_way(t, twins, drawn)
    return path


@inner_kernel
def _best_way(t: int, twins: Int64Array, drawn: BoolArray) -> int:
    """Half-edge by which to enter the neighbour with the fewest ways on, -1 if none is left."""
    best = NO_SIDE
    fewest = 4
    for e in range(3 * t, 3 * t + 3):
        u = twins[e] // 3
        if twins[e] == NO_SIDE or drawn[u]:
            continue
        ways = 0
        for f in range(3 * u, 3 * u + 3):
            if twins[f] != NO_SIDE and not drawn[twins[f] // 3]:
                ways += 1
        if ways < fewest or (ways == fewest and u < best // 3):
            fewest = ways
            best = twins[e]
    return best


@kernel
def _write(triangles: Int32Array, path: Int32Array) -> tuple[UInt8Array, Int32Array]:
    """Flags and vertices of the paths."""
    flags = np.zeros(3 * path.shape[0], np.uint8)
    vertices = np.empty(3 * path.shape[0], np.int32)
    size = 0
    a, b, c = 0, 0, 0
    for i in range(path.shape[0]):
        t, side = path[i]
        if side == NO_SIDE:
            ahead = path[i + 1, 1] if i + 1 < path.shape[0] else NO_SIDE
            a, b, c = _turned(triangles, t, ahead)
            vertices[size] = a
            vertices[size + 1] = b
            vertices[size + 2] = c
            size += 3
            continue
        start = triangles[t, side % 3]
        end = triangles[t, (side + 1) % 3]
        shares_b = b in (start, end)
        flags[size] = 1 if shares_b else 2
        vertices[size] = triangles[t, (side + 2) % 3]
        a, b, c = b if shares_b else a, c, vertices[size]
        size += 1
    return flags[:size], vertices[:size]


@inner_kernel
def _turned(triangles: Int32Array, t: int, ahead: int) -> tuple[int, int, int]:
    """Corners of a triangle, first the one that is not on the half-edge of the next triangle."""
    first = 0
    if ahead != NO_SIDE:
        start = triangles[ahead // 3, ahead % 3]
        end = triangles[ahead // 3, (ahead + 1) % 3]
        while triangles[t, first] == start or triangles[t, first] == end:
            first += 1
    return triangles[t, first], triangles[t, (first + 1) % 3], triangles[t, (first + 2) % 3]
