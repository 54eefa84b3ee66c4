"""A canvas cut into tiles by horizontal and vertical lines, a whole number of pixels apart."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple


class Tile(NamedTuple):
    """A piece of a canvas: its top left corner and its size, in pixels."""

    x: int
    y: int
    width: int
    height: int


class Grid(NamedTuple):
    """The tiles of a canvas: squares, except for the last of a row and of a column.

    Attributes
    ----------
    width, height : int
        Size of the canvas in pixels.
    side : int
        Side of a tile in pixels.
    """

    width: int
    height: int
    side: int

    @property
    def columns(self) -> int:
        """Number of tiles in a row."""
        return -(-self.width // self.side)

    @property
    def rows(self) -> int:
        """Number of rows of tiles."""
        return -(-self.height // self.side)

    @property
    def n_tiles(self) -> int:
        """Number of tiles."""
        return self.columns * self.rows

    def tiles(self) -> Iterator[Tile]:
        """The tiles, row by row from the top, each row from the left."""
        for y in range(0, self.height, self.side):
            for x in range(0, self.width, self.side):
                yield Tile(x, y, min(self.side, self.width - x), min(self.side, self.height - y))
