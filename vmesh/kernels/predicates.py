"""Predicates on points of a lattice: on which side of a line, and in or out of a circle.

The exact ones decide what writers and readers have to agree on. The one in floating point stands
beside its exact counterpart: it is faster, and good where an error costs only a little quality.

All take integer coordinates. The exact in-circle test is for sides of at most 2**19: a cross
product then fits 64 bits, and the determinant is formed in two 64-bit words.

References
----------
J. R. Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric predicates",
Discrete & Computational Geometry 18, 1997: the predicates and their names. H. Edelsbrunner, E. P.
Mücke, "Simulation of simplicity", ACM Transactions on Graphics 9(1), 1990: ties broken by symbolic
perturbation.
"""

from __future__ import annotations

from vmesh.arrays import Int64Array
from vmesh.kernels.jit import inner_kernel, lean_kernel

SHORT = 1 << 30  # squares of sides below this are short


@inner_kernel
def orient(points: Int64Array, a: int, b: int, c: int) -> int:
    """Doubled signed area of points a, b, c: positive where they turn from the x axis towards y."""
    bx, by = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1]
    cx, cy = points[c, 0] - points[a, 0], points[c, 1] - points[a, 1]
    area: int = bx * cy - by * cx
    return area


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
def in_circle_float(points: Int64Array, a: int, b: int, c: int, d: int) -> bool:
    """True if point d is inside the circle of the positive triangle a, b, c, but for rounding.

    Exact for coordinate differences below 5,000.
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


@inner_kernel
def must_flip(points: Int64Array, a: int, b: int, c: int, d: int) -> bool:
    """True if the diagonal b-c of the quad with apexes a and d has to become a-d.

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
def is_within(points: Int64Array, a: int, b: int, c: int, d: int) -> bool:
    """True if d is inside the circle of the positive triangle a, b, c, by the rule of `must_flip`.

    The triangle then cannot be one of a canonical triangulation in which d is a vertex.
    """
    # On the circle, d is across one of the edges, which it is on the outside of: turn it to b-c.
    for _ in range(3):
        if orient(points, b, c, d) < 0:
            return must_flip(points, a, b, c, d)
        a, b, c = b, c, a
    return True
