"""Edits of a triangle mesh that bring it closer to a picture: remove, insert, move, flip.

A :class:`Surface` is a triangulation of the picture's canvas with a colour at each vertex. Each of
its triangles keeps the squared error that it leaves over the pixels whose centres it holds, each
counted as much as its weight says, so that what an edit gains or costs is known from the triangles
it touches::

    remove            insert            move              flip

      b---c             a---b             a---b             a---b
     /|  /|\\            |   /             |\\ /|             |  /|        ring    neighbours of v
    a-v-- | d           | v               | v |             | / |                in positive order
     \\|  \\|/            |/                |/ \\|             |/  |        outer   far half-edge of
      f---e             c                 c---d             c---d                each of its sides

Half-edges are those of ``half_edges``. Triangles and vertices that are not in use have ``origin``
and ``leaving`` -1. Coordinates are in half pixels: pixel (x, y) has its centre at (2x + 1, 2y + 1).

References
----------
L. Demaret, N. Dyn, A. Iske, "Image compression by linear splines over adaptive triangulations",
Signal Processing 86(7), 2006: removal by least error. M. Garland, P. S. Heckbert, "Fast polygonal
approximation of terrains and height fields", CMU-CS-95-181, 1995: insertion at the largest error.
G. H. Golub, V. Pereyra, "The differentiation of pseudo-inverses and nonlinear least squares
problems whose variables separate", SIAM Journal on Numerical Analysis 10(2), 1973: moves, with the
best colour for each place. N. Dyn, D. Levin, S. Rippa, "Data dependent triangulations for piecewise
linear interpolation", IMA Journal of Numerical Analysis 10(1), 1990: flips. O. Devillers, "On
deletion in Delaunay triangulations", Symposium on Computational Geometry, 1999: filling a hole by
ears.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from vmesh.arrays import BoolArray, Float64Array, Int64Array, SampleArray
from vmesh.kernels import half_edges
from vmesh.kernels.ears import clip_ears, fill_star
from vmesh.kernels.half_edges import link, next_edge, place_triangle, previous_edge
from vmesh.kernels.jit import inner_kernel, kernel
from vmesh.kernels.predicates import in_circle_float, orient

MAX_RING = 48
"""A vertex with more neighbours than this is left as it is."""

REACH = 3
"""A vertex steps at most this many pixels in each direction."""
N_TRIES = 3
"""Places that a vertex tries at each step: those with the largest predicted decrease."""
MAX_STEPS = 8
"""A vertex steps on from a better place at most this many times."""
RIDGE = 1e-2
"""Holds the colour of a vertex whose triangles cover next to no pixel's centre, in pixels."""
LEAST_GAIN = 1e-3
"""An edit has to gain at least this much squared error."""

# Columns of a row are found in floating point. They are fractions with denominators of at most
# 2**18, so this bias decides on which side of an edge a pixel's centre lies without error.
_BIAS = 1e-7
# A literal would be a type of its own, for which a kernel is compiled once more.
_N_SIDES: Any = np.int64(3)
_ROOT: Any = np.int64(0)


class WeightedImage(NamedTuple):
    """A picture, and what its pixels count.

    Attributes
    ----------
    samples : ndarray
        Shape (h, w, c), uint8 or uint16.
    weights : ndarray
        Shape (h, w), float64: what a squared error in each pixel counts.
    """

    samples: SampleArray
    weights: Float64Array


class Surface(NamedTuple):
    """A triangulation with colours, edited in place.

    Attributes
    ----------
    points : ndarray
        Shape (n, 2), int64, in half pixels.
    colors : ndarray
        Shape (n, c), float64.
    origin, twin : ndarray
        Shape (3 m,), int64.
    leaving : ndarray
        Shape (n,), int64: a half-edge that leaves each vertex.
    errors : ndarray
        Shape (m,), float64: squared error of each triangle.
    dirty : ndarray
        Shape (n,), bool: whether something near the vertex changed since it was last looked at.
    """

    points: Int64Array
    colors: Float64Array
    origin: Int64Array
    twin: Int64Array
    leaving: Int64Array
    errors: Float64Array
    dirty: BoolArray


