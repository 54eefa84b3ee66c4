"""The largest file within a budget of bytes, among files that grow with a level."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping


def largest_within(
    budget: int, levels: range, size_of: Callable[[int], int], known: Mapping[int, int]
) -> int | None:
    """The level of the largest file of at most `budget` bytes, none if all are larger.

    Parameters
    ----------
    budget : int
    levels : range
        Files grow from one to the next, by about the same factor each.
    size_of : callable
        Bytes of the file of a level.
    known : mapping
        Bytes of files by their level, where they are known already.
    """
    sizes = dict(known)
    low = max((level for level in sizes if sizes[level] <= budget), default=levels.start - 1)
    high = min((level for level in sizes if level > low), default=levels.stop)
    while high - low > 1:
        level = (low + high) // 2
        if low in sizes and high in sizes:
            share = math.log(budget / sizes[low]) / math.log(sizes[high] / sizes[low])
            level = min(max(low + round(share * (high - low)), low + 1), high - 1)
        sizes[level] = size_of(level)
        if sizes[level] <= budget:
            low = level
        else:
            high = level
    return low if low in levels else None
