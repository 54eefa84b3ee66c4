"""Greedy thinning of a Delaunay triangulation: the least useful vertex goes first.

The usefulness of a vertex is the squared error that its removal would add. Its triangles are taken
out, the hole is filled by clipping Delaunay ears, and the error of the new triangles less that of
the old ones is the cost. A heap yields the cheapest vertex; when it has gone, the costs of its
neighbours are computed anew::

        b---c                 b---c         ring     the neighbours of v in positive order
       /|  /|\\               /|\\   \\        outer    for each side of the ring the half-edge
      / | / | d             / | \\   d                  on its far side, -1 on the border
     a--v---+/      ->     a--|--\\ /        error[t] squared error of triangle t over the
      \\ |  /               \\ |  /                    pixels whose centres it holds
       \\| /                  \\|/
        e                     e

Half-edges are those of ``delaunay``: triangle t has 3t, 3t+1, 3t+2. Vertices on the border go only
along a straight side; corners stay. All coordinates are in half pixels, so that pixel (x, y) has
its centre at (2x + 1, 2y + 1).

References
----------
L. Demaret, N. Dyn, A. Iske, "Image compression by linear splines over adaptive triangulations",
Signal Processing 86(7), 2006: adaptive thinning. O. Devillers, "On deletion in Delaunay
triangulations", 1999: filling a hole by ears.
"""

from __future__ import annotations

import numpy as np

from vmesh.arrays import BoolArray, Float64Array, Int32Array, Int64Array, UInt8Array
from vmesh.kernels.jit import kernel

MAX_RING = 48
"""A vertex with more neighbours than this is kept."""


@kernel
def cross(points: Int64Array, a: int, b: int, c: int) -> np.int64:
    """Doubled signed area of three points."""
    bx, by = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1]
    cx, cy = points[c, 0] - points[a, 0], points[c, 1] - points[a, 1]
    area: np.int64 = bx * cy - by * cx
    return area


@kernel
def inside_circle(points: Int64Array, a: int, b: int, c: int, d: int) -> bool:
    """Whether d is inside the circle through the positive triangle a, b, c.

    In floating point: exact for differences below 5,000, and an error on a larger hole only
    costs a little quality, since the result is triangulated anew in the end.
    """
    ax = float(points[a, 0] - points[d, 0])
    ay = float(points[a, 1] - points[d, 1])
    bx = float(points[b, 0] - points[d, 0])
    by = float(points[b, 1] - points[d, 1])
    cx = float(points[c, 0] - points[d, 0])
    cy = float(points[c, 1] - points[d, 1])
    return (
        (ax * ax + ay * ay) * (bx * cy - by * cx)
        + (bx * bx + by * by) * (cx * ay - cy * ax)
        + (cx * cx + cy * cy) * (ax * by - ay * bx)
    ) > 0.0


@kernel
def triangle_error(
    points: Int64Array, colors: Float64Array, image: UInt8Array, a: int, b: int, c: int
) -> float:
    """Squared error of a positive triangle over the pixels whose centres it holds."""
    height, width, n_components = image.shape
    ax, ay = points[a, 0], points[a, 1]
    bx, by = points[b, 0] - ax, points[b, 1] - ay
    cx, cy = points[c, 0] - ax, points[c, 1] - ay
    det = bx * cy - cx * by
    if det <= 0:
        return 0.0
    # A centre on an edge counts here if the triangle is to the right of the edge or below it.
    on_ab = 0 if by < 0 or (by == 0 and bx > 0) else 1
    on_bc = 0 if cy < by or (cy == by and cx > bx) else 1
    on_ca = 0 if cy > 0 or (cy == 0 and cx < 0) else 1
    first_row = max((ay + min(0, by, cy)) >> 1, 0)
    last_row = min((ay + max(0, by, cy)) >> 1, height - 1)
    first_column = max((ax + min(0, bx, cx)) >> 1, 0)
    last_column = min((ax + max(0, bx, cx)) >> 1, width - 1)
    inverse = 1.0 / float(det)
    error = 0.0
    for y in range(first_row, last_row + 1):
        dy = 2 * y + 1 - ay
        dx = 2 * first_column + 1 - ax
        weight_b = dx * cy - dy * cx
        weight_c = dy * bx - dx * by
        weight_a = det - weight_b - weight_c
        for x in range(first_column, last_column + 1):
            if weight_a >= on_bc and weight_b >= on_ca and weight_c >= on_ab:
                wa, wb, wc = weight_a * inverse, weight_b * inverse, weight_c * inverse
                for z in range(n_components):
                    value = wa * colors[a, z] + wb * colors[b, z] + wc * colors[c, z]
                    difference = value - float(image[y, x, z])
                    error += difference * difference
            weight_b += 2 * cy
            weight_c -= 2 * by
            weight_a += 2 * (by - cy)
    return error