class Workspace(NamedTuple):
    """Scratch arrays of the kernels: the star of a vertex, the filling of its hole, and sums."""

    ring: Int64Array
    outer: Int64Array
    star: Int64Array
    places: Int64Array
    ears: Int64Array
    rows: Int64Array
    sums: Float64Array
    side_sums: Float64Array
    predictions: Float64Array


def make_workspace(height: int, n_components: int) -> Workspace:
    """Workspace for a picture of this height."""
    return Workspace(
        ring=np.zeros(MAX_RING, np.int64),
        outer=np.zeros(MAX_RING, np.int64),
        star=np.zeros(MAX_RING - 2, np.int64),
        places=np.zeros(MAX_RING, np.int64),
        ears=np.zeros((MAX_RING, 3), np.int64),
        rows=np.zeros((height, 2), np.int64),
        sums=np.zeros(2 + n_components),
        side_sums=np.zeros((MAX_RING, 2 + n_components)),
        predictions=np.zeros((2 * REACH + 1, 2 * REACH + 1)),
    )


# --- Sums over the pixels of a triangle -----------------------------------------------------------


@inner_kernel
def follow(
    x0: int,
    y0: int,
    x1: int,
    y1: int,
    first: int,
    last: int,
    side: int,
    width: int,
    rows: Int64Array,
) -> None:
    """Write the column at which each of some rows meets an edge, from its upper end (x0, y0)."""
    if first >= last:
        return
    slope = (x1 - x0) / (y1 - y0)
    # Half the horizontal position less a half is a column.
    column = 0.5 * (x0 + slope * (2 * first + 1 - y0)) - 0.5 - _BIAS
    for y in range(first, last):
        rows[y, side] = min(max(math.ceil(column), 0), width)
        column += slope


@inner_kernel
def spans(
    x0: int, y0: int, x1: int, y1: int, x2: int, y2: int, width: int, rows: Int64Array
) -> tuple[int, int]:
    """First row of a positive triangle and the row after its last; each row's columns in `rows`.

    A centre on an edge counts if the triangle is to the right of the edge or below it.
    """
    if y1 < y0:
        x0, y0, x1, y1 = x1, y1, x0, y0
    if y2 < y1:
        x1, y1, x2, y2 = x2, y2, x1, y1
        if y1 < y0:
            x0, y0, x1, y1 = x1, y1, x0, y0
    first = y0 >> 1
    last = y2 >> 1
    if first >= last:
        return 0, 0
    middle = min(max(y1 >> 1, first), last)
    long_side = 0 if (x1 - x0) * (y2 - y0) > (y1 - y0) * (x2 - x0) else 1
    follow(x0, y0, x2, y2, first, last, long_side, width, rows)
    follow(x0, y0, x1, y1, first, middle, 1 - long_side, width, rows)
    follow(x1, y1, x2, y2, middle, last, 1 - long_side, width, rows)
    return first, last


@inner_kernel
def triangle_error(
    surface: Surface, image: WeightedImage, work: Workspace, a: int, b: int, c: int
) -> float:
    """Squared error of a positive triangle over the pixels whose centres it holds."""
    points, colors, rows = surface.points, surface.colors, work.rows
    ax, ay = points[a, 0], points[a, 1]
    bx, by = points[b, 0] - ax, points[b, 1] - ay
    cx, cy = points[c, 0] - ax, points[c, 1] - ay
    det = bx * cy - cx * by
    if det <= 0:
        return 0.0
    first, last = spans(ax, ay, ax + bx, ay + by, ax + cx, ay + cy, image.samples.shape[1], rows)
    inverse = 1.0 / float(det)
    error = 0.0
    for z in range(image.samples.shape[2]):
        c0, c1, c2 = colors[a, z], colors[b, z] - colors[a, z], colors[c, z] - colors[a, z]
        right = (c1 * cy - c2 * by) * inverse
        down = (c2 * bx - c1 * cx) * inverse
        for y in range(first, last):
            start = rows[y, 0]
            value = c0 + right * (2 * start + 1 - ax) + down * (2 * y + 1 - ay)
            for x in range(start, rows[y, 1]):
                difference = value - float(image.samples[y, x, z])
                error += image.weights[y, x] * difference * difference
                value += 2.0 * right
    return error


