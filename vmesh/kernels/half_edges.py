"""Half-edges of a triangle mesh, and independent sets of its vertices.

Triangle t has the half-edges 3t, 3t+1, 3t+2; half-edge e leaves vertex ``triangles.flat[e]``.
"""

from __future__ import annotations

import numpy as np

from vmesh.arrays import BoolArray, Int32Array, Int64Array
from vmesh.kernels.jit import inner_kernel, kernel


@inner_kernel
def leave(origin: Int32Array, n_vertices: int) -> tuple[Int64Array, Int32Array]:
    """Half-edges in the order of the vertices that they leave, and where those of each start."""
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
    return starts, leaving


@kernel
def find_twins(triangles: Int32Array, n_vertices: int) -> Int32Array:
    """Half-edge across each half-edge, shape (3 m,), int32; -1 on the border.

    `triangles` has shape (m, 3), int32, and no two of them on the same side of an edge.
    """
    origin = triangles.reshape(-1)
    starts, leaving = leave(origin, n_vertices)
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
def independent_set(
    triangles: Int32Array, kept: BoolArray, max_triangles: int
) -> tuple[Int32Array, Int64Array, Int32Array]:
    """Vertices no two of which are neighbours, taken greedily in order, and their neighbours.

    Parameters
    ----------
    triangles : ndarray
        Shape (m, 3), int32, indices below n.
    kept : ndarray
        Shape (n,), bool: vertices that must not be taken.
    max_triangles : int
        Vertices of more triangles than this are not taken either.

    Returns
    -------
    taken : ndarray
        Shape (k,), int32, ascending.
    starts : ndarray
        Shape (k + 1,), int64: where the neighbours of each start in the next array.
    neighbours : ndarray
        Shape (starts[k],), int32.
    """
    n_vertices = kept.shape[0]
    corners = triangles.reshape(-1)
    first, leaving = leave(corners, n_vertices)
    blocked = kept.copy()
    taken = np.empty(n_vertices, np.int32)
    starts = np.zeros(n_vertices + 1, np.int64)
    neighbours = np.empty(2 * corners.shape[0], np.int32)
    count, end = 0, 0
    for v in range(n_vertices):
        if blocked[v] or first[v + 1] - first[v] > max_triangles:
            continue
        for i in range(first[v], first[v + 1]):
            t = leaving[i] // 3
            for e in range(3 * t, 3 * t + 3):
                u = corners[e]
                known = u == v
                for j in range(starts[count], end):
                    known = known or neighbours[j] == u
                if not known:
                    neighbours[end] = u
                    end += 1
                    blocked[u] = True
        taken[count] = v
        count += 1
        starts[count] = end
    return taken[:count].copy(), starts[: count + 1].copy(), neighbours[:end].copy()
