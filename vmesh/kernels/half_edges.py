"""Half-edges of a triangle mesh.

Triangle t has the half-edges 3t, 3t+1, 3t+2; half-edge e leaves vertex ``triangles.flat[e]``.
"""

from __future__ import annotations

import numpy as np

from vmesh.arrays import BoolArray, Int32Array, Int64Array
from vmesh.kernels.jit import kernel


@kernel
def find_twins(triangles: Int32Array, n_vertices: int) -> Int32Array:
    """Half-edge across each half-edge, shape (3 m,), int32; -1 on the border.

    `triangles` has shape (m, 3), int32, and no two of them on the same side of an edge.
    """
    origin = triangles.reshape(-1)
    # The half-edges that leave each vertex, one vertex after the other.
    starts = np.zeros(n_vertices + 1, np.int64)
    for e in range(origin.shape[0]):
        starts[origin[e] + 1] += 1
    for v in range(n_vertices):
        starts[v + 1] += starts[v]
    filled = starts.copy()
    leaving = np.empty(origin.shape[0], np.int32)
    for e in range(origin.shape[0]):
        leaving[filled[origin[e]]] = e
        filled[origin[e]] += 1
    twin = np.full(origin.shape[0], -1, np.int32)
    # Those that leave a vertex, by their ends; what is left of other vertices starts elsewhere.
    # So a vertex of very many triangles costs no more than its share.
    to = np.full(n_vertices, -1, np.int32)
    for v in range(n_vertices):
        for i in range(starts[v], starts[v + 1]):
            e = leaving[i]
            to[origin[e - 2 if e % 3 == 2 else e + 1]] = e
        for i in range(starts[v], starts[v + 1]):
            arriving = leaving[i] + 2 if leaving[i] % 3 == 0 else leaving[i] - 1
            e = to[origin[arriving]]
            if e >= 0 and origin[e] == v:
                twin[arriving] = e
    return twin


@kernel
def walk_outlines(
    starts: Int64Array, twins: Int32Array, inner: BoolArray
) -> tuple[Int64Array, Int64Array]:
    """Loops of half-edges around regions of triangles.

    Parameters
    ----------
    starts : ndarray
        Shape (k,), int64: the half-edges on outlines; a loop starts at the first that is left.
    twins : ndarray
        Shape (3 m,), int32: as by :func:`find_twins`.
    inner : ndarray
        Shape (3 m,), bool: whether the region goes on across a half-edge.

    Returns
    -------
    ordered : ndarray
        Shape (k,), int64: the half-edges in turn.
    loops : ndarray
        Shape (l,), int64: where each loop starts among them.
    """
    ordered = np.empty(starts.shape[0], np.int64)
    loops = np.empty(starts.shape[0], np.int64)
    seen = np.zeros(twins.shape[0], np.bool_)
    n, n_loops = 0, 0
    for e in starts:
        if not seen[e]:
            loops[n_loops] = n
            n_loops += 1
        while not seen[e]:
            seen[e] = True
            ordered[n] = e
            n += 1
            e = e - 2 if e % 3 == 2 else e + 1
            # Turn about the corner, from triangle to triangle, until the region ends.
            while inner[e]:
                e = twins[e] - 2 if twins[e] % 3 == 2 else twins[e] + 1
    return ordered, loops[:n_loops]
