"""A region of a picture, and how large it is shown."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from vmesh.inspection.sheet.items import View
from vmesh.limits import MAX_SIDE

# A smaller region is enlarged by a whole number, a larger one is reduced.
_SMALLEST: Final = 400
_LARGEST: Final = 1000


@dataclass(frozen=True, slots=True)
class Region:
    """A rectangle of whole pixels.

    Raises
    ------
    ValueError
        If it has no pixel, or begins left of the picture or above it.
    """

    left: int
    top: int
    width: int
    height: int

    def __post_init__(self) -> None:
        if min(self.width, self.height) < 1 or min(self.left, self.top) < 0:
            raise ValueError(
                "expected a region of at least one pixel, from 0,0 on, "
                f"got {self.width} x {self.height} at {self.left},{self.top}"
            )

    @classmethod
    def parse(cls, text: str) -> Region:
        """The region that a text such as ``120,80,40,30`` names: left, top, width and height."""
        try:
            left, top, width, height = (int(part) for part in text.split(","))
        except ValueError:
            raise ValueError(
                f"expected four whole numbers x,y,w,h such as 120,80,40,30, got {text!r}"
            ) from None
        return cls(left, top, width, height)

    def check_within(self, width: int, height: int) -> None:
        """Raise :class:`ValueError` if a picture of this size does not hold the region."""
        if self.left + self.width > width or self.top + self.height > height:
            raise ValueError(
                f"the region of {self.width} x {self.height} pixels at {self.left},{self.top} "
                f"reaches beyond the picture of {width} x {height}"
            )

    def view(self, scale: float, x: int = 0, y: int = 0) -> View:
        """View of the region at a place of a sheet."""
        width, height = (max(1, round(side * scale)) for side in (self.width, self.height))
        return View(x, y, width, height, self.left, self.top, self.width, self.height)

    def good_scale(self, longest_side: int) -> float:
        """Units of a sheet for a pixel that suit a picture with this longest side."""
        own = max(self.width, self.height)
        if own >= _SMALLEST:
            return min(1.0, _LARGEST / own)
        # Beyond that coordinates of the whole picture would be too large to draw with.
        return float(max(1, min(-(-_SMALLEST // own), MAX_SIDE // longest_side)))
