"""The size of a PDF page: as asked for, else by the picture's EXIF, else by its pixels."""

from __future__ import annotations

import re
from dataclasses import dataclass
from math import ceil
from typing import Final

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


@dataclass(frozen=True, slots=True)
class Page:
    """Size of a page in points, and how it is written.

    Parameters
    ----------
    width, height : float
        In points, 1/72 inch.
    """

    width: float
    height: float

    @property
    def user_unit(self) -> int:
        """Points in a unit of the page: 1, except for pages that are longer than 14,400 points."""
        return max(1, ceil(max(self.width, self.height) / _LONGEST_SIDE))


def make_page(mesh: Mesh, width: str | None = None) -> Page:
    """The page that a mesh fills.

    Parameters
    ----------
    mesh : Mesh
    width : str, optional
        Length such as "210mm", "8.5in", "400pt". Without it the resolution in the picture's EXIF
        decides, and where there is none a pixel is a point.
    """
    across, down = _points_per_pixel(mesh)
    if width is not None:
        factor = points_of(width) / (mesh.width * across)
        across, down = across * factor, down * factor
    return Page(mesh.width * across, mesh.height * down)


def points_of(length: str) -> float:
    """Points of a length with its unit.

    Raises
    ------
    ValueError
        If it is not a positive number with one of the units pt, in, mm, cm, px (1/96 inch).
    """
    match = _LENGTH.fullmatch(length.lower())
    unit = _UNITS.get(match[2] or "pt") if match else None
    points = float(match[1]) * unit if match and unit else 0.0
    if not 0.0 < points <= _LARGEST_WIDTH:
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
