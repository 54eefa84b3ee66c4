"""The canonical Delaunay triangulation of integer points, by an exact radial sweep.

Points are added in order of their distance from a centre. All earlier points lie in the disc
that the new point is outside of, or on the rim of, so the new point always sees a part of their
convex hull: it is joined to that part, and edges are flipped until every one is locally Delaunay
(the in-circle test), in the manner of Lawson.

All tests are exact, on integers with sides of at most 2**19 (``predicates``); half-edges are those
of ``half_edges``.

Ties (four points on a circle) are broken without regard to any order of work: the diagonal that
touches the quad's last vertex in raster order wins. This is the triangulation that results when
every point's height on the paraboloid is lowered by an infinitesimal that grows with its raster
order, so it is unique.

References
----------
D. A. Sinclair, "S-hull: a fast radial sweep-hull routine for Delaunay triangulation",
arXiv:1604.01428, 2016. C. L. Lawson, "Software for C1 surface interpolation", Mathematical Software
III, 1977. H. Edelsbrunner, E. P. Mücke, "Simulation of simplicity", ACM Transactions on Graphics
9(1), 1990: ties.
"""

from __future__ import annotations

import numpy as np

from vmesh.arrays import Int32Array, Int64Array
from vmesh.errors import LimitError
from vmesh.kernels.half_edges import flip, link, next_edge, previous_edge, sort_triangles
from vmesh.kernels.jit import inner_kernel, kernel
from vmesh.kernels.predicates import must_flip, orient

FLIPS_PER_POINT = 64
FLIPS = 1 << 20
"""Flips that any triangulation may take, beside `FLIPS_PER_POINT` for each of its points."""

COINCIDENT = -1
TOO_MANY_FLIPS = -2


@inner_kernel
def legalize(
    points: Int64Array,
    origin: Int64Array,
    twin: Int64Array,
    hull_edge: Int64Array,
    stack: Int64Array,
    edge: int,
) -> int:
    """Flip until every edge is locally Delaunay again after a point was added; count the flips.

    Parameters
    ----------
    edge : int
        The edge opposite to the new point, in the new triangle.
    hull_edge : ndarray
        Shape (n,), int64: the hull's half-edge that starts at a vertex; flips keep it right.
    stack : ndarray
        Workspace for as many edges as there are triangles; the edges on it face the new point.
    """
    n_flips = 0
    size = 1
    stack[0] = edge
    while size > 0:
        size -= 1
        e = stack[size]
        f = twin[e]
        if f < 0:
            continue
        a, d = origin[previous_edge(e)], origin[previous_edge(f)]
        if must_flip(points, a, origin[e], origin[f], d):
            flip(origin, twin, e)
            n_flips += 1
            if twin[e] < 0:
                hull_edge[d] = e
            if twin[f] < 0:
                hull_edge[a] = f
            stack[size] = e
            stack[size + 1] = next_edge(f)
            size += 2
    return n_flips


@inner_kernel
def pseudo_angle(dx: float, dy: float, n_keys: int) -> int:
    """Number in 0 .. n_keys - 1 that grows with the direction of (dx, dy) around the origin."""
    length = abs(dx) + abs(dy)
    if length == 0.0:
        return 0
    ratio = dx / length
    turn = (3.0 - ratio) / 4.0 if dy > 0 else (1.0 + ratio) / 4.0
    return int(turn * n_keys) % n_keys


@kernel
def sweep(
    points: Int64Array, order: Int64Array, cx: float, cy: float, triangles: Int64Array
) -> int:
    """Number of the canonical Delaunay triangles of points, which are written to `triangles`.

    Parameters
    ----------
    points : ndarray
        Shape (n, 2), int64, distinct, in raster order, with sides of at most 2**19.
    order : ndarray
        Shape (n,), int64: the points by their distance from a centre.
    cx, cy : float
        The centre.
    triangles : ndarray
        Shape (max(2 n, 1), 3), int64, written: the triangles, positively oriented.

    Returns
    -------
    int
        0 if all points lie on a line, COINCIDENT if two are the same, TOO_MANY_FLIPS if the
        points are arranged so that the number of flips is out of all proportion.
    """
    n_points = points.shape[0]
    if n_points < 3:
        return 0
    origin = triangles.reshape(-1)
    twin = np.full(origin.shape[0], -1, np.int64)
    stack = np.empty(triangles.shape[0], np.int64)
    hull_edge = np.full(n_points, -1, np.int64)
    hull_next = np.full(n_points, -1, np.int64)  # -1: not on the hull
    hull_prev = np.full(n_points, -1, np.int64)
    n_keys = int(np.ceil(np.sqrt(n_points)))
    hull_hash = np.full(n_keys, -1, np.int64)

    # The first three points that are not on a line. The points passed over lie on the line of the
    # first two, beyond their segment, so they are outside the first triangle as well.
    a, b = order[0], order[1]
    if points[a, 0] == points[b, 0] and points[a, 1] == points[b, 1]:
        return COINCIDENT
    seed = 2
    side = 0
    while seed < n_points:
        c = order[seed]
        side = orient(points, a, b, c)
        if side != 0:
            break
        seed += 1
    if side == 0:
        return 0
    c = order[seed]
    if side < 0:
        a, b = b, a
    origin[0], origin[1], origin[2] = a, b, c
    hull_edge[a], hull_edge[b], hull_edge[c] = 0, 1, 2
    hull_next[a], hull_next[b], hull_next[c] = b, c, a
    hull_prev[a], hull_prev[b], hull_prev[c] = c, a, b
    for v in (a, b, c):
        hull_hash[pseudo_angle(points[v, 0] - cx, points[v, 1] - cy, n_keys)] = v
    last = c
    n_edges = int(np.int64(3))  # a literal is a type of its own, compiled apart
    flips_left = FLIPS + FLIPS_PER_POINT * n_points

    for i in range(2, n_points):
        if i == seed:
            continue
        p = order[i]
        px, py = points[p, 0], points[p, 1]
        key = pseudo_angle(px - cx, py - cy, n_keys)
        start = last
        for j in range(n_keys):
            hint = hull_hash[(key + j) % n_keys]
            if hint >= 0 and hull_next[hint] >= 0:
                start = hull_prev[hint]
                break
        # The first hull edge that the point sees, from the hint onwards ...
        v = start
        w = hull_next[v]
        while orient(points, v, w, p) >= 0:
            v = w
            w = hull_next[v]
            if v == start:
                return COINCIDENT
        # ... or before it, if the hint was in the midst of the edges that it sees.
        if v == start:
            u = hull_prev[v]
            while orient(points, u, v, p) < 0:
                v = u
                u = hull_prev[v]
        # A triangle (u, w, p) for each edge w -> u that it sees.
        w = v
        u = hull_next[w]
        while orient(points, w, u, p) < 0:
            e = n_edges
            n_edges += 3
            origin[e], origin[e + 1], origin[e + 2] = u, w, p
            link(twin, e, hull_edge[w])
            if w == v:
                hull_edge[w] = e + 1
            else:
                link(twin, e + 1, hull_edge[p])
                hull_next[w] = -1
            hull_edge[p] = e + 2
            flips_left -= legalize(points, origin, twin, hull_edge, stack, e)
            if flips_left < 0:
                return TOO_MANY_FLIPS
            w = u
            u = hull_next[w]
        hull_next[v], hull_prev[p] = p, v
        hull_next[p], hull_prev[w] = w, p
        hull_hash[key] = p
        last = p
    return n_edges // 3