@kernel
def find_twins(triangles: Int32Array, n_points: int) -> Int32Array:
    """Half-edge across each half-edge, shape (3 m,), int32; -1 on the border.

    `triangles` has shape (m, 3), int32, and no two of them on the same side of an edge.
    """
    origin = triangles.reshape(-1)
    starts = np.zeros(n_points + 1, np.int64)
    for e in range(origin.shape[0]):
        starts[origin[e] + 1] += 1
    for v in range(n_points):
        starts[v + 1] += starts[v]
    filled = starts.copy()
    leaving = np.empty(origin.shape[0], np.int32)
    for e in range(origin.shape[0]):
        leaving[filled[origin[e]]] = e
        filled[origin[e]] += 1
    twin = np.full(origin.shape[0], -1, np.int32)
    for e in range(origin.shape[0]):
        target = origin[e - 2 if e % 3 == 2 else e + 1]
        for i in range(starts[target], starts[target + 1]):
            f = leaving[i]
            if origin[f - 2 if f % 3 == 2 else f + 1] == origin[e]:
                twin[e] = f
    return twin


@kernel
def collect_ring(
    origin: Int32Array,
    twin: Int32Array,
    edge: int,
    ring: Int32Array,
    outer: Int32Array,
    star: Int32Array,
) -> tuple[int, bool]:
    """Neighbours, far half-edges and triangles around the vertex that half-edge `edge` leaves.

    Returns the number of neighbours, 0 if there are more than MAX_RING, and whether the vertex
    is on the border; then `outer` ends with -1 for the side along the border.
    """
    start = edge
    # On the border, turn back to the first triangle.
    while twin[start] >= 0:
        f = twin[start]
        start = f - 2 if f % 3 == 2 else f + 1
        if start == edge:
            break
    on_border = twin[start] < 0
    e = start
    n_star = 0
    while True:
        e_next = e - 2 if e % 3 == 2 else e + 1
        e_prev = e + 2 if e % 3 == 0 else e - 1
        if n_star == MAX_RING - 1:
            return 0, on_border
        ring[n_star] = origin[e_next]
        outer[n_star] = twin[e_next]
        star[n_star] = e // 3
        n_star += 1
        e = twin[e_prev]
        if e < 0:
            ring[n_star] = origin[e_prev]
            outer[n_star] = -1
            return n_star + 1, True
        if e == start:
            return n_star, False


@kernel
def fill_hole(
    points: Int64Array, ring: Int32Array, size: int, left: Int32Array, ears: Int32Array
) -> int:
    """Triangulate a ring by clipping Delaunay ears; the number of triangles, -1 if it fails.

    Each ear is three places in the ring, in `ears` of shape (MAX_RING, 3): the clipped one is in
    the middle. `left` is room for the places that are not clipped yet.
    """
    for i in range(size):
        left[i] = i
    n = size
    count = 0
    while n >= 3:
        clipped = -1
        for i in range(n):
            a, b, c = left[i - 1 if i > 0 else n - 1], left[i], left[i + 1 if i + 1 < n else 0]
            if cross(points, ring[a], ring[b], ring[c]) <= 0:
                continue
            clipped = i
            for k in range(n):
                d = left[k]
                if d not in (a, b, c) and inside_circle(points, ring[a], ring[b], ring[c], ring[d]):
                    clipped = -1
                    break
            if clipped >= 0:
                ears[count, 0], ears[count, 1], ears[count, 2] = a, b, c
                break
        if clipped < 0:
            return -1
        count += 1
        n -= 1
        for i in range(clipped, n):
            left[i] = left[i + 1]
        if n == 2:
            break
    return count


@kernel
def removal_cost(
    points: Int64Array,
    colors: Float64Array,
    image: UInt8Array,
    origin: Int32Array,
    twin: Int32Array,
    errors: Float64Array,
    edge: int,
    ring: Int32Array,
    outer: Int32Array,
    star: Int32Array,
    left: Int32Array,
    ears: Int32Array,
) -> float:
    """Squared error that the removal of the vertex that `edge` leaves would add.

    Infinite for a corner of the canvas and where the hole cannot be filled.
    """
    size, on_border = collect_ring(origin, twin, edge, ring, outer, star)
    if size < 3:
        return np.inf
    if on_border and cross(points, ring[size - 1], origin[edge], ring[0]) != 0:
        return np.inf
    count = fill_hole(points, ring, size, left, ears)
    if count < 0:
        return np.inf
    cost = 0.0
    for i in range(count):
        a, b, c = ring[ears[i, 0]], ring[ears[i, 1]], ring[ears[i, 2]]
        cost += triangle_error(points, colors, image, a, b, c)
    for i in range(size - 1 if on_border else size):
        cost -= errors[star[i]]
    return cost


