"""The canonical Delaunay triangulation of integer points, by an exact radial sweep.

Points are added in order of their distance from a centre. All earlier points lie in the disc
that the new point is outside of, or on the rim of, so the new point always sees a part of their
convex hull: it is joined to that part, and edges are flipped until every one is locally Delaunay
(the in-circle test), in the manner of Lawson.

A triangle t has the half-edges 3t, 3t+1, 3t+2; ``origin[e]`` is the vertex a half-edge starts at
and ``twin[e]`` the half-edge on its other side, -1 on the hull::

               a                 edge e runs from b to c, its twin from c to b;
             / | \\               the quad a, b, d, c has the diagonal b-c now
            /  |  \\              and a-d after a flip
           b --e-- c
            \\  |  /
             \\ | /
               d

All tests are exact: coordinates are integers with sides of at most 2**19, a cross product fits 64
bits and the in-circle determinant is formed in two 64-bit words.

Ties (four points on a circle) are broken without regard to any order of work: the diagonal that
touches the quad's last vertex in raster order wins. This is the triangulation that results when
every point's height on the paraboloid is lowered by an infinitesimal that grows with its raster
order, so it is unique.

References
----------
D. A. Sinclair, "S-hull: a fast radial sweep-hull routine for Delaunay triangulation",
arXiv:1604.01428, 2016. C. L. Lawson, "Software for C1 surface interpolation", 1977. O. Devillers,
"On deletion in Delaunay triangulations", 1999.
"""

from __future__ import annotations

import numpy as np

from vmesh.arrays import BoolArray, Int32Array, Int64Array
from vmesh.errors import LimitError
from vmesh.kernels.jit import inner_kernel, kernel, lean_kernel

SHORT = 1 << 30  # squares of sides below this are short

FLIPS_PER_POINT = 64
FLIPS = 1 << 20
"""Flips that any triangulation may take, and those for each of its points."""

COINCIDENT = -1
TOO_MANY_FLIPS = -2


@inner_kernel
def cross(ax: int, ay: int, bx: int, by: int, cx: int, cy: int) -> int:
    """Doubled signed area of a, b, c: positive where they turn from the x axis towards y."""
    return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)


@lean_kernel
def in_circle(ax: int, ay: int, bx: int, by: int, cx: int, cy: int, dx: int, dy: int) -> int:
    """Sign of the in-circle determinant: 1 if d is inside the circle of the positive a, b, c.

    Exact for coordinate differences of at most 2**19. Each product of a squared length s and a
    cross product t is formed as s (t >> 20) and s (t & 0xFFFFF), summed apart.
    """
    ax -= dx
    ay -= dy
    bx -= dx
    by -= dy
    cx -= dx
    cy -= dy
    s0 = ax * ax + ay * ay
    s1 = bx * bx + by * by
    s2 = cx * cx + cy * cy
    t0 = bx * cy - by * cx
    t1 = cx * ay - cy * ax
    t2 = ax * by - ay * bx
    # Cross products are not larger than their sides' squares, so this fits 64 bits.
    if s0 | s1 | s2 < SHORT:
        det = s0 * t0 + s1 * t1 + s2 * t2
        return 1 if det > 0 else -1 if det < 0 else 0
    high = s0 * (t0 >> 20) + s1 * (t1 >> 20) + s2 * (t2 >> 20)
    low = s0 * (t0 & 0xFFFFF) + s1 * (t1 & 0xFFFFF) + s2 * (t2 & 0xFFFFF)
    high += low >> 20
    if high > 0:
        return 1
    if high < 0:
        return -1
    return 1 if (low & 0xFFFFF) > 0 else 0


@inner_kernel
def must_flip(points: Int64Array, a: int, b: int, c: int, d: int) -> bool:
    """Whether the diagonal b-c of the quad with apexes a and d has to become a-d.

    Vertices are numbered in raster order, so the last one is the largest index.
    """
    side = in_circle(
        points[a, 0],
        points[a, 1],
        points[b, 0],
        points[b, 1],
        points[c, 0],
        points[c, 1],
        points[d, 0],
        points[d, 1],
    )
    return side > 0 or (side == 0 and max(a, d) > max(b, c))


@inner_kernel
def link(twin: Int32Array, e: int | np.int64, f: int | np.int64) -> None:
    """Make two half-edges each other's twin; either may be -1."""
    if e >= 0:
        twin[e] = f
    if f >= 0:
        twin[f] = e


