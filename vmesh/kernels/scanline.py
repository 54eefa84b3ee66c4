"""Scanline rasterisation of triangles: filling, and sums over the pixels each one covers.

Vertices are integers in 1/256 pixel; the centre of pixel (x, y) is at (256 x + 128, 256 y + 128).
A pixel belongs to the triangle that holds its centre. A centre on an edge belongs to the triangle
on the edge's right or, where the edge is horizontal, below it (the top-left rule), so that
triangles which share their edges cover every centre exactly once::

            0                 rows y with  y0 <= centre < y2
           /|
          / |                 columns x with  left edge <= centre < right edge;
         1  |                 an edge is followed from row to row as an exact fraction,
          \\ |                 quotient and remainder (Bresenham)
           \\|
            2

The colour at a centre is floor((w0 c0 + w1 c1 + w2 c2) / det + 1/2), where w are the doubled areas
of the three parts and det their sum: an affine function of x and y with rational coefficients. It
is evaluated in floating point with a bias that is larger than every rounding error and smaller
than the smallest distance of a fraction n/det from an integer it does not equal, so the result is
that of exact arithmetic; triangles too large for that argument are stepped in integers.

References
----------
J. E. Bresenham, "Algorithm for computer control of a digital plotter", IBM Systems Journal 4(1),
1965. H. Gouraud, "Continuous shading of curved surfaces", IEEE Transactions on Computers C-20(6),
1971: linear interpolation of the corners' colours. Microsoft, "Rasterization rules", Direct3D 11:
the top-left rule.
"""

from __future__ import annotations

import numpy as np

from vmesh.arrays import (
    Float64Array,
    Int32Array,
    Int64Array,
    SampleArray,
    UInt8Array,
    UInt16Array,
)
from vmesh.kernels.jit import inner_kernel, kernel

SUBPIXEL = 256
"""Units of the vertex coordinates in a pixel."""

# Values lie in 0..256: each of the few operations that form one errs by at most 2**-44, while
# n / det + 1/2 keeps at least 1 / (2 det) = 2**-37 away from an integer that it does not equal.
_LARGEST_FLOAT_DET = 1 << 36
_BIAS = 0.5 + 2.0**-40


@inner_kernel
def row_at(y: int) -> int:
    """First row whose centre is at or below a height in 1/256 pixel."""
    return (y + 127) >> 8


@inner_kernel
def corners(vertices: Int64Array, i: int, j: int, k: int) -> tuple[int, int, int, int, int, int]:
    """Corner i of a triangle, and the corners j and k relative to it."""
    x, y = vertices[i, 0], vertices[i, 1]
    x1, y1 = vertices[j, 0] - x, vertices[j, 1] - y
    x2, y2 = vertices[k, 0] - x, vertices[k, 1] - y
    return x, y, x1, y1, x2, y2


@inner_kernel
def column_at(ax: int, ay: int, bx: int, by: int, y: int) -> tuple[int, int, int, int, int]:
    """Column at which the edge a-b, a above b, meets the centres of row y.

    Returns it as a fraction ``quotient + remainder / divisor``, and what to add to quotient and
    remainder for the next row.
    """
    rise = by - ay
    run = bx - ax
    divisor = rise << 8
    numerator = (ax - 128) * rise + ((y << 8) + 128 - ay) * run
    quotient = numerator // divisor
    step = run // rise
    return quotient, numerator - quotient * divisor, divisor, step, (run - step * rise) << 8


