"""A sheet: pictures, drawings and words at their places, to be written as pixels, SVG or PDF.

A unit of a sheet is a pixel of its raster, a pixel of CSS in SVG, and 1/72 inch in PDF; x points
right and y down. Items are painted in their order on white. Items that show a part of a canvas do
so through a :class:`View`::

      canvas of a mesh                       sheet
     .--------------------.
     |  left, top         |             x, y
     |    .-------.       |               .------------.
     |    | part  | down  |     ->        |            | height
     |    '-------'       |               '------------'
     |     across         |                    width
     '--------------------'
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Final, Literal

import numpy as np
from PIL import ImageFont

from vmesh.arrays import BoolArray, Float64Array, UInt8Array
from vmesh.formats.picture.conversion import flatten
from vmesh.formats.raster.region import render_part
from vmesh.limits import DEFAULT_LIMITS, Limits
from vmesh.mesh import Mesh

Color = tuple[int, int, int]
Align = Literal["start", "middle", "end"]

PAPER: Final[Color] = (255, 255, 255)


@dataclass(frozen=True, slots=True)
class View:
    """A place on a sheet, and the part of a canvas that fills it, in whole pixels of each."""

    x: int
    y: int
    width: int
    height: int
    left: int
    top: int
    across: int
    down: int

    @property
    def scale(self) -> tuple[float, float]:
        """Units of the sheet in a pixel of the canvas, along x and y."""
        return self.width / self.across, self.height / self.down

    def place(self, points: Float64Array) -> Float64Array:
        """Points of a canvas, shape (..., 2), in units of the sheet from the view's corner."""
        placed: Float64Array = (points - (self.left, self.top)) * self.scale
        return placed

    def touches(self, boxes: Float64Array) -> BoolArray:
        """True for each box of a canvas that shows: (n, 4), left, top, right, bottom -> (n,)."""
        right, bottom = self.left + self.across, self.top + self.down
        begins = (boxes[:, 0] <= right) & (boxes[:, 1] <= bottom)
        ends = (boxes[:, 2] >= self.left) & (boxes[:, 3] >= self.top)
        shown: BoolArray = begins & ends
        return shown


@dataclass(frozen=True, slots=True)
class Pixels:
    """A picture of shape (h, w, 3), uint8: a pixel fills a unit of the sheet."""

    x: int
    y: int
    array: UInt8Array


@dataclass(frozen=True)
class MeshPart:
    """A part of a mesh, on white."""

    view: View
    mesh: Mesh
    limits: Limits = DEFAULT_LIMITS

    @cached_property
    def visible(self) -> Mesh:
        """The mesh with the triangles that show, and no metadata."""
        corners = self.mesh.points[self.mesh.triangles]
        boxes = np.concatenate([corners.min(axis=1), corners.max(axis=1)], axis=1)
        shown = self.mesh.triangles[self.view.touches(boxes)]
        return self.mesh.replaced(triangles=shown, metadata=type(self.mesh.metadata)())

    @cached_property
    def pixels(self) -> UInt8Array:
        """The part as pixels of the sheet, shape (h, w, 3)."""
        view = self.view
        part = (view.left, view.top, view.across, view.down)
        size = (view.width, view.height)
        drawn = render_part(self.visible, part, size, limits=self.limits)
        return flatten(drawn, self.mesh.depth)


@dataclass(frozen=True)
class Strokes:
    """Straight strokes with round ends; strokes without length are dots.

    Parameters
    ----------
    view : View
        The view outside of which nothing shows.
    ends : ndarray
        Shape (n, 2, 2), float64: first and last point of each, in pixels of the canvas.
    width : float
        In units of the sheet.
    """

    view: View
    ends: Float64Array
    color: Color
    width: float

    @cached_property
    def placed(self) -> Float64Array:
        """The ends of the strokes that show, in units of the sheet from the view's corner."""
        boxes = np.concatenate([self.ends.min(axis=1), self.ends.max(axis=1)], axis=1)
        return self.view.place(self.ends[self.view.touches(boxes)])


@dataclass(frozen=True, slots=True)
class Frame:
    """A line of one unit just outside of a place."""

    x: int
    y: int
    width: int
    height: int
    color: Color


@dataclass(frozen=True, slots=True)
class Label:
    """A line of text with its baseline at `y`; `align` says which point of it is at `x`."""

    x: float
    y: float
    text: str
    size: float
    color: Color
    align: Align = "start"

    @property
    def width(self) -> float:
        """Width in the raster's font; the fonts of other programs are about as wide."""
        return font_of(self.size).getlength(self.text)

    @property
    def left(self) -> float:
        """Left end of the text."""
        return self.x - self.width * {"start": 0.0, "middle": 0.5, "end": 1.0}[self.align]


Item = Pixels | MeshPart | Strokes | Frame | Label


@dataclass(frozen=True, slots=True)
class Sheet:
    """Items on white, its size in whole units, and a title for programs that show one."""

    width: int
    height: int
    items: Sequence[Item]
    title: str = ""


@cache
def font_of(size: float) -> ImageFont.FreeTypeFont:
    """Font of a raster's labels: the one that Pillow brings along."""
    font = ImageFont.load_default(size=size)
    if not isinstance(font, ImageFont.FreeTypeFont):
        raise ImportError("captions need a Pillow that was built with FreeType")
    return font


def printable(text: str) -> str:
    """A text, such as the name of a file, that all formats can hold."""
    return "".join(letter if letter.isprintable() else "?" for letter in text)


def shortened(text: str, size: float, width: float) -> str:
    """A text that is cut so that it fits a width."""
    if Label(0, 0, text, size, PAPER).width <= width:
        return text
    while text and Label(0, 0, text + " ...", size, PAPER).width > width:
        text = text[:-1]
    return text.rstrip() + " ..."