@inner_kernel
def flip(origin: Int32Array, twin: Int32Array, e: int | np.int64) -> None:
    """Turn the diagonal of the two triangles at half-edge e.

    Before, e runs from b to c and the triangles are (b, c, a) and (c, b, d); after, e's triangle
    is (d, c, a) with the diagonal as the half-edge from a to d, and the other is (a, b, d).
    """
    f = twin[e]
    e_prev = e + 2 if e % 3 == 0 else e - 1
    f_prev = f + 2 if f % 3 == 0 else f - 1
    a = origin[e_prev]
    d = origin[f_prev]
    outer_e = twin[e_prev]
    outer_f = twin[f_prev]
    origin[e] = d
    origin[f] = a
    link(twin, e, outer_f)
    link(twin, f, outer_e)
    link(twin, e_prev, f_prev)
    # e: d -> c, e_next: c -> a, e_prev: a -> d;  f: a -> b, f_next: b -> d, f_prev: d -> a.


@inner_kernel
def legalize(
    points: Int64Array,
    origin: Int32Array,
    twin: Int32Array,
    hull_edge: Int32Array,
    stack: Int32Array,
    edge: int,
) -> int:
    """Flip until every edge is locally Delaunay again after a point was added; count the flips.

    Parameters
    ----------
    edge : int
        The edge opposite to the new point, in the new triangle.
    hull_edge : ndarray
        Shape (n,), int32: the hull's half-edge that starts at a vertex; flips keep it right.
    stack : ndarray
        Room for as many edges as the triangulation has triangles: those on it face the new point.
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
        a = origin[e + 2 if e % 3 == 0 else e - 1]
        d = origin[f + 2 if f % 3 == 0 else f - 1]
        if must_flip(points, a, origin[e], origin[f], d):
            flip(origin, twin, e)
            n_flips += 1
            if twin[e] < 0:
                hull_edge[d] = e
            if twin[f] < 0:
                hull_edge[a] = f
            stack[size] = e
            stack[size + 1] = f - 2 if f % 3 == 2 else f + 1
            size += 2
    return n_flips


@inner_kernel
def pseudo_angle(dx: float, dy: float, n_keys: int) -> int:
    """Number in 0 .. n_keys - 1 that grows with the direction of (dx, dy) around the circle."""
    length = abs(dx) + abs(dy)
    if length == 0.0:
        return 0
    ratio = dx / length
    turn = (3.0 - ratio) / 4.0 if dy > 0 else (1.0 + ratio) / 4.0
    return int(turn * n_keys) % n_keys


@kernel
def sweep(
    points: Int64Array, order: Int64Array, cx: float, cy: float, triangles: Int32Array
) -> int:
    """Number of canonical Delaunay triangles of points, written to `triangles`.

    Parameters
    ----------
    points : ndarray
        Shape (n, 2), int64, distinct, in raster order, with sides of at most 2**19.
    order : ndarray
        Shape (n,), int64: the points by their distance from a centre.
    cx, cy : float
        The centre.
    triangles : ndarray
        Shape (max(2 n, 1), 3), int32: room for the result, positively oriented.

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
    twin = np.full(origin.shape[0], -1, np.int32)
    stack = np.empty(triangles.shape[0], np.int32)
    hull_edge = np.full(n_points, -1, np.int32)
    hull_next = np.full(n_points, -1, np.int32)  # -1: not on the hull
    hull_prev = np.full(n_points, -1, np.int32)
    n_keys = int(np.ceil(np.sqrt(n_points)))
    hull_hash = np.full(n_keys, -1, np.int32)

    # The first three points that are not on a line. Those passed over lie on the line of the
    # first two, beyond their segment, so they are outside the first triangle as well.
    a, b = order[0], order[1]
    if points[a, 0] == points[b, 0] and points[a, 1] == points[b, 1]:
        return COINCIDENT
    seed = 2
    side = 0
    while seed < n_points:
        c = order[seed]
        side = cross(
            points[a, 0], points[a, 1], points[b, 0], points[b, 1], points[c, 0], points[c, 1]
        )
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
        while cross(points[v, 0], points[v, 1], points[w, 0], points[w, 1], px, py) >= 0:
            v = w
            w = hull_next[v]
            if v == start:
                return COINCIDENT
        # ... or before it, if the hint was in the midst of those it sees.
        if v == start:
            u = hull_prev[v]
            while cross(points[u, 0], points[u, 1], points[v, 0], points[v, 1], px, py) < 0:
                v = u
                u = hull_prev[v]
        # A triangle (u, w, p) for each edge w -> u that it sees.
        w = v
        u = hull_next[w]
        while cross(points[w, 0], points[w, 1], points[u, 0], points[u, 1], px, py) < 0:
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
    origin: Int32Array,
    twin: Int32Array,
    created: Int64Array,
    removed: Int64Array,
) -> int:
    """Flip the edges of a triangulation until it is the canonical Delaunay triangulation.

    An edge that a flip removes never comes back: every flip lowers the surface that the
    triangulation spans over the paraboloid (Lawson). So the flips, read backwards, lead from the
    Delaunay triangulation to this one, and each edge is removed once at most.

    Parameters
    ----------
    points : ndarray
        Shape (n, 2), int64, in raster order.
    origin, twin : ndarray
        Shape (3 m,), int32: half-edges; overwritten.
    created, removed : ndarray
        Room for the flips: the edge that each one made and the one that it took away, the lower
        vertex in the upper 32 bits.

    Returns
    -------
    int
        Number of flips, TOO_MANY_FLIPS if there is no room for them.
    """
    n_edges = origin.shape[0]
    stack = np.empty(n_edges, np.int32)
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
        e_next, e_prev = e - 2 if e % 3 == 2 else e + 1, e + 2 if e % 3 == 0 else e - 1
        f_next, f_prev = f - 2 if f % 3 == 2 else f + 1, f + 2 if f % 3 == 0 else f - 1
        a, b, c, d = origin[e_prev], origin[e], origin[f], origin[f_prev]
        if not must_flip(points, a, b, c, d):
            continue
        if count == created.shape[0]:
            return TOO_MANY_FLIPS
        created[count] = np.int64(min(a, d)) << 32 | max(a, d)
        removed[count] = np.int64(min(b, c)) << 32 | max(b, c)
        count += 1
        flip(origin, twin, e)
        for g in (e, e_next, f, f_next):
            if not waiting[g]:
                stack[size] = g
                size += 1
                waiting[g] = True
    return count


