"""PDF pages: their size, and where on them the picture is.

Without a paper the page is as large as the picture, with a margin around it: as asked for, else by
the resolution in its EXIF, else by its pixels. On a paper the picture is in the middle, as large as
the margins leave room::

    +-----------------+
    |     margin      |
    |  +-----------+  |      A4 lies as the picture does, unless an orientation is given;
    |  |  picture  |  |      210x297mm stands as it is.
    |  +-----------+  |
    |                 |
    +-----------------+

References
----------
ISO 216: sizes of paper.
"""

from __future__ import annotations

import re
from contextlib import suppress
from dataclasses import dataclass
from math import ceil, inf
from typing import Final, Literal, get_args

from vmesh.formats.metadata.exif import (
    CENTIMETRE,
    INCH,
    RESOLUTION_UNIT,
    X_RESOLUTION,
    Y_RESOLUTION,
    Rational,
    read_exif,
)
from vmesh.mesh import Mesh

# Points in a unit of length.
_UNITS: Final = {"pt": 1.0, "in": 72.0, "mm": 72.0 / 25.4, "cm": 72.0 / 2.54, "px": 0.75}
_LENGTH: Final = re.compile(r"\s*(\d+\.?\d*|\.\d+)\s*([a-z]*)\s*")
_LONGEST_SIDE: Final = 14_400  # units that a page may have, by what viewers accept
_LARGEST_WIDTH: Final = 1e6  # points: 350 m

_POINTS_IN: Final = {INCH: 72.0, CENTIMETRE: 72.0 / 2.54}
_DENSEST: Final = 100.0  # pixels in a point that are believed: 7200 dpi

_ISO: Final = {"a": (841, 1189), "b": (1000, 1414)}  # millimetres of size 0
_ISO_NAME: Final = re.compile("([ab])([0-9]|10)")
_PAPERS: Final = {"letter": (8.5, 11.0), "legal": (8.5, 14.0), "tabloid": (11.0, 17.0)}  # inches
_SIZE: Final = re.compile(r"\s*([\d.]+)\s*([a-z]*)\s*[x\u00d7]\s*([\d.]+)\s*([a-z]*)\s*")

Orientation = Literal["portrait", "landscape"]


@dataclass(frozen=True, slots=True)
class Box:
    """Place of a picture on a page, in points from the page's lower left corner."""

    left: float
    bottom: float
    width: float
    height: float


@dataclass(frozen=True, slots=True)
class Page:
    """Size of a page in points, and how it is written.

    Parameters
    ----------
    width, height : float
        In points, 1/72 inch.
    box : Box, optional
        Place of the picture; all of the page unless given.
    """

    width: float
    height: float
    box: Box | None = None

    @property
    def picture(self) -> Box:
        """Place of the picture."""
        return self.box or Box(0, 0, self.width, self.height)

    @property
    def user_unit(self) -> int:
        """Points in a unit of the page: 1, except for pages that are longer than 14,400 points."""
        return max(1, ceil(max(self.width, self.height) / _LONGEST_SIDE))


