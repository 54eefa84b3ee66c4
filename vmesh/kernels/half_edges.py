"""Half-edges of a triangle mesh.

Triangle t has the half-edges 3t, 3t+1, 3t+2; half-edge e leaves vertex ``triangles.flat[e]``.
"""

from __future__ import annotations

import numpy as np

from vmesh.arrays import Int32Array
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
