"""Positions by a kd-tree: boxes are halved, and the points in the first half counted (spec, 6.1).

Work is bounded by the number of points and not by the lattice, and duplicates cannot be expressed.

References
----------
O. Devillers, P.-M. Gandoin, "Geometric compression for interactive transmission", IEEE
Visualization 2000.
"""

from __future__ import annotations

from math import comb

import numpy as np

from vmesh.arrays import Int32Array, Int64Array, UInt8Array
from vmesh.kernels.coding.range_coder import DECODING, code_bit, even_model
from vmesh.kernels.jit import inner_kernel, kernel

N_AREA_CLASSES = 40  # a box halved once has at most 2**39 sites
N_SMALL = 8  # counts below this have a context of their own
N_LARGE = 24
SPLIT_CONTEXTS = N_AREA_CLASSES * N_SMALL * N_SMALL + N_LARGE * N_LARGE
SPLIT_SEEN = 16


@inner_kernel
def code_split(
    coder: Int64Array,
    data: UInt8Array,
    model: Int64Array,
    count: int,
    area: int,
    low: int,
    high: int,
    left: int,
) -> int:
    """Code how many of `count` points lie in the first half of a box: `left`, from low to high."""
    depth = 0
    size = 0
    while count >> (size + 1) > 0:
        size += 1
    while low < high:
        middle = (low + high) >> 1
        if count < N_SMALL:
            context = (area * N_SMALL + count) * N_SMALL + middle
        else:
            context = N_AREA_CLASSES * N_SMALL * N_SMALL + min(size, N_LARGE - 1) * N_LARGE
            context += min(depth, N_LARGE - 1)
        if code_bit(coder, data, model, context, 1 if left > middle else 0) == 1:
            low = middle + 1
        else:
            high = middle
        depth += 1
    return low


@kernel
def code_positions(
    coder: Int64Array,
    data: UInt8Array,
    model: Int64Array,
    points: Int32Array,
    columns: int,
    rows: int,
) -> None:
    """Code the points of a lattice along a kd-tree, by the number in the first half of each box.

    The box of the root has sides of powers of two and holds the lattice. The longer side is halved,
    the width where they are equal; the first half is coded before the second.

    Parameters
    ----------
    model : ndarray
        Shape (SPLIT_CONTEXTS, 2), int64.
    points : ndarray
        Shape (n, 2), int32, distinct, 0 <= x < columns, 0 <= y < rows. When writing, in the order
        in which they are reached; when reading, filled in that order.
    """
    n_points = points.shape[0]
    log_width, log_height = 0, 0
    while 1 << log_width < columns:
        log_width += 1
    while 1 << log_height < rows:
        log_height += 1
    # Boxes still to visit: x, y, logarithms of the sides, number of points. A box is halved at
    # most 40 times and leaves one half waiting each time.
    boxes = np.empty((64, 5), np.int64)
    boxes[0, 0], boxes[0, 1], boxes[0, 2], boxes[0, 3] = 0, 0, log_width, log_height
    boxes[0, 4] = n_points
    size = 1
    done = 0
    while size > 0:
        size -= 1
        x, y, across, down = boxes[size, 0], boxes[size, 1], boxes[size, 2], boxes[size, 3]
        count = boxes[size, 4]
        if count == 0:
            continue
        if across + down == 0:
            points[done, 0] = x
            points[done, 1] = y
            done += 1
            continue
        halve_width = across >= down
        if halve_width:
            across -= 1
        else:
            down -= 1
        x2 = x + (1 << across) if halve_width else x
        y2 = y if halve_width else y + (1 << down)
        n_first = sites(x, y, across, down, columns, rows)
        n_second = sites(x2, y2, across, down, columns, rows)
        left = 0
        if coder[DECODING] == 0:
            while left < count and (
                points[done + left, 0] < x2 if halve_width else points[done + left, 1] < y2
            ):
                left += 1
        low, high = max(0, count - n_second), min(count, n_first)
        left = code_split(coder, data, model, count, across + down, low, high, left)
        for second in (True, False):
            boxes[size, 0] = x2 if second else x
            boxes[size, 1] = y2 if second else y
            boxes[size, 2], boxes[size, 3] = across, down
            boxes[size, 4] = count - left if second else left
            size += 1


@inner_kernel
def sites(x: int, y: int, across: int, down: int, columns: int, rows: int) -> int:
    """Number of lattice sites in a box."""
    width = max(0, min(x + (1 << across), columns) - x)
    height = max(0, min(y + (1 << down), rows) - y)
    return width * height


def initial_split_model() -> Int64Array:
    """Initial model of the numbers of points, shape (SPLIT_CONTEXTS, 2), int64.

    Each of a few points is equally likely to lie in either half; but in a box of two or four sites
    it is expected in the last one, where the centres of pixels are on a lattice of half pixels.
    """
    model = even_model(SPLIT_CONTEXTS)
    for count in range(1, N_SMALL):
        for middle, (low, high) in enumerate(_search_steps(count)):
            above = sum(comb(count, left) for left in range(middle + 1, high + 1))
            share = 65536 * above // sum(comb(count, left) for left in range(low, high + 1))
            for area in range(N_AREA_CLASSES):
                context = (area * N_SMALL + count) * N_SMALL + middle
                model[context, 0] = 2048 if area < 2 else share
                model[context, 1] = SPLIT_SEEN
    return model


def _search_steps(count: int) -> list[tuple[int, int]]:
    """Bounds between which a binary search of 0 to `count` asks for each middle."""
    steps = [(0, 0)] * count
    pending = [(0, count)]
    while pending:
        low, high = pending.pop()
        if low < high:
            middle = (low + high) >> 1
            steps[middle] = (low, high)
            pending += [(low, middle), (middle + 1, high)]
    return steps