@inner_kernel
def add_moments(
    surface: Surface, image: WeightedImage, work: Workspace, x: int, y: int, a: int, b: int
) -> None:
    """Add to ``work.sums`` what the best colour of a vertex at (x, y) follows from.

    In the triangle (x, y), a, b let w be the weight of the vertex at a pixel and r the pixel less
    what a and b contribute: adds the sums of r r (over all components), of w w, and of w r for
    each component, all counted as much as the pixel. With colour k the squared error is
    rr - 2 k wr + k k ww; the best is wr / ww.
    """
    points, colors, rows, sums = surface.points, surface.colors, work.rows, work.sums
    ax, ay = points[a, 0] - x, points[a, 1] - y
    bx, by = points[b, 0] - x, points[b, 1] - y
    det = ax * by - ay * bx
    first, last = spans(x, y, x + ax, y + ay, x + bx, y + by, image.samples.shape[1], rows)
    inverse = 1.0 / float(det)
    # The weight of the vertex, and what a and b contribute, change by these with a half pixel.
    fall_right, fall_down = (ay - by) * inverse, (bx - ax) * inverse
    for z in range(image.samples.shape[2]):
        ca, cb = colors[a, z], colors[b, z]
        right = (ca * by - cb * ay) * inverse
        down = (cb * ax - ca * bx) * inverse
        squares, products, weights = 0.0, 0.0, 0.0
        for row in range(first, last):
            start = rows[row, 0]
            dx, dy = 2 * start + 1 - x, 2 * row + 1 - y
            weight = 1.0 + fall_right * dx + fall_down * dy
            value = right * dx + down * dy
            for column in range(start, rows[row, 1]):
                rest = image.samples[row, column, z] - value
                counted = image.weights[row, column] * rest
                squares += counted * rest
                products += weight * counted
                weights += image.weights[row, column] * weight * weight
                value += 2.0 * right
                weight += 2.0 * fall_right
        sums[0] += squares
        sums[2 + z] += products
        if z == 0:
            sums[1] += weights


@inner_kernel
def error_at(
    surface: Surface,
    image: WeightedImage,
    work: Workspace,
    x: int,
    y: int,
    n_sides: int,
    limit: float,
) -> float:
    """Squared error of a star with its centre at (x, y), in the best colour for it.

    The star's rim is ``work.ring``, of which the first `n_sides` sides count; infinite if one of
    its triangles were not positive, or as soon as the error is more than `limit`. ``work.sums``
    holds the sums that the colour follows from, ``work.side_sums`` their running totals by side.
    """
    points, ring, sums = surface.points, work.ring, work.sums
    for i in range(n_sides):
        a, b = ring[i], ring[i + 1]
        ax, ay = points[a, 0] - x, points[a, 1] - y
        if ax * (points[b, 1] - y) - ay * (points[b, 0] - x) <= 0:
            return np.inf
    for i in range(sums.shape[0]):
        sums[i] = 0.0
    error = 0.0
    for i in range(n_sides):
        add_moments(surface, image, work, x, y, ring[i], ring[i + 1])
        for z in range(sums.shape[0]):
            work.side_sums[i, z] = sums[z]
        # The least error of some triangles is no more than that of all.
        error = sums[0]
        for z in range(image.samples.shape[2]):
            error -= sums[2 + z] * sums[2 + z] / (sums[1] + RIDGE)
        if error > limit:
            return np.inf
    return error


@inner_kernel
def take_color(surface: Surface, work: Workspace, v: int) -> None:
    """Give vertex v the best colour by ``work.sums``, if its triangles hold any pixel."""
    if work.sums[1] > RIDGE:
        for z in range(surface.colors.shape[1]):
            surface.colors[v, z] = work.sums[2 + z] / (work.sums[1] + RIDGE)


