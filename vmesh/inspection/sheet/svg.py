"""Sheet -> SVG: words as text, meshes and strokes as paths, pictures as embedded PNG."""

from __future__ import annotations

import base64
import gzip
from collections.abc import Callable
from contextlib import AbstractContextManager
from typing import Any, BinaryIO, Final

import numpy as np
from lxml import etree

from vmesh.arrays import UInt8Array
from vmesh.formats.raster.rendering import png_of
from vmesh.formats.svg.document import NAMESPACE, draw_mesh, gzipped
from vmesh.formats.svg.style import Style
from vmesh.inspection.sheet.items import (
    PAPER,
    Color,
    Frame,
    Label,
    MeshPart,
    Pixels,
    Sheet,
    Strokes,
    View,
)

_LINKS: Final = "http://www.w3.org/1999/xlink"
_FONTS: Final = "Helvetica, Arial, 'Liberation Sans', sans-serif"
# Within 4 levels of what the mesh shows.
_STYLE: Final = Style("auto")
# A mesh of more takes tens of megabytes as paths: its pixels are embedded.
_MOST_TRIANGLES: Final = 50_000
_FINENESS: Final = 16  # strokes end on 1/16 of a unit


def write_sheet_svg(sheet: Sheet, stream: BinaryIO | gzip.GzipFile) -> None:
    """Write a sheet, which has one mesh at most, as an SVG document."""
    size = {"width": str(sheet.width), "height": str(sheet.height)}
    frame = {**size, "viewBox": f"0 0 {sheet.width} {sheet.height}", "version": "1.1"}
    with (
        etree.xmlfile(stream, encoding="utf-8") as document,
        document.element("svg", frame, nsmap={None: NAMESPACE, "xlink": _LINKS}),
    ):
        if sheet.title:
            document.write(_element("title", sheet.title))
        document.write(_element("rect", **size, fill=_hex(PAPER)))
        writer = _Writer(document, stream)
        for item in sheet.items:
            writer.write(item)


def write_sheet_svgz(sheet: Sheet, stream: BinaryIO) -> None:
    """Write a sheet as a compressed SVG document."""
    with gzipped(stream) as compressed:
        write_sheet_svg(sheet, compressed)


class _Writer:
    """Writes the items of a sheet into an open document."""

    def __init__(
        self, document: etree._IncrementalFileWriter, stream: BinaryIO | gzip.GzipFile
    ) -> None:
        self._document = document
        self._stream = stream
        self._writers: dict[type, Callable[[Any], None]] = {
            Pixels: lambda item: self._embed(item.x, item.y, item.array),
            MeshPart: self._draw_mesh,
            Strokes: self._stroke,
            Frame: self._frame,
            Label: self._letter,
        }

    def write(self, item: Any) -> None:
        """Write an item."""
        self._writers[type(item)](item)

    def _embed(self, x: int, y: int, array: UInt8Array) -> None:
        size = {"width": str(array.shape[1]), "height": str(array.shape[0])}
        element = _element("image", x=str(x), y=str(y), **size, preserveAspectRatio="none")
        text = base64.b64encode(png_of(array)).decode("ascii")
        element.set(f"{{{_LINKS}}}href", f"data:image/png;base64,{text}")
        self._document.write(element)

    def _draw_mesh(self, item: MeshPart) -> None:
        view = item.view
        if item.visible.n_triangles > _MOST_TRIANGLES:
            self._embed(view.x, view.y, item.pixels)
            return
        with self._window(view, f"{view.left} {view.top} {view.across} {view.down}"):
            draw_mesh(self._document, self._stream, item.visible, _STYLE)

    def _stroke(self, item: Strokes) -> None:
        view, n = item.view, _FINENESS
        look = {"stroke": _hex(item.color), "stroke-width": f"{item.width * n:.3g}"}
        with self._window(view, f"0 0 {view.width * n} {view.height * n}"):
            path = {"fill": "none", "stroke-linecap": "round", **look, "d": _path_data(item)}
            self._document.write(_element("path", **path))

    def _window(self, view: View, box: str) -> AbstractContextManager[None]:
        """A nested drawing that fills the place of a view, and shows nothing beyond."""
        place = {name: str(getattr(view, name)) for name in ("x", "y", "width", "height")}
        attributes = {**place, "viewBox": box, "preserveAspectRatio": "none", "overflow": "hidden"}
        window: AbstractContextManager[None] = self._document.element("svg", attributes)
        return window

    def _frame(self, item: Frame) -> None:
        place = {"x": f"{item.x - 0.5}", "y": f"{item.y - 0.5}"}
        size = {"width": str(item.width + 1), "height": str(item.height + 1)}
        line = _element("rect", **place, **size, fill="none", stroke=_hex(item.color))
        self._document.write(line)

    def _letter(self, item: Label) -> None:
        place = {"x": f"{item.x:.6g}", "y": f"{item.y:.6g}", "text-anchor": item.align}
        font = {"font-family": _FONTS, "font-size": f"{item.size:.4g}", "fill": _hex(item.color)}
        self._document.write(_element("text", item.text, **place, **font))


def _element(name: str, text: str | None = None, **attributes: str) -> etree._Element:
    element = etree.Element(name, attributes)
    element.text = text
    return element


def _path_data(item: Strokes) -> str:
    """Strokes as path data, each relative to the end of the one before."""
    ends = np.rint(item.placed * _FINENESS).astype(np.int64).reshape(-1, 2)
    steps = np.diff(ends, axis=0, prepend=0).reshape(-1, 4).tolist()
    return "".join(f"m{a} {b}l{c} {d}" for a, b, c, d in steps).replace(" -", "-")


def _hex(color: Color) -> str:
    return "#{:02x}{:02x}{:02x}".format(*color)