@inner_kernel
def spans(
    vertices: Int64Array,
    triangle: Int32Array,
    width: int,
    height: int,
    rows: Int64Array,
) -> tuple[int, int]:
    """First row of a triangle and the row after its last; the columns of each row in `rows`.

    Parameters
    ----------
    triangle : ndarray
        Shape (3,), int32, turned either way.
    rows : ndarray
        Shape (height, 2), int64: on return, first column and column after the last of each row
        that the triangle meets, clipped to the raster.
    """
    a, b, c = triangle[0], triangle[1], triangle[2]
    if vertices[b, 1] < vertices[a, 1]:
        a, b = b, a
    if vertices[c, 1] < vertices[b, 1]:
        b, c = c, b
        if vertices[b, 1] < vertices[a, 1]:
            a, b = b, a
    ax, ay = vertices[a, 0], vertices[a, 1]
    bx, by = vertices[b, 0], vertices[b, 1]
    cx, cy = vertices[c, 0], vertices[c, 1]
    first = max(row_at(ay), 0)
    middle = min(max(row_at(by), 0), height)
    last = min(row_at(cy), height)
    if first >= last:
        return 0, 0
    long_side = 0 if (bx - ax) * (cy - ay) > (by - ay) * (cx - ax) else 1
    q, r, divisor, dq, dr = column_at(ax, ay, cx, cy, first)
    for y in range(first, last):
        rows[y, long_side] = min(max(q + (1 if r > 0 else 0), 0), width)
        q += dq
        r += dr
        if r >= divisor:
            r -= divisor
            q += 1
    short_side = 1 - long_side
    for half in range(2):
        start, stop = (first, middle) if half == 0 else (middle, last)
        if start >= stop:
            continue
        if half == 0:
            q, r, divisor, dq, dr = column_at(ax, ay, bx, by, start)
        else:
            q, r, divisor, dq, dr = column_at(bx, by, cx, cy, start)
        for y in range(start, stop):
            rows[y, short_side] = min(max(q + (1 if r > 0 else 0), 0), width)
            q += dq
            r += dr
            if r >= divisor:
                r -= divisor
                q += 1
    return first, last


@kernel
def measure(vertices: Int64Array, triangles: Int32Array, height: int) -> tuple[int, int]:
    """Sum of the doubled signed areas, and number of rows that drawing the triangles visits.

    Parameters
    ----------
    vertices, triangles : ndarray
        As for :func:`fill`.
    height : int
        Rows of the raster.
    """
    area = 0
    n_rows = 0
    for t in range(triangles.shape[0]):
        i, j, k = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        _, y0, x1, y1, x2, y2 = corners(vertices, i, j, k)
        area += x1 * y2 - x2 * y1
        first = max(row_at(y0 + min(0, y1, y2)), 0)
        last = min(row_at(y0 + max(0, y1, y2)), height)
        n_rows += 1 + max(last - first, 0)
    return area, n_rows


@inner_kernel
def gradient(
    c0: np.int64, c1: np.int64, c2: np.int64, x0: int, y0: int, x1: int, y1: int, x2: int, y2: int
) -> tuple[np.int64, np.int64, np.int64]:
    """The affine function that is c0, c1, c2 at three corners, as numerators over det.

    The corners 1 and 2 are given relative to corner 0. Returns the value at the centre of pixel
    (0, 0) and the changes from one pixel to the next, right and down.
    """
    right = (c1 - c0) * y2 - (c2 - c0) * y1
    down = (c2 - c0) * x1 - (c1 - c0) * x2
    origin = c0 * (x1 * y2 - x2 * y1) + right * (128 - x0) + down * (128 - y0)
    return origin, right << 8, down << 8


@inner_kernel
def fill_float(
    bases: Int64Array, rows: Int64Array, first: int, last: int, det: int, raster: UInt8Array
) -> None:
    """Fill the rows of one triangle with affine colours, in floating point.

    `bases` has shape (4, 3), int64: for each component what :func:`gradient` returns. Three things
    make the inner loops fast: an unsigned flat index, which spares the check for negative ones; a
    stride that is a constant, one loop for each; and all components in one pass.
    """
    width, n_components = raster.shape[1], raster.shape[2]
    pixels = raster.reshape(-1)
    inverse = 1.0 / float(det)
    one, two, three, four = np.uint64(1), np.uint64(2), np.uint64(3), np.uint64(4)
    origin0, right0, down0 = bases[0, 0], bases[0, 1], bases[0, 2]
    origin1, right1, down1 = bases[1, 0], bases[1, 1], bases[1, 2]
    origin2, right2, down2 = bases[2, 0], bases[2, 1], bases[2, 2]
    origin3, right3, down3 = bases[3, 0], bases[3, 1], bases[3, 2]
    slope0 = float(right0) * inverse
    slope1 = float(right1) * inverse
    slope2 = float(right2) * inverse
    slope3 = float(right3) * inverse
    for y in range(first, last):
        start = rows[y, 0]
        count = rows[y, 1] - start
        base0 = float(origin0 + down0 * y + right0 * start) * inverse + _BIAS
        base1 = float(origin1 + down1 * y + right1 * start) * inverse + _BIAS
        base2 = float(origin2 + down2 * y + right2 * start) * inverse + _BIAS
        at = np.uint64((y * width + start) * n_components)
        if n_components == 3:
            for x in range(count):
                column = float(x)
                pixels[at] = np.uint8(np.int32(base0 + slope0 * column))
                pixels[at + one] = np.uint8(np.int32(base1 + slope1 * column))
                pixels[at + two] = np.uint8(np.int32(base2 + slope2 * column))
                at += three
        elif n_components == 4:
            base3 = float(origin3 + down3 * y + right3 * start) * inverse + _BIAS
            for x in range(count):
                column = float(x)
                pixels[at] = np.uint8(np.int32(base0 + slope0 * column))
                pixels[at + one] = np.uint8(np.int32(base1 + slope1 * column))
                pixels[at + two] = np.uint8(np.int32(base2 + slope2 * column))
                pixels[at + three] = np.uint8(np.int32(base3 + slope3 * column))
                at += four
        else:
            for x in range(count):
                pixels[at] = np.uint8(np.int32(base0 + slope0 * float(x)))
                at += one


