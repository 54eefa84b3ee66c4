"""Interlaced rows of PNG: seven passes over the picture, each finer than what was there before.

References
----------
Portable Network Graphics (PNG) Specification (Third Edition), W3C Recommendation, 2025,
section 8.1.
"""

from __future__ import annotations

from typing import Final, NamedTuple

from vmesh.arrays import SampleArray


class Pass(NamedTuple):
    """Pixels of a pass: from x, y on, some columns and rows apart, each for a block of pixels."""

    x: int
    y: int
    columns: int
    rows: int
    block_width: int
    block_height: int

    def size(self, width: int, height: int) -> tuple[int, int]:
        """Columns and rows that a picture has in this pass."""
        return len(range(self.x, width, self.columns)), len(range(self.y, height, self.rows))


PASSES: Final = (
    Pass(0, 0, 8, 8, 8, 8),
    Pass(4, 0, 8, 8, 4, 8),
    Pass(0, 4, 4, 8, 4, 4),
    Pass(2, 0, 4, 4, 2, 4),
    Pass(0, 2, 2, 4, 2, 2),
    Pass(1, 0, 2, 2, 1, 2),
    Pass(0, 1, 1, 2, 1, 1),
)


def fill_blocks(array: SampleArray, n_rows: list[int]) -> SampleArray:
    """A picture whose missing pixels take the colours of coarser passes.

    Parameters
    ----------
    array : ndarray
        Shape (h, w) or (h, w, c).
    n_rows : list of int
        Rows of each pass that are there.

    Returns
    -------
    ndarray
        The same shape; what not even the first pass has stays what it is.
    """
    filled = array.copy()
    for place, n_there in zip(PASSES, n_rows, strict=True):
        known = array[place.y :: place.rows, place.x :: place.columns][:n_there]
        for down in range(place.block_height):
            for across in range(place.block_width):
                target = filled[place.y + down :: place.rows, place.x + across :: place.columns]
                n, m = min(len(known), len(target)), min(known.shape[1], target.shape[1])
                target[:n, :m] = known[:n, :m]
    return filled
