"""Half-edges of a triangle mesh: walks around them, and the edits that all meshing is made of.

Triangle t has the half-edges 3t, 3t+1, 3t+2. ``origin[e]``, which is ``triangles.flat[e]``, is the
vertex that half-edge e leaves, and ``twin[e]`` the half-edge on its other side, -1 on the border::

               a                 edge e runs from b to c, its twin from c to b;
             / | \\               the quad a, b, d, c has the diagonal b-c now
            /  |  \\              and a-d after a flip
           b --e-- c
            \\  |  /
             \\ | /
               d

References
----------
S. Campagna, L. Kobbelt, H.-P. Seidel, "Directed edges: a scalable representation for triangle
meshes", Journal of Graphics Tools 3(4), 1998: half-edges that are numbered by their triangles.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np

from vmesh.arrays import BoolArray, Int32Array, Int64Array
from vmesh.kernels.jit import inner_kernel, kernel

Index: TypeAlias = int | np.integer


@inner_kernel
def next_edge(e: Index) -> int:
    """Half-edge after e in the same triangle."""
    return e - 2 if e % 3 == 2 else e + 1


@inner_kernel
def previous_edge(e: Index) -> int:
    """Half-edge before e in the same triangle."""
    return e + 2 if e % 3 == 0 else e - 1


@inner_kernel
def link(twin: Int64Array, e: Index, f: Index) -> None:
    """Make two half-edges each other's twin; either may be -1."""
    if e >= 0:
        twin[e] = f
    if f >= 0:
        twin[f] = e


@inner_kernel
def place_triangle(origin: Int64Array, leaving: Int64Array, t: int, a: int, b: int, c: int) -> None:
    """Make t the triangle a, b, c; the twins of its sides are left as they were."""
    e = 3 * t
    origin[e], origin[e + 1], origin[e + 2] = a, b, c
    leaving[a], leaving[b], leaving[c] = e, e + 1, e + 2


@inner_kernel
def flip(origin: Int64Array, twin: Int64Array, e: Index) -> None:
    """Turn the diagonal of the two triangles at half-edge e.

    Before, e runs from b to c and the triangles are (b, c, a) and (c, b, d); after, e's triangle
    is (d, c, a) with the diagonal as the half-edge from a to d, and the other is (a, b, d).
    """
    f = twin[e]
    e_prev, f_prev = previous_edge(e), previous_edge(f)
    a, d = origin[e_prev], origin[f_prev]
    outer_e, outer_f = twin[e_prev], twin[f_prev]
    origin[e] = d
    origin[f] = a
    link(twin, e, outer_f)
    link(twin, f, outer_e)
    link(twin, e_prev, f_prev)
    # e: d -> c, e_next: c -> a, e_prev: a -> d;  f: a -> b, f_next: b -> d, f_prev: d -> a.


@inner_kernel
def collect_ring(
    origin: Int64Array, twin: Int64Array, start: int, star: Int64Array, ring: Int64Array
) -> tuple[int, int]:
    """Neighbours of a vertex, into `ring`, and the half-edges that leave it, into `star`.

    Both are in positive order, and `start` is one of the half-edges. Returns the number of
    neighbours, 0 if there are more triangles than `star` holds, and the number of triangles, which
    is one less on the border.
    """
    first = start
    # On the border, turn back to the first triangle.
    while twin[first] >= 0:
        first = next_edge(twin[first])
        if first == start:
            break
    e = first
    n = 0
    while True:
        if n == star.shape[0]:
            return 0, 0
        star[n] = e
        ring[n] = origin[next_edge(e)]
        n += 1
        arriving = previous_edge(e)
        e = twin[arriving]
        if e < 0:
            ring[n] = origin[arriving]
            return n + 1, n
        if e == first:
            return n, n


@kernel
def find_twins(triangles: Int32Array, n_vertices: int) -> Int64Array:
    """Half-edge across each half-edge, shape (3 m,), int64; -1 on the border.

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
    leaving = np.empty(origin.shape[0], np.int64)
    for e in range(origin.shape[0]):
        leaving[filled[origin[e]]] = e
        filled[origin[e]] += 1
    twin = np.full(origin.shape[0], -1, np.int64)
    # The half-edges that leave a vertex, by their ends; entries of earlier vertices are told apart
    # by where they start. So a vertex of very many triangles costs no more than its share.
    to = np.full(n_vertices, -1, np.int64)
    for v in range(n_vertices):
        for i in range(starts[v], starts[v + 1]):
            e = leaving[i]
            to[origin[next_edge(e)]] = e
        for i in range(starts[v], starts[v + 1]):
            arriving = previous_edge(leaving[i])
            e = to[origin[arriving]]
            if e >= 0 and origin[e] == v:
                twin[arriving] = e
    return twin


@kernel
def walk_outlines(
    starts: Int64Array, twins: Int64Array, inner: BoolArray
) -> tuple[Int64Array, Int64Array]:
    """Loops of half-edges around regions of triangles.

    Parameters
    ----------
    starts : ndarray
        Shape (k,), int64: the half-edges on outlines; a loop starts at the first that is left.
    twins : ndarray
        Shape (3 m,), int64: as by :func:`find_twins`.
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
            e = next_edge(e)
            # Turn about the corner, from triangle to triangle, until the region ends.
            while inner[e]:
                e = next_edge(twins[e])
    return ordered, loops[:n_loops]


@kernel
def sort_triangles(triangles: Int32Array, n_points: int) -> Int32Array:
    """Triangles with the lowest vertex first, in lexicographic order; two counting sorts.

    Parameters
    ----------
    triangles : ndarray
        Shape (m, 3), int32, indices below `n_points`; turned in place.

    Returns
    -------
    ndarray
        Shape (m, 3), int32.
    """
    count = triangles.shape[0]
    for t in range(count):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        if b < a and b < c:
            triangles[t, 0], triangles[t, 1], triangles[t, 2] = b, c, a
        elif c < a and c < b:
            triangles[t, 0], triangles[t, 1], triangles[t, 2] = c, a, b
    source = triangles
    for column in (1, 0):
        place = np.zeros(n_points + 1, np.int64)
        for t in range(count):
            place[source[t, column] + 1] += 1
        for v in range(n_points):
            place[v + 1] += place[v]
        target = np.empty_like(triangles)
        for t in range(count):
            v = source[t, column]
            for corner in range(3):
                target[place[v], corner] = source[t, corner]
            place[v] += 1
        source = target
    return source