@inner_kernel
def fill_exact(
    bases: Int64Array, rows: Int64Array, first: int, last: int, det: int, raster: UInt8Array
) -> None:
    """Fill the rows of one triangle as :func:`fill_float` does, stepping exact fractions."""
    for z in range(raster.shape[2]):
        step = bases[z, 1] // det
        part = bases[z, 1] - step * det
        for y in range(first, last):
            numerator = bases[z, 0] + bases[z, 2] * y + bases[z, 1] * rows[y, 0] + det // 2
            value = numerator // det
            rest = numerator - value * det
            for x in range(rows[y, 0], rows[y, 1]):
                raster[y, x, z] = np.uint8(value)
                value += step
                rest += part
                if rest >= det:
                    rest -= det
                    value += 1


@kernel
def fill(
    vertices: Int64Array, triangles: Int32Array, colors: UInt8Array, raster: UInt8Array
) -> None:
    """Draw triangles with interpolated vertex colours, in order.

    Triangles that are turned the wrong way or have no area are not drawn.

    Parameters
    ----------
    vertices : ndarray
        Shape (n, 2), int64, in 1/256 pixel, within 2**24 of the origin.
    triangles : ndarray
        Shape (m, 3), int32, indices below n.
    colors : ndarray
        Shape (n, c), uint8, c being 1, 3 or 4.
    raster : ndarray
        Shape (h, w, c), uint8, drawn on; both sides below 2**16.
    """
    height, width, n_components = raster.shape
    rows = np.empty((height, 2), np.int64)
    bases = np.zeros((4, 3), np.int64)
    for t in range(triangles.shape[0]):
        i, j, k = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        x0, y0, x1, y1, x2, y2 = corners(vertices, i, j, k)
        det = x1 * y2 - x2 * y1
        if det <= 0:
            continue
        first, last = spans(vertices, triangles[t], width, height, rows)
        for z in range(n_components):
            c0, c1, c2 = np.int64(colors[i, z]), np.int64(colors[j, z]), np.int64(colors[k, z])
            bases[z, 0], bases[z, 1], bases[z, 2] = gradient(c0, c1, c2, x0, y0, x1, y1, x2, y2)
        if det <= _LARGEST_FLOAT_DET:
            fill_float(bases, rows, first, last, det, raster)
        else:
            fill_exact(bases, rows, first, last, det, raster)