@kernel
def measure(surface: Surface, image: WeightedImage, work: Workspace, first: int, last: int) -> None:
    """Recompute the errors of the triangles from `first` up to `last`, which is excluded."""
    for t in range(first, last):
        a, b, c = surface.origin[3 * t], surface.origin[3 * t + 1], surface.origin[3 * t + 2]
        surface.errors[t] = triangle_error(surface, image, work, a, b, c) if a >= 0 else 0.0


# --- Half-edges -----------------------------------------------------------------------------------


@inner_kernel
def set_triangle(
    surface: Surface, image: WeightedImage, work: Workspace, t: int, a: int, b: int, c: int
) -> None:
    """Make t the triangle a, b, c."""
    place_triangle(surface.origin, surface.leaving, t, a, b, c)
    update_triangle(surface, image, work, t, a, b, c)


@inner_kernel
def update_triangle(
    surface: Surface, image: WeightedImage, work: Workspace, t: int, a: int, b: int, c: int
) -> None:
    """Measure triangle t, which became a, b, c, and mark its corners as dirty."""
    surface.dirty[a] = surface.dirty[b] = surface.dirty[c] = True
    surface.errors[t] = triangle_error(surface, image, work, a, b, c)


@inner_kernel
def free_triangle(surface: Surface, t: int) -> None:
    """Take triangle t out of use."""
    for e in range(3 * t, 3 * t + 3):
        surface.origin[e] = -1
        surface.twin[e] = -1
    surface.errors[t] = 0.0


@inner_kernel
def collect_ring(surface: Surface, work: Workspace, v: int) -> tuple[int, int]:
    """Neighbours, far half-edges and star of a vertex, into `work`.

    Returns the number of neighbours, 0 if they are too many, and the number of triangles, which is
    one less on the border. Inside, the first neighbour is repeated after the last.
    """
    origin, twin, leaving = surface.origin, surface.twin, surface.leaving
    ring, outer, star = work.ring, work.outer, work.star
    size, n_sides = half_edges.collect_ring(origin, twin, leaving[v], star, ring)
    for i in range(n_sides):
        outer[i] = twin[next_edge(star[i])]
    if n_sides < size:
        outer[n_sides] = -1
    else:
        ring[size] = ring[0]
    return size, n_sides


# --- Removing -------------------------------------------------------------------------------------


