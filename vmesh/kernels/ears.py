"""Holes of a triangulation, filled by clipping Delaunay ears.

::

      b---c         the ring a, b, c, d, e, f around a hole; an ear is three places in turn whose
     /     \\        triangle is positive and whose circle holds no other vertex of what is left of
    a       d       the ring: it is a triangle of the result, and its middle leaves the ring
     \\     /
      f---e

References
----------
O. Devillers, "On deletion in Delaunay triangulations", Symposium on Computational Geometry, 1999.
"""

from __future__ import annotations

from vmesh.arrays import Int64Array
from vmesh.kernels.half_edges import link, place_triangle
from vmesh.kernels.jit import inner_kernel
from vmesh.kernels.predicates import in_circle_float, is_within, orient


@inner_kernel
def clip_ears(
    points: Int64Array,
    ring: Int64Array,
    size: int,
    left: Int64Array,
    ears: Int64Array,
    exact: bool,
) -> int:
    """Number of triangles that fill a ring, -1 if none of its places is an ear.

    Parameters
    ----------
    points : ndarray
        Shape (n, 2), int64.
    ring : ndarray
        Indices of points, of which the first `size` count, in positive order.
    left : ndarray
        Workspace of as many places.
    ears : ndarray
        Shape (k, 3), written: three places in the ring for each triangle, the clipped one in the
        middle.
    exact : bool
        Whether circles are those of the canonical triangulation, or found in floating point.
    """
    for i in range(size):
        left[i] = i
    n = size
    count = 0
    while n >= 3:
        clipped = -1
        for i in range(n):
            a, b, c = left[i - 1 if i > 0 else n - 1], left[i], left[i + 1 if i + 1 < n else 0]
            if orient(points, ring[a], ring[b], ring[c]) <= 0:
                continue
            clipped = i
            for k in range(n):
                d = left[k]
                if d in (a, b, c):
                    continue
                if exact:
                    is_inside = is_within(points, ring[a], ring[b], ring[c], ring[d])
                else:
                    is_inside = in_circle_float(points, ring[a], ring[b], ring[c], ring[d])
                if is_inside:
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
    return count


@inner_kernel
def fill_star(
    origin: Int64Array,
    twin: Int64Array,
    leaving: Int64Array,
    star: Int64Array,
    ring: Int64Array,
    outer: Int64Array,
    ears: Int64Array,
    count: int,
) -> None:
    """Put the triangles of some ears in place of the first triangles of a star.

    Parameters
    ----------
    origin, twin, leaving : ndarray
        Half-edges, and one that leaves each vertex.
    star : ndarray
        A half-edge of each triangle of the star.
    ring : ndarray
        The vertices around the hole.
    outer : ndarray
        For each place of the ring the half-edge across the side from there to the next place that
        is left, -1 on the border; overwritten.
    ears : ndarray
        Shape (k, 3): as :func:`clip_ears` gives them.
    count : int
        Number of ears.
    """
    for i in range(count):
        t, a, b, c = star[i] // 3, ears[i, 0], ears[i, 1], ears[i, 2]
        place_triangle(origin, leaving, t, ring[a], ring[b], ring[c])
        link(twin, 3 * t, outer[a])
        link(twin, 3 * t + 1, outer[b])
        link(twin, 3 * t + 2, outer[c] if i == count - 1 else -1)
        # The new side takes the place of the two that are covered.
        outer[a] = 3 * t + 2