@inner_kernel
def is_within(points: Int64Array, a: int, b: int, c: int, d: int) -> bool:
    """Whether d is inside the circle of the positive triangle a, b, c, by the rule of `must_flip`.

    That is, whether the triangle cannot be one of the canonical triangulation beside d.
    """
    # On the circle, d is across one of the edges, which it is on the outside of: turn it to b-c.
    for _ in range(3):
        bx, by = points[b, 0], points[b, 1]
        if cross(bx, by, points[c, 0], points[c, 1], points[d, 0], points[d, 1]) < 0:
            return must_flip(points, a, b, c, d)
        a, b, c = b, c, a
    return True


@inner_kernel
def collect_ring(
    origin: Int32Array, twin: Int32Array, start: int, star: Int32Array, ring: Int32Array
) -> tuple[int, int]:
    """Neighbours of a vertex, into `ring`, and the half-edges that leave it, into `star`.

    Both are in positive order, and `start` is one of the half-edges. Returns the number of
    neighbours, 0 if there are more triangles than `star` holds, and the number of triangles, which
    is one less on the border.
    """
    first = np.int64(start)
    # On the border, turn back to the first triangle.
    while twin[first] >= 0:
        first = np.int64(twin[first])
        first = first - 2 if first % 3 == 2 else first + 1
        if first == start:
            break
    e = first
    n = 0
    while True:
        if n == star.shape[0]:
            return 0, 0
        star[n] = e
        ring[n] = origin[e - 2 if e % 3 == 2 else e + 1]
        n += 1
        arriving = e + 2 if e % 3 == 0 else e - 1
        e = np.int64(twin[arriving])
        if e < 0:
            ring[n] = origin[arriving]
            return n + 1, n
        if e == first:
            return n, n