@inner_kernel
def removal_cost(surface: Surface, image: WeightedImage, work: Workspace, v: int) -> float:
    """Squared error that the removal of a vertex would add.

    It is infinite for a corner of the canvas and where the hole cannot be filled.
    """
    ring, ears = work.ring, work.ears
    size, n_sides = collect_ring(surface, work, v)
    if size < 3:
        return np.inf
    if n_sides < size and orient(surface.points, ring[size - 1], v, ring[0]) != 0:
        return np.inf
    count = clip_ears(surface.points, ring, size, work.places, ears, False)
    if count < 0:
        return np.inf
    cost = 0.0
    for i in range(n_sides):
        cost -= surface.errors[work.star[i] // 3]
    for i in range(count):
        a, b, c = ring[ears[i, 0]], ring[ears[i, 1]], ring[ears[i, 2]]
        cost += triangle_error(surface, image, work, a, b, c)
    return cost


@inner_kernel
def remove(surface: Surface, image: WeightedImage, work: Workspace, v: int) -> int:
    """Remove a vertex and fill the hole; returns the number of its neighbours, in ``work.ring``."""
    points, origin, twin, leaving = surface.points, surface.origin, surface.twin, surface.leaving
    ring, star, ears = work.ring, work.star, work.ears
    size, n_sides = collect_ring(surface, work, v)
    count = clip_ears(points, ring, size, work.places, ears, False)
    leaving[v] = -1
    for i in range(count, n_sides):
        free_triangle(surface, star[i] // 3)
    fill_star(origin, twin, leaving, star, ring, work.outer, ears, count)
    for i in range(count):
        a, b, c = ring[ears[i, 0]], ring[ears[i, 1]], ring[ears[i, 2]]
        update_triangle(surface, image, work, star[i] // 3, a, b, c)
    return size


@inner_kernel
def sift(heap: Int64Array, place: Int64Array, costs: Float64Array, size: int, at: int) -> None:
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
def weigh(
    surface: Surface,
    image: WeightedImage,
    work: Workspace,
    first: int,
    last: int,
    costs: Float64Array,
) -> None:
    """Costs of removing the vertices from `first` up to `last`, which is excluded."""
    for v in range(first, last):
        costs[v] = np.inf
        if surface.leaving[v] >= 0:
            costs[v] = removal_cost(surface, image, work, v)


@kernel
def thin(
    surface: Surface,
    image: WeightedImage,
    work: Workspace,
    costs: Float64Array,
    factors: Float64Array,
    n_remove: int,
    max_cost: float,
) -> int:
    """Remove the vertices that cost least, one by one; returns how many.

    A heap yields the cheapest one. The costs of its neighbours are out of date when it has gone;
    since they hardly ever fall, they are recomputed when they come up as the cheapest.

    Parameters
    ----------
    surface : Surface
        With errors that are up to date.
    image : WeightedImage
    work : Workspace
    costs : ndarray
        Shape (n,), float64: as :func:`weigh` finds them; changed.
    factors : ndarray
        Shape (n,), float64: what the cost of each vertex is multiplied by.
    n_remove : int
        Number to remove at most.
    max_cost : float
        Vertices that cost more than this squared error stay.
    """
    n_points = surface.points.shape[0]
    heap = np.empty(n_points, np.int64)
    place = np.empty(n_points, np.int64)
    outdated = np.zeros(n_points, np.bool_)
    left = 0
    for v in range(n_points):
        if surface.leaving[v] >= 0:
            costs[v] *= factors[v]
            heap[left] = v
            place[v] = left
            left += 1
    for at in range(left):
        sift(heap, place, costs, at + 1, at)
    removed = 0
    while removed < n_remove and left > 0:
        v = heap[0]
        if outdated[v]:
            outdated[v] = False
            costs[v] = factors[v] * removal_cost(surface, image, work, v)
        elif costs[v] == np.inf or costs[v] > max_cost:
            break
        else:
            for i in range(remove(surface, image, work, v)):
                outdated[work.ring[i]] = True
            removed += 1
            left -= 1
            heap[0] = heap[left]
            place[heap[0]] = 0
        sift(heap, place, costs, left, _ROOT)
    return removed


# --- Inserting ------------------------------------------------------------------------------------


@inner_kernel
def worst_pixel(
    surface: Surface, image: WeightedImage, work: Workspace, a: int, b: int, c: int
) -> tuple[int, int]:
    """Centre of the pixel of a triangle with the largest error; its first corner if it has none."""
    points, colors, rows = surface.points, surface.colors, work.rows
    ax, ay = points[a, 0], points[a, 1]
    bx, by = points[b, 0] - ax, points[b, 1] - ay
    cx, cy = points[c, 0] - ax, points[c, 1] - ay
    first, last = spans(ax, ay, ax + bx, ay + by, ax + cx, ay + cy, image.samples.shape[1], rows)
    inverse = 1.0 / float(bx * cy - cx * by)
    worst, worst_x, worst_y = 0.0, ax, ay
    for row in range(first, last):
        for column in range(rows[row, 0], rows[row, 1]):
            dx, dy = 2 * column + 1 - ax, 2 * row + 1 - ay
            weight_b, weight_c = (dx * cy - dy * cx) * inverse, (dy * bx - dx * by) * inverse
            # A vertex has to lie inside.
            if min(weight_b, weight_c, 1.0 - weight_b - weight_c) < 1e-9:
                continue
            error = 0.0
            for z in range(image.samples.shape[2]):
                value = colors[a, z] + weight_b * (colors[b, z] - colors[a, z])
                value += weight_c * (colors[c, z] - colors[a, z])
                error += (value - image.samples[row, column, z]) ** 2
            error *= image.weights[row, column]
            if error >= worst:
                worst, worst_x, worst_y = error, 2 * column + 1, 2 * row + 1
    return worst_x, worst_y


@inner_kernel
def best_insertion(
    surface: Surface, image: WeightedImage, work: Workspace, t: int
) -> tuple[float, int, int]:
    """Gain of a new vertex in triangle t, and its place: the middle or the worst pixel."""
    points, errors, ring = surface.points, surface.errors, work.ring
    for i in range(4):
        ring[i] = surface.origin[3 * t + i % 3]
    best, best_x, best_y = -np.inf, 0, 0
    for i in range(2):
        if i == 0:
            # Sums of half pixels: the pixel's centre that is next to a third of them.
            x = (points[ring[0], 0] + points[ring[1], 0] + points[ring[2], 0]) // 6 * 2 + 1
            y = (points[ring[0], 1] + points[ring[1], 1] + points[ring[2], 1]) // 6 * 2 + 1
        else:
            x, y = worst_pixel(surface, image, work, ring[0], ring[1], ring[2])
        gain = errors[t] - error_at(surface, image, work, x, y, _N_SIDES, errors[t] - best)
        if gain > best:
            best, best_x, best_y = gain, x, y
    return best, best_x, best_y


@inner_kernel
def split(
    surface: Surface,
    image: WeightedImage,
    work: Workspace,
    t: int,
    v: int,
    second: int,
    third: int,
) -> None:
    """Split triangle t at vertex v; `second` and `third` are triangles that are not in use."""
    origin, twin = surface.origin, surface.twin
    a, b, c = origin[3 * t], origin[3 * t + 1], origin[3 * t + 2]
    far_b, far_c = twin[3 * t + 1], twin[3 * t + 2]
    set_triangle(surface, image, work, t, a, b, v)
    set_triangle(surface, image, work, second, b, c, v)
    set_triangle(surface, image, work, third, c, a, v)
    link(twin, 3 * second, far_b)
    link(twin, 3 * third, far_c)
    link(twin, 3 * t + 1, 3 * second + 2)
    link(twin, 3 * second + 1, 3 * third + 2)
    link(twin, 3 * third + 1, 3 * t + 2)


@kernel
def propose_insertions(
    surface: Surface,
    image: WeightedImage,
    work: Workspace,
    first: int,
    last: int,
    gains: Float64Array,
    places: Int64Array,
) -> None:
    """Find the gain and the place of a new vertex in each triangle for which they are not known.

    Parameters
    ----------
    surface : Surface
    image : WeightedImage
    work : Workspace
    first, last : int
        The triangles: `last` is excluded.
    gains : ndarray
        Shape (m,), float64: NaN where it is not known; minus infinity for what is not in use.
    places : ndarray
        Shape (m, 2), int64.
    """
    for t in range(first, last):
        if surface.origin[3 * t] < 0:
            gains[t] = -np.inf
        elif math.isnan(gains[t]):
            gains[t], places[t, 0], places[t, 1] = best_insertion(surface, image, work, t)


@kernel
def insert(
    surface: Surface,
    image: WeightedImage,
    work: Workspace,
    order: Int64Array,
    gains: Float64Array,
    places: Int64Array,
    n_insert: int,
) -> int:
    """Insert vertices into triangles while any are not in use; returns how many were inserted.

    No two go into triangles that share a side: a second call sees what the first one changed.

    Parameters
    ----------
    surface : Surface
    image : WeightedImage
    work : Workspace
    order : ndarray
        Shape (k,), int64: triangles in use, the best first.
    gains : ndarray
        Shape (m,), float64: set to NaN for triangles that change.
    places : ndarray
        Shape (m, 2), int64: where in each triangle.
    n_insert : int
        Number to insert at most.
    """
    n_points, n_triangles = surface.points.shape[0], surface.errors.shape[0]
    changed = np.zeros(n_triangles, np.bool_)
    inserted, v = 0, 0
    free_triangles = np.zeros(2, np.int64)
    free = 0
    for i in range(order.shape[0]):
        t = order[i]
        if changed[t]:
            continue
        while v < n_points and surface.leaving[v] >= 0:
            v += 1
        for k in range(2):
            while free < n_triangles and surface.origin[3 * free] >= 0:
                free += 1
            free_triangles[k] = free
            free += 1
        if inserted == n_insert or v >= n_points or free > n_triangles:
            break
        for e in range(3 * t, 3 * t + 3):
            if surface.twin[e] >= 0:
                changed[surface.twin[e] // 3] = True
        for k in range(4):
            work.ring[k] = surface.origin[3 * t + k % 3]
        surface.points[v, 0], surface.points[v, 1] = places[t, 0], places[t, 1]
        error_at(surface, image, work, places[t, 0], places[t, 1], _N_SIDES, np.inf)
        for z in range(surface.colors.shape[1]):
            surface.colors[v, z] = surface.colors[work.ring[0], z]
        take_color(surface, work, v)
        split(surface, image, work, t, v, free_triangles[0], free_triangles[1])
        gains[t] = gains[free_triangles[0]] = gains[free_triangles[1]] = np.nan
        inserted += 1
    return inserted


# --- Moving and flipping --------------------------------------------------------------------------


@inner_kernel
def may_step(x: int, dx: int, far: int) -> bool:
    """True if a coordinate may change by dx: it must neither leave the border nor reach it."""
    return dx == 0 or (0 < x < far and 0 < x + dx < far)


@inner_kernel
def predict_step(
    surface: Surface, image: WeightedImage, work: Workspace, v: int, n_sides: int
) -> None:
    """Predict the change of the error of vertex v's star for each step, in ``work.predictions``.

    It follows from the sums that :func:`error_at` left for the place where the vertex is. Where its
    triangles have gradients g and a step d moves it with its colour k, a pixel with weight w
    changes by w (k' - g d). In squares, with the best change of the colour k', that is

        2 b d + d H d,   b = sum of g (w r),   H = sum of ww g g - (sum of ww g)^2 / sum of ww,

    the quadratic model of the Gauss-Newton method with the colour eliminated (variable projection).
    It is evaluated for every step and not only minimised: the picture is not as smooth as that.
    """
    points, colors, ring, side_sums = surface.points, surface.colors, work.ring, work.side_sums
    b_x = b_y = h_xx = h_xy = h_yy = 0.0
    for z in range(colors.shape[1]):
        color = colors[v, z]
        mean_x = mean_y = 0.0
        for i in range(n_sides):
            a, b = ring[i], ring[i + 1]
            ax, ay = points[a, 0] - points[v, 0], points[a, 1] - points[v, 1]
            bx, by = points[b, 0] - points[v, 0], points[b, 1] - points[v, 1]
            inverse = 1.0 / float(ax * by - ay * bx)
            right = ((colors[a, z] - color) * by - (colors[b, z] - color) * ay) * inverse
            down = ((colors[b, z] - color) * ax - (colors[a, z] - color) * bx) * inverse
            weights, products = side_sums[i, 1], side_sums[i, 2 + z]
            if i > 0:
                weights -= side_sums[i - 1, 1]
                products -= side_sums[i - 1, 2 + z]
            products -= color * weights
            b_x += products * right
            b_y += products * down
            h_xx += weights * right * right
            h_xy += weights * right * down
            h_yy += weights * down * down
            mean_x += weights * right
            mean_y += weights * down
        share = 1.0 / (side_sums[n_sides - 1, 1] + RIDGE)
        h_xx -= mean_x * mean_x * share
        h_xy -= mean_x * mean_y * share
        h_yy -= mean_y * mean_y * share
    width, height = 2 * image.samples.shape[1], 2 * image.samples.shape[0]
    x, y = points[v, 0], points[v, 1]
    for i in range(work.predictions.shape[0]):
        dy = 2 * (i - REACH)
        for k in range(work.predictions.shape[1]):
            dx = 2 * (k - REACH)
            work.predictions[i, k] = np.inf
            if may_step(x, dx, width) and may_step(y, dy, height):
                change = 2.0 * (b_x * dx + b_y * dy)
                change += h_xx * dx * dx + 2.0 * h_xy * dx * dy + h_yy * dy * dy
                work.predictions[i, k] = change
    work.predictions[REACH, REACH] = np.inf


@inner_kernel
def step(
    surface: Surface, image: WeightedImage, work: Workspace, v: int, n_sides: int, least: float
) -> float:
    """Error after vertex v was moved to a better one of the places that are predicted to be best.

    They are tried by their predicted decrease, and the first that is better is taken. If none is,
    the vertex stays and the error is `least`, as it was.
    """
    points, predictions = surface.points, work.predictions
    predict_step(surface, image, work, v, n_sides)
    for _ in range(N_TRIES):
        i, k = 0, 0
        for row in range(predictions.shape[0]):
            for column in range(predictions.shape[1]):
                if predictions[row, column] < predictions[i, k]:
                    i, k = row, column
        if predictions[i, k] == np.inf:
            break
        predictions[i, k] = np.inf
        x, y = points[v, 0] + 2 * (k - REACH), points[v, 1] + 2 * (i - REACH)
        error = error_at(surface, image, work, x, y, n_sides, least - LEAST_GAIN)
        if error < np.inf:
            points[v, 0], points[v, 1] = x, y
            take_color(surface, work, v)
            return error
    return least


@kernel
def relocate(surface: Surface, image: WeightedImage, work: Workspace, vertices: Int64Array) -> int:
    """Move the dirty ones of some vertices to better places, step by step; returns how many moved.

    The error of a place is that of the star in the best colour for it. Vertices on the border stay
    on their side, corners where they are. Around a vertex only the errors of its triangles and the
    marks of its neighbours are written, so vertices without a common edge can be moved at the same
    time.
    """
    points, leaving, dirty = surface.points, surface.leaving, surface.dirty
    right, bottom = 2 * image.samples.shape[1], 2 * image.samples.shape[0]
    moved = 0
    for v in vertices:
        if leaving[v] < 0 or not dirty[v]:
            continue
        dirty[v] = False
        x, y = points[v, 0], points[v, 1]
        if x in (0, right) and y in (0, bottom):
            continue
        size, n_sides = collect_ring(surface, work, v)
        if size < 3:
            continue
        least = error_at(surface, image, work, x, y, n_sides, np.inf)
        take_color(surface, work, v)
        for _ in range(MAX_STEPS):
            error = step(surface, image, work, v, n_sides, least)
            if error == least:
                break
            least = error
        if x != points[v, 0] or y != points[v, 1]:
            moved += 1
            dirty[v] = True
            for i in range(size):
                dirty[work.ring[i]] = True
        for i in range(n_sides):
            surface.errors[work.star[i] // 3] = triangle_error(
                surface, image, work, v, work.ring[i], work.ring[i + 1]
            )
    return moved


@kernel
def flip_edges(surface: Surface, image: WeightedImage, work: Workspace, charge: float) -> int:
    """Flip each edge at most once, if that lowers the error; returns how many were flipped.

    An edge that is not Delaunay is charged what it costs to code it.
    """
    points, origin, twin, errors = surface.points, surface.origin, surface.twin, surface.errors
    flipped = 0
    for e in range(origin.shape[0]):
        f = twin[e]
        if f < e:
            continue
        #  e runs from b to c in the triangle b, c, a; f back from c to b in c, b, d.
        b, c, a, d = origin[e], origin[f], origin[previous_edge(e)], origin[previous_edge(f)]
        if orient(points, a, d, c) <= 0 or orient(points, d, a, b) <= 0:
            continue
        first = triangle_error(surface, image, work, a, d, c)
        gain = errors[e // 3] + errors[f // 3] - first
        gain += -charge if not in_circle_float(points, b, c, a, d) else charge
        if gain <= LEAST_GAIN:
            continue
        gain -= triangle_error(surface, image, work, d, a, b)
        if gain <= LEAST_GAIN:
            continue
        far_ca, far_ab = twin[next_edge(e)], twin[previous_edge(e)]
        far_bd, far_dc = twin[next_edge(f)], twin[previous_edge(f)]
        t, u = e // 3, f // 3
        set_triangle(surface, image, work, t, a, d, c)
        set_triangle(surface, image, work, u, d, a, b)
        link(twin, 3 * t, 3 * u)
        link(twin, 3 * t + 1, far_dc)
        link(twin, 3 * t + 2, far_ca)
        link(twin, 3 * u + 1, far_ab)
        link(twin, 3 * u + 2, far_bd)
        flipped += 1
    return flipped