@kernel
def fill_deep(
    vertices: Int64Array, triangles: Int32Array, colors: UInt16Array, raster: UInt16Array
) -> None:
    """Draw triangles as :func:`fill` does, in samples of up to 16 bits.

    A sample times a doubled area may take 65 bits: the upper and the lower byte of the corners'
    samples are interpolated apart, and the rest of the first division goes into the second.
    """
    height, width, n_components = raster.shape
    rows = np.empty((height, 2), np.int64)
    for t in range(triangles.shape[0]):
        i, j, k = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        x0, y0, x1, y1, x2, y2 = corners(vertices, i, j, k)
        det = x1 * y2 - x2 * y1
        if det <= 0:
            continue
        first, last = spans(vertices, triangles[t], width, height, rows)
        for y in range(first, last):
            dy = (y << 8) + 128 - y0
            for x in range(rows[y, 0], rows[y, 1]):
                dx = (x << 8) + 128 - x0
                w1, w2 = dx * y2 - dy * x2, dy * x1 - dx * y1
                w0 = det - w1 - w2
                for z in range(n_components):
                    c0, c1, c2 = colors[i, z], colors[j, z], colors[k, z]
                    upper = w0 * (c0 >> 8) + w1 * (c1 >> 8) + w2 * (c2 >> 8)
                    lower = w0 * (c0 & 255) + w1 * (c1 & 255) + w2 * (c2 & 255)
                    whole = upper // det
                    rest = ((upper - whole * det) << 8) + lower
                    raster[y, x, z] = np.uint16((whole << 8) + (2 * rest + det) // (2 * det))


def draw(
    vertices: Int64Array, triangles: Int32Array, colors: SampleArray, raster: SampleArray
) -> None:
    """Draw triangles in samples of either kind; as :func:`fill` and :func:`fill_deep`."""
    (fill if raster.dtype == np.uint8 else fill_deep)(vertices, triangles, colors, raster)


@kernel
def cover(vertices: Int64Array, triangles: Int32Array, counts: UInt8Array) -> None:
    """Add 1 to every pixel for each triangle that covers it.

    Parameters
    ----------
    vertices, triangles : ndarray
        As for :func:`fill`; the turn of a triangle does not matter.
    counts : ndarray
        Shape (h, w), uint8, wraps beyond 255.
    """
    height, width = counts.shape
    rows = np.empty((height, 2), np.int64)
    for t in range(triangles.shape[0]):
        first, last = spans(vertices, triangles[t], width, height, rows)
        for y in range(first, last):
            for x in range(rows[y, 0], rows[y, 1]):
                counts[y, x] += np.uint8(1)


@kernel
def label(vertices: Int64Array, triangles: Int32Array, labels: Int32Array) -> None:
    """Write the number of each triangle into the pixels that it covers, in order.

    Parameters
    ----------
    vertices, triangles : ndarray
        As for :func:`fill`; the turn of a triangle does not matter.
    labels : ndarray
        Shape (h, w), int32, drawn on.
    """
    height, width = labels.shape
    rows = np.empty((height, 2), np.int64)
    for t in range(triangles.shape[0]):
        first, last = spans(vertices, triangles[t], width, height, rows)
        for y in range(first, last):
            for x in range(rows[y, 0], rows[y, 1]):
                labels[y, x] = t


@kernel
def accumulate(
    vertices: Int64Array,
    triangles: Int32Array,
    samples: Float64Array,
    weights: Float64Array,
    products: Float64Array,
    moments: Float64Array,
) -> None:
    """Sums for the least-squares fit of vertex colours to pixels.

    With the barycentric weights w0, w1, w2 of a pixel's centre and its own weight g, adds
    g w_i w_j to the triangle's `products` and g w_i s to the vertex's `moments`.

    Parameters
    ----------
    vertices : ndarray
        Shape (n, 2), int64, in 1/256 pixel.
    triangles : ndarray
        Shape (m, 3), int32, positively oriented.
    samples : ndarray
        Shape (h, w, c), float64: the picture.
    weights : ndarray
        Shape (h, w), float64: weight of each pixel.
    products : ndarray
        Shape (m, 6), float64, added to: the pairs 00, 11, 22, 01, 12, 20 of corners.
    moments : ndarray
        Shape (n, c), float64, added to.
    """
    height, width, n_components = samples.shape
    rows = np.empty((height, 2), np.int64)
    for t in range(triangles.shape[0]):
        i, j, k = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        x0, y0, x1, y1, x2, y2 = corners(vertices, i, j, k)
        scale = 1.0 / (x1 * y2 - x2 * y1)
        first, last = spans(vertices, triangles[t], width, height, rows)
        for y in range(first, last):
            dy = (y << 8) + 128 - y0
            for x in range(rows[y, 0], rows[y, 1]):
                dx = (x << 8) + 128 - x0
                w1 = (dx * y2 - dy * x2) * scale
                w2 = (dy * x1 - dx * y1) * scale
                w0 = 1.0 - w1 - w2
                g = weights[y, x]
                products[t, 0] += g * w0 * w0
                products[t, 1] += g * w1 * w1
                products[t, 2] += g * w2 * w2
                products[t, 3] += g * w0 * w1
                products[t, 4] += g * w1 * w2
                products[t, 5] += g * w2 * w0
                for z in range(n_components):
                    s = g * samples[y, x, z]
                    moments[i, z] += w0 * s
                    moments[j, z] += w1 * s
                    moments[k, z] += w2 * s