@inner_kernel
def remove_vertex(
    points: Int64Array,
    origin: Int32Array,
    twin: Int32Array,
    leaving: Int32Array,
    v: int,
    star: Int32Array,
    ring: Int32Array,
    outer: Int32Array,
) -> None:
    """Take a vertex out and fill the hole that is left with canonical Delaunay triangles.

    Clips one ear after the other whose circle holds no other vertex of the rim: it is a triangle of
    the result (Devillers). `star`, `ring` and `outer` are room to work in.
    """
    size, n_triangles = collect_ring(origin, twin, leaving[v], star, ring)
    # The half-edge across each side of the rim; on the border the last side has none.
    outer[size - 1] = -1
    for k in range(n_triangles):
        e = star[k]
        outer[k] = twin[e - 2 if e % 3 == 2 else e + 1]
    for n_left in range(size, 2, -1):
        for i in range(n_left):
            before, after = (i if i > 0 else n_left) - 1, i + 1 if i + 1 < n_left else 0
            a, b, c = ring[before], ring[i], ring[after]
            bx, by = points[b, 0], points[b, 1]
            if cross(points[a, 0], points[a, 1], bx, by, points[c, 0], points[c, 1]) <= 0:
                continue
            is_ear = True
            for k in range(n_left):
                if k not in (before, i, after) and is_within(points, b, c, a, ring[k]):
                    is_ear = False
                    break
            if is_ear:
                break
        t = 3 * (star[size - n_left] // 3)
        origin[t], origin[t + 1], origin[t + 2] = a, b, c
        leaving[a], leaving[b], leaving[c] = t, t + 1, t + 2
        twin[t], twin[t + 1] = -1, -1
        link(twin, t, outer[before])
        link(twin, t + 1, outer[i])
        if n_left == 3:
            twin[t + 2] = -1
            link(twin, t + 2, outer[after])
        # The new side takes the place of the two that are covered.
        outer[before] = t + 2
        for k in range(i, n_left - 1):
            ring[k] = ring[k + 1]
            outer[k] = outer[k + 1]
    for k in range(size - 2, n_triangles):
        t = 3 * (star[k] // 3)
        origin[t] = origin[t + 1] = origin[t + 2] = -1


@kernel
def peel(
    points: Int64Array, origin: Int32Array, twin: Int32Array, kept: BoolArray, max_triangles: int
) -> tuple[Int32Array, Int32Array, Int64Array, Int64Array]:
    """Take independent vertices out of a triangulation, layer after layer, until none is left.

    In each layer, in raster order, every vertex is taken that has no more than `max_triangles`
    triangles and of whose neighbours none has been taken. What is left is the canonical Delaunay
    triangulation of the vertices left.

    Parameters
    ----------
    points : ndarray
        Shape (n, 2), int64, in raster order.
    origin, twin : ndarray
        Shape (3 m,), int32: half-edges of the canonical Delaunay triangles; overwritten.
    kept : ndarray
        Shape (n,), bool: vertices that are not taken. Those that are left at the end must be the
        corners of a rectangle that holds all others.

    Returns
    -------
    taken : ndarray
        Shape (k,), int32: layer after layer, each in raster order.
    neighbours : ndarray
        Shape (k, max_triangles + 1), int32: those of each when its layer was taken.
    counts : ndarray
        Shape (k,), int64: how many neighbours each has.
    ends : ndarray
        Where the layers end among those taken, int64.
    """
    n_points = points.shape[0]
    leaving = np.full(n_points, -1, np.int32)
    for e in range(origin.shape[0]):
        leaving[origin[e]] = e
    left = np.arange(n_points).astype(np.int32)
    taken = np.empty(n_points, np.int32)
    neighbours = np.empty((n_points, max_triangles + 1), np.int32)
    counts = np.zeros(n_points, np.int64)
    ends = np.empty(n_points, np.int64)
    is_taken = np.zeros(n_points, np.bool_)
    beside = np.full(n_points, -1, np.int32)  # the last layer that took a neighbour
    star = np.empty(max_triangles, np.int32)
    ring, outer = np.empty(max_triangles + 1, np.int32), np.empty(max_triangles + 1, np.int32)
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
            remove_vertex(points, origin, twin, leaving, taken[i], star, ring, outer)
        left = left[~is_taken[left]]
        ends[n_layers] = n_taken
        n_layers += 1
    n_layers -= 1  # Nothing was taken in the last one.
    return taken[:n_taken], neighbours[:n_taken], counts[:n_taken], ends[:n_layers]


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
        each: photographs take about four, a hostile file could ask for a number that is squared.
    """
    points = vertices.astype(np.int64)
    room = np.empty((max(2 * len(points), 1), 3), dtype=np.int32)
    if len(points) < 3:
        return room[:0]
    doubled_center = points.min(axis=0) + points.max(axis=0)
    offsets = 2 * points - doubled_center
    order = np.argsort((offsets * offsets).sum(axis=1))
    cx, cy = (doubled_center / 2).tolist()
    count = sweep(points, order, cx, cy, room)
    if count == COINCIDENT:
        raise ValueError("two vertices share a position")
    if count == TOO_MANY_FLIPS:
        raise LimitError(f"the triangulation of {len(points)} vertices takes too many edge flips")
    return sort_triangles(room[:count], len(points))
