"""Places of panels, captions and figures on a sheet.

::

      title
      figures of the mesh
      .---------. .---------. .---------.
      | panel   | |         | |         |
      '---------' '---------' '---------'
      Name        Name        Error [bar]
      detail      detail      mean  0 .. 32+
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from vmesh.inspection.heat import heat_colors
from vmesh.inspection.panels import Panel
from vmesh.inspection.region import Region
from vmesh.inspection.sheet.items import Align, Color, Frame, Item, Label, Pixels, View, shortened
from vmesh.inspection.stages import Inspection
from vmesh.inspection.views import INK, draw_error, error_top

_COLUMNS: Final = 3
_LEAST_WIDTH: Final = 240  # of a panel: what captions need
_USUAL_WIDTH: Final = 480  # from there on letters grow with the panels
_GREY: Final[Color] = (100, 100, 100)
_PALE: Final[Color] = (208, 208, 208)
_WIDE_BAR: Final = 180  # wide enough for five numbers


@dataclass(frozen=True, slots=True)
class Layout:
    """Places on a sheet; lengths grow with `unit`.

    Parameters
    ----------
    cell : int
        Width of a panel with its caption.
    picture : View
        What each panel shows.
    n_rows : int
    unit : float
    """

    cell: int
    picture: View
    n_rows: int
    unit: float

    @classmethod
    def of(cls, picture: View, n_panels: int) -> Layout:
        """Layout of panels of one size."""
        cell = max(picture.width, _LEAST_WIDTH)
        unit = max(1.0, cell / _USUAL_WIDTH)
        return cls(cell, picture, -(-n_panels // _COLUMNS), unit)

    @property
    def gap(self) -> int:
        """Space between panels, and around them."""
        return self._long(18)

    @property
    def top(self) -> int:
        """Height of the header."""
        return self._long(76)

    @property
    def row(self) -> int:
        """Height of a row of panels, with captions and the gap below."""
        return self.picture.height + self._long(48) + self.gap

    @property
    def width(self) -> int:
        """Width of the sheet."""
        return _COLUMNS * (self.cell + self.gap) + self.gap

    @property
    def height(self) -> int:
        """Height of the sheet."""
        return self.top + self.n_rows * self.row

    def header(self, title: str, figures: str) -> Iterator[Item]:
        """The title, and the figures of the mesh."""
        widest = self.width - 2 * self.gap
        yield self._label(self.gap, 36, title, 22, INK, widest)
        yield self._label(self.gap, 58, figures, 13, _GREY, widest)

    def panel(
        self, inspection: Inspection, region: Region, panel: Panel, number: int
    ) -> Iterator[Item]:
        """A panel with its caption, at the place of its number."""
        row, column = divmod(number, _COLUMNS)
        x = self.gap + column * (self.cell + self.gap)
        y = self.top + row * self.row
        size = self.picture.width, self.picture.height
        view = View(x, y, *size, region.left, region.top, region.width, region.height)
        yield from panel.draw(inspection, view)
        yield Frame(x, y, *size, _PALE)
        below = (y + size[1]) / self.unit
        has_bar = panel.draw is draw_error
        widest = self.cell / (2 if has_bar else 1)
        yield self._label(x, below + 20, panel.name, 15, INK, widest)
        yield self._label(x, below + 38, panel.detail, 12, _GREY, widest)
        if has_bar:
            yield from self._bar(x, below, error_top(inspection, view))

    def _bar(self, x: int, below: float, top: int) -> Iterator[Item]:
        """The colours of errors, with their levels, in the right half of a caption."""
        width = self.cell // 2
        left = x + self.cell - width
        colors = heat_colors(np.linspace(0, 1, width))
        bar = np.repeat(colors[None], self._long(11), axis=0)
        y = self._long(below + 9)
        yield Pixels(left, y, bar)
        yield Frame(left, y, width, len(bar), _PALE)
        n_steps = 4 if width / self.unit >= _WIDE_BAR else 2
        for i in range(n_steps + 1):
            text = f"{top * i // n_steps}" + ("+" if i == n_steps else "")
            align: Align = "start" if i == 0 else "end" if i == n_steps else "middle"
            place = left + width * i / n_steps
            yield Label(place, self.unit * (below + 38), text, 12 * self.unit, _GREY, align)

    def _label(
        self, x: float, y: float, text: str, size: float, color: Color, widest: float
    ) -> Label:
        """A label that fits a width; `y` and `size` grow with the unit."""
        size *= self.unit
        return Label(x, self.unit * y, shortened(text, size, widest), size, color)

    def _long(self, length: float) -> int:
        return round(length * self.unit)