@dataclass(frozen=True, slots=True)
class Layout:
    """Options of a page, checked.

    Parameters
    ----------
    page_width : str, optional
        Width of the page, such as "210mm", "8.5in" or "400pt". Without it, and without
        `page_size`, the resolution in the picture's EXIF decides, and where there is none a pixel
        is a point.
    page_size : str, optional
        Name or sides of a paper, such as "A4", "letter" or "210x297mm", on which the picture is in
        the middle, as large as it fits.
    orientation : {"portrait", "landscape"}, optional
        How the paper stands; else a paper of a name stands as each picture, another as it is given.
    margin : str, optional
        Room around the picture, such as "10mm".

    Raises
    ------
    ValueError
        If an option is no length, size or orientation, if two exclude each other, or if margins
        leave no room.
    """

    page_width: str | None = None
    page_size: str | None = None
    orientation: Orientation | None = None
    margin: str | None = None

    def __post_init__(self) -> None:
        if self.page_size is not None and self.page_width is not None:
            raise ValueError("a page has a size or a width: expected one of the two")
        if self.orientation not in (None, *get_args(Orientation)):
            raise ValueError(
                f"expected orientation to be one of {', '.join(get_args(Orientation))}, "
                f"got {self.orientation!r}"
            )
        if self.orientation is not None and self.page_size is None:
            raise ValueError("an orientation is that of a page size: expected one")
        room = inf if self.page_width is None else points_of(self.page_width)
        if self.page_size is not None:
            room = min(sides_of(self.page_size))
        if 2 * self._margin >= room:
            raise ValueError(f"margins of {self.margin} leave no room for a picture")

    @property
    def _margin(self) -> float:
        return 0.0 if self.margin is None else points_of(self.margin, may_be_zero=True)

    def page_of(self, mesh: Mesh) -> Page:
        """The page of a mesh."""
        margin = self._margin
        across, down = _points_per_pixel(mesh)
        width, height = mesh.width * across, mesh.height * down
        if self.page_size is None:
            if self.page_width is not None:
                room = points_of(self.page_width) - 2 * margin
                width, height = room, height * (room / width)
            box = Box(margin, margin, width, height) if margin else None
            return Page(width + 2 * margin, height + 2 * margin, box)
        sides = sides_of(self.page_size)
        if self.orientation is not None or not _SIZE.fullmatch(self.page_size.lower()):
            lies = width > height if self.orientation is None else self.orientation == "landscape"
            sides = (max(sides), min(sides)) if lies else (min(sides), max(sides))
        scale = min((sides[0] - 2 * margin) / width, (sides[1] - 2 * margin) / height)
        width, height = width * scale, height * scale
        return Page(*sides, Box((sides[0] - width) / 2, (sides[1] - height) / 2, width, height))


def make_page(mesh: Mesh, layout: Layout | None = None) -> Page:
    """The page of a mesh, which it fills unless a layout says otherwise."""
    return (layout or Layout()).page_of(mesh)


def sides_of(size: str) -> tuple[float, float]:
    """Width and height in points of a paper, by its name or its sides.

    Raises
    ------
    ValueError
        If it is neither the name of a paper nor two lengths, such as 210x297mm.
    """
    name = size.strip().lower()
    if name in _PAPERS:
        width, height = _PAPERS[name]
        return 72 * width, 72 * height
    if named := _ISO_NAME.fullmatch(name):
        sides = _ISO[named[1]]
        for _ in range(int(named[2])):
            sides = (sides[1] // 2, sides[0])
        return sides[0] * _UNITS["mm"], sides[1] * _UNITS["mm"]
    match = _SIZE.fullmatch(name)
    with suppress(ValueError):
        if match:
            unit = match[4] or match[2]
            return points_of(match[1] + (match[2] or unit)), points_of(match[3] + unit)
    raise ValueError(
        f"expected a page size such as A4, B5, {', '.join(_PAPERS)} or 210x297mm, got {size!r}"
    )


def points_of(length: str, *, may_be_zero: bool = False) -> float:
    """Points of a length with its unit.

    Raises
    ------
    ValueError
        If it is not a positive number with one of the units pt, in, mm, cm, px (1/96 inch).
    """
    match = _LENGTH.fullmatch(length.lower())
    unit = _UNITS.get(match[2] or "pt") if match else None
    points = float(match[1]) * unit if match and unit else -1.0
    if not 0 <= points <= _LARGEST_WIDTH or (points == 0 and not may_be_zero):
        raise ValueError(f"expected a length such as 210mm, 8.5in or 400pt, got {length!r}")
    return points


def _points_per_pixel(mesh: Mesh) -> tuple[float, float]:
    """Points of a pixel's width and height, by EXIF's resolution; 1 where there is none."""
    exif = read_exif(mesh.metadata.exif)
    inch = _POINTS_IN.get(exif.get(RESOLUTION_UNIT, INCH))
    x, y = exif.get(X_RESOLUTION), exif.get(Y_RESOLUTION)
    if inch is None or not (isinstance(x, Rational) and isinstance(y, Rational)):
        return 1.0, 1.0
    across, down = float(x) / inch, float(y) / inch
    if not (1 / _DENSEST <= across <= _DENSEST and 1 / _DENSEST <= down <= _DENSEST):
        return 1.0, 1.0
    return 1 / across, 1 / down