@kernel
def flip_to_delaunay(
    points: Int64Array,
    origin: Int64Array,
    twin: Int64Array,
    created: Int64Array,
    removed: Int64Array,
) -> int:
    """Flip the edges of a triangulation until it is the canonical Delaunay triangulation.

    An edge that a flip removes never comes back: every flip lowers the surface that the
    triangulation spans over the paraboloid (Lawson). So the flips, read backwards, lead from the
    Delaunay triangulation to this one, and each edge is removed at most once.

    Parameters
    ----------
    points : ndarray
        Shape (n, 2), int64, in raster order.
    origin, twin : ndarray
        Shape (3 m,), int64: half-edges; overwritten.
    created, removed : ndarray
        Shape (k,), int64, written: the edge that each flip made and the one that it took away, the
        lower vertex in the upper 32 bits.

    Returns
    -------
    int
        Number of flips, TOO_MANY_FLIPS if there are more than k.
    """
    n_edges = origin.shape[0]
    stack = np.empty(n_edges, np.int64)
    waiting = np.zeros(n_edges, np.bool_)
    size = 0
    for inner in range(n_edges):
        if twin[inner] > inner:
            stack[size] = inner
            size += 1
            waiting[inner] = True
    count = 0
    while size > 0:
        size -= 1
        e = np.int64(stack[size])
        waiting[e] = False
        f = np.int64(twin[e])
        if f < 0:
            continue
        a, b, c, d = origin[previous_edge(e)], origin[e], origin[f], origin[previous_edge(f)]
        if not must_flip(points, a, b, c, d):
            continue
        if count == created.shape[0]:
            return TOO_MANY_FLIPS
        created[count] = np.int64(min(a, d)) << 32 | max(a, d)
        removed[count] = np.int64(min(b, c)) << 32 | max(b, c)
        count += 1
        flip(origin, twin, e)
        for g in (e, next_edge(e), f, next_edge(f)):
            if not waiting[g]:
                stack[size] = g
                size += 1
                waiting[g] = True
    return count


def delaunay(vertices: Int32Array) -> Int32Array:
    """Canonical Delaunay triangles of integer points.

    Parameters
    ----------
    vertices : ndarray
        Shape (n, 2), int32, distinct, in raster order (by y, then x), 0 to 2**19.

    Returns
    -------
    ndarray
        Shape (m, 3), int32, positively oriented, in canonical order. Of four points on a circle
        the diagonal that touches the last one in raster order is taken. Empty if all points lie
        on a line.

    Raises
    ------
    ValueError
        If two points coincide.
    LimitError
        If the points are arranged so that it would take more than FLIPS_PER_POINT edge flips for
        each: photographs take about four, a hostile file could ask for the square of their number.
    """
    points = vertices.astype(np.int64)
    if len(points) < 3:
        return np.empty((0, 3), dtype=np.int32)
    triangles = np.empty((max(2 * len(points), 1), 3), dtype=np.int64)
    doubled_center = points.min(axis=0) + points.max(axis=0)
    offsets = 2 * points - doubled_center
    order = np.argsort((offsets * offsets).sum(axis=1))
    cx, cy = (doubled_center / 2).tolist()
    count = sweep(points, order, cx, cy, triangles)
    if count == COINCIDENT:
        raise ValueError("two vertices share a position")
    if count == TOO_MANY_FLIPS:
        raise LimitError(f"the triangulation of {len(points)} vertices takes too many edge flips")
    return sort_triangles(triangles[:count].astype(np.int32), len(points))