@kernel
def sift(heap: Int32Array, place: Int32Array, costs: Float64Array, size: int, at: int) -> None:
    """Move the entry at a place of the heap up or down to where its cost belongs."""
    v = heap[at]
    while at > 0 and costs[v] < costs[heap[(at - 1) >> 1]]:
        parent = (at - 1) >> 1
        heap[at] = heap[parent]
        place[heap[at]] = at
        at = parent
    while True:
        child = 2 * at + 1
        if child >= size:
            break
        if child + 1 < size and costs[heap[child + 1]] < costs[heap[child]]:
            child += 1
        if costs[heap[child]] >= costs[v]:
            break
        heap[at] = heap[child]
        place[heap[at]] = at
        at = child
    heap[at] = v
    place[v] = at


@kernel
def refill(
    points: Int64Array,
    colors: Float64Array,
    image: UInt8Array,
    origin: Int32Array,
    twin: Int32Array,
    errors: Float64Array,
    vertex_edge: Int32Array,
    ring: Int32Array,
    outer: Int32Array,
    star: Int32Array,
    size: int,
    ears: Int32Array,
    count: int,
) -> None:
    """Put the ears of a hole into the slots of the star's triangles and link them."""
    # far[i] is the half-edge across the side from place i of the ring to the next one left.
    far = outer[:size].copy()
    for i in range(count):
        t = star[i]
        for corner in range(3):
            origin[3 * t + corner] = ring[ears[i, corner]]
            vertex_edge[ring[ears[i, corner]]] = 3 * t + corner
        sides = (far[ears[i, 0]], far[ears[i, 1]])
        for corner in range(2):
            twin[3 * t + corner] = sides[corner]
            if sides[corner] >= 0:
                twin[sides[corner]] = 3 * t + corner
        last = far[ears[i, 2]] if i == count - 1 else -1
        twin[3 * t + 2] = last
        if last >= 0:
            twin[last] = 3 * t + 2
        far[ears[i, 0]] = 3 * t + 2
        errors[t] = triangle_error(
            points, colors, image, origin[3 * t], origin[3 * t + 1], origin[3 * t + 2]
        )


@kernel
def thin(
    points: Int64Array,
    origin: Int32Array,
    twin: Int32Array,
    colors: Float64Array,
    image: UInt8Array,
    n_keep: int,
) -> BoolArray:
    """Which vertices stay when the cheapest are removed one by one until `n_keep` are left.

    Parameters
    ----------
    points : ndarray
        Shape (n, 2), int64, in half pixels.
    origin, twin : ndarray
        Shape (3 m,), int32: half-edges of the Delaunay triangles, which cover the picture.
        Overwritten.
    colors : ndarray
        Shape (n, c), float64: vertex colours.
    image : ndarray
        Shape (h, w, c), uint8.
    n_keep : int
        Number of vertices to stop at; more stay if no other can be removed.

    Returns
    -------
    ndarray
        Shape (n,), bool.
    """
    n_points = points.shape[0]
    n_triangles = origin.shape[0] // 3
    errors = np.empty(n_triangles)
    vertex_edge = np.full(n_points, -1, np.int32)
    for t in range(n_triangles):
        a, b, c = origin[3 * t], origin[3 * t + 1], origin[3 * t + 2]
        errors[t] = triangle_error(points, colors, image, a, b, c)
        vertex_edge[a], vertex_edge[b], vertex_edge[c] = 3 * t, 3 * t + 1, 3 * t + 2

    ring = np.empty(MAX_RING, np.int32)
    outer = np.empty(MAX_RING, np.int32)
    star = np.empty(MAX_RING, np.int32)
    places = np.empty(MAX_RING, np.int32)
    ears = np.empty((MAX_RING, 3), np.int32)
    neighbours = np.empty(MAX_RING, np.int32)
    costs = np.empty(n_points)
    heap = np.arange(n_points).astype(np.int32)
    place = np.arange(n_points).astype(np.int32)
    for v in range(n_points):
        costs[v] = removal_cost(
            points,
            colors,
            image,
            origin,
            twin,
            errors,
            vertex_edge[v],
            ring,
            outer,
            star,
            places,
            ears,
        )
    for at in range(n_points // 2, -1, -1):
        sift(heap, place, costs, n_points, at)

    alive = np.ones(n_points, np.bool_)
    left = n_points
    while left > n_keep:
        v = heap[0]
        if costs[v] == np.inf:
            break
        size, _ = collect_ring(origin, twin, vertex_edge[v], ring, outer, star)
        count = fill_hole(points, ring, size, places, ears)
        refill(
            points,
            colors,
            image,
            origin,
            twin,
            errors,
            vertex_edge,
            ring,
            outer,
            star,
            size,
            ears,
            count,
        )
        alive[v] = False
        left -= 1
        heap[0] = heap[left]
        place[heap[0]] = 0
        sift(heap, place, costs, left, 0)
        neighbours[:size] = ring[:size]
        for i in range(size):
            u = neighbours[i]
            costs[u] = removal_cost(
                points,
                colors,
                image,
                origin,
                twin,
                errors,
                vertex_edge[u],
                ring,
                outer,
                star,
                places,
                ears,
            )
            sift(heap, place, costs, left, place[u])
    return alive
