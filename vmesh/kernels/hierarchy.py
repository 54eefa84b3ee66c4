"""A Kirkpatrick hierarchy: layers of independent vertices taken out of a Delaunay triangulation.

An independent set, of which no two vertices are neighbours, is taken out at once, the holes are
filled, and so on with what is left. In the reverse order every vertex is inserted among the few
that surrounded it.

References
----------
D. Kirkpatrick, "Optimal search in planar subdivisions", SIAM Journal on Computing 12(1), 1983.
O. Devillers, "On deletion in Delaunay triangulations", Symposium on Computational Geometry, 1999.
"""

from __future__ import annotations

import numpy as np

from vmesh.arrays import BoolArray, Int32Array, Int64Array
from vmesh.kernels.ears import clip_ears, fill_star
from vmesh.kernels.half_edges import collect_ring, next_edge
from vmesh.kernels.jit import inner_kernel, kernel


@inner_kernel
def remove_vertex(
    points: Int64Array,
    origin: Int64Array,
    twin: Int64Array,
    leaving: Int64Array,
    v: int,
    star: Int64Array,
    ring: Int64Array,
    outer: Int64Array,
    places: Int64Array,
    ears: Int64Array,
) -> None:
    """Take a vertex out and fill the hole that is left with canonical Delaunay triangles.

    The arrays from `star` on are workspace.
    """
    size, n_triangles = collect_ring(origin, twin, leaving[v], star, ring)
    # The half-edge across each side of the rim; on the border the last side has none.
    outer[size - 1] = -1
    for k in range(n_triangles):
        outer[k] = twin[next_edge(star[k])]
    count = clip_ears(points, ring, size, places, ears, True)
    fill_star(origin, twin, leaving, star, ring, outer, ears, count)
    for k in range(max(count, 0), n_triangles):
        t = 3 * (star[k] // 3)
        origin[t] = origin[t + 1] = origin[t + 2] = -1


@kernel
def remove_independent_sets(
    points: Int64Array, origin: Int64Array, twin: Int64Array, kept: BoolArray, max_triangles: int
) -> tuple[Int32Array, Int32Array, Int64Array, Int64Array]:
    """Layers of independent vertices, taken out of a triangulation until none is left.

    In each layer, in raster order, every vertex is taken that has no more than `max_triangles`
    triangles and no neighbour that has been taken. What is left is the canonical Delaunay
    triangulation of the remaining vertices.

    Parameters
    ----------
    points : ndarray
        Shape (n, 2), int64, in raster order.
    origin, twin : ndarray
        Shape (3 m,), int64: half-edges of the canonical Delaunay triangles; overwritten.
    kept : ndarray
        Shape (n,), bool: vertices that are not taken. Those that are left at the end must be the
        corners of a rectangle that holds all others.

    Returns
    -------
    taken : ndarray
        Shape (k,), int32: layer after layer, each in raster order.
    neighbours : ndarray
        Shape (k, max_triangles + 1), int32: neighbours of each when its layer was taken.
    counts : ndarray
        Shape (k,), int64: how many neighbours each has.
    ends : ndarray
        Where the layers end among those taken, int64.
    """
    n_points = points.shape[0]
    leaving = np.full(n_points, -1, np.int64)
    for e in range(origin.shape[0]):
        leaving[origin[e]] = e
    left = np.arange(n_points).astype(np.int32)
    taken = np.empty(n_points, np.int32)
    neighbours = np.empty((n_points, max_triangles + 1), np.int32)
    counts = np.zeros(n_points, np.int64)
    ends = np.empty(n_points, np.int64)
    is_taken = np.zeros(n_points, np.bool_)
    beside = np.full(n_points, -1, np.int32)  # the last layer that took a neighbour
    star = np.empty(max_triangles, np.int64)
    ring, outer = np.empty(max_triangles + 1, np.int64), np.empty(max_triangles + 1, np.int64)
    places, ears = np.empty(max_triangles + 1, np.int64), np.empty((max_triangles, 3), np.int64)
    n_taken, n_layers, before = 0, 0, -1
    while n_taken > before:
        before = n_taken
        for v in left:
            if kept[v] or beside[v] == n_layers:
                continue
            size, _ = collect_ring(origin, twin, leaving[v], star, ring)
            for k in range(size):
                neighbours[n_taken, k] = ring[k]
                beside[ring[k]] = n_layers
            if size > 0:
                taken[n_taken] = v
                counts[n_taken] = size
                is_taken[v] = True
                n_taken += 1
        for i in range(before, n_taken):
            gone = int(taken[i])
            remove_vertex(points, origin, twin, leaving, gone, star, ring, outer, places, ears)
        left = left[~is_taken[left]]
        ends[n_layers] = n_taken
        n_layers += 1
    n_layers -= 1  # Nothing was taken in the last one.
    return taken[:n_taken], neighbours[:n_taken], counts[:n_taken], ends[:n_layers]
