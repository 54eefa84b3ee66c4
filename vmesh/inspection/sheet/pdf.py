"""Sheet -> PDF: words as text, meshes as shadings, strokes as paths, pictures as images.

A unit of the page's content is one of the sheet, y down::

    page
      content:   for each item, between q and Q: a picture, a form, strokes, text
      /I0 ...    pictures
      /M0 ...    forms that draw a mesh (``formats/pdf/mesh_content.py``)
      /F         Helvetica, which every program has
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from typing import Any, BinaryIO, Final

import pydyf

from vmesh.arrays import UInt8Array
from vmesh.formats.pdf.file import PdfFile
from vmesh.formats.pdf.mesh_content import MeshPainter, add, page_of
from vmesh.formats.pdf.page_size import Page
from vmesh.formats.raster.rendering import png_of
from vmesh.inspection.sheet.items import Color, Frame, Label, MeshPart, Pixels, Sheet, Strokes, View

_ROUND: Final = 1  # line caps
_FONT: Final = {
    "Type": "/Font",
    "Subtype": "/Type1",
    "BaseFont": "/Helvetica",
    "Encoding": "/WinAnsiEncoding",
}
_ENCODING: Final = "cp1252"


def write_sheet_pdf(sheet: Sheet, stream: BinaryIO) -> None:
    """Write a sheet as a PDF page."""
    pdf = PdfFile(stream)
    page = _SheetPage(pdf, sheet)
    for item in sheet.items:
        page.draw(item)
    page.close()
    if sheet.title:
        pdf.info["Title"] = pydyf.String(sheet.title)
    pdf.close()


class _SheetPage:
    """The page of a sheet: its content, and the objects that the content draws."""

    def __init__(self, pdf: PdfFile, sheet: Sheet) -> None:
        self._pdf = pdf
        self._size = Page(sheet.width, sheet.height)
        self._objects: Any = pydyf.Dictionary()
        self._content: Any = pydyf.Stream(compress=True)
        unit = self._size.user_unit
        self._content.set_matrix(1 / unit, 0, 0, -1 / unit, 0, sheet.height / unit)
        self._painters: dict[type, Callable[[Any], None]] = {
            Pixels: self._show,
            MeshPart: self._draw_mesh,
            Strokes: self._stroke,
            Frame: self._frame,
            Label: self._letter,
        }

    def draw(self, item: Any) -> None:
        """Draw an item; the graphics state is restored after it."""
        self._content.push_state()
        self._painters[type(item)](item)
        self._content.pop_state()

    def close(self) -> None:
        """Add the page to the document."""
        font = pydyf.Dictionary({"F": add(self._pdf, pydyf.Dictionary(_FONT))})
        resources = pydyf.Dictionary({"XObject": self._objects, "Font": font})
        self._pdf.add_page(page_of(self._pdf, self._size, self._content, resources))

    def _show(self, item: Pixels) -> None:
        height, width = item.array.shape[:2]
        self._content.set_matrix(width, 0, 0, -height, item.x, item.y + height)
        self._content.draw_x_object(self._named("I", _image_stream(item.array)))

    def _draw_mesh(self, item: MeshPart) -> None:
        view, mesh = item.view, item.visible
        (across, down), box = view.scale, (view.left, view.top, view.across, view.down)
        self._content.set_matrix(
            across, 0, 0, down, view.x - view.left * across, view.y - view.top * down
        )
        form = pydyf.Stream(compress=True)
        corner = (box[0] + box[2], box[1] + box[3])
        form.extra = {"Type": "/XObject", "Subtype": "/Form"}
        form.extra["BBox"] = pydyf.Array([*box[:2], *corner])
        space = "/DeviceGray" if mesh.n_components == 1 else "/DeviceRGB"
        form.extra["Resources"] = MeshPainter(self._pdf, mesh, space).draw(form)
        self._content.draw_x_object(self._named("M", form))

    def _stroke(self, item: Strokes) -> None:
        content = self._content
        self._clip(item.view)
        self._set_stroke(item.color, item.width)
        content.set_line_cap(_ROUND)
        for x0, y0, x1, y1 in item.placed.round(3).reshape(-1, 4).tolist():
            content.move_to(x0, y0)
            content.line_to(x1, y1)
        content.stroke()

    def _clip(self, view: View) -> None:
        """Put the origin at a view's corner, and show nothing beyond it."""
        self._content.set_matrix(1, 0, 0, 1, view.x, view.y)
        self._content.rectangle(0, 0, view.width, view.height)
        self._content.clip()
        self._content.end()

    def _set_stroke(self, color: Color, width: float) -> None:
        self._content.set_color_rgb(*_unit_color(color), stroke=True)
        self._content.set_line_width(round(width, 3))

    def _frame(self, item: Frame) -> None:
        self._set_stroke(item.color, 1)
        self._content.rectangle(item.x - 0.5, item.y - 0.5, item.width + 1, item.height + 1)
        self._content.stroke()

    def _letter(self, item: Label) -> None:
        content = self._content
        content.begin_text()
        content.set_font_size("F", round(item.size, 3))
        content.set_color_rgb(*_unit_color(item.color))
        content.set_text_matrix(1, 0, 0, -1, round(item.left, 3), round(item.y, 3))
        letters = item.text.encode(_ENCODING, "replace").hex()
        content.stream.append(f"<{letters}> Tj".encode("ascii"))
        content.end_text()

    def _named(self, letter: str, item: Any) -> str:
        """Add an object that the content draws; returns its name."""
        name = f"{letter}{len(self._objects)}"
        self._objects[name] = add(self._pdf, item)
        return name


def _unit_color(color: Color) -> tuple[float, ...]:
    return tuple(round(sample / 255, 3) for sample in color)


def _image_stream(array: UInt8Array) -> Any:
    """Stream of an image of shape (h, w, 3), in the compression of PNG, which PDF knows."""
    height, width = array.shape[:2]
    parameters = {"Predictor": 15, "Colors": 3, "BitsPerComponent": 8, "Columns": width}
    extra = {"Type": "/XObject", "Subtype": "/Image", "Width": width, "Height": height}
    extra |= {"ColorSpace": "/DeviceRGB", "BitsPerComponent": 8, "Filter": "/FlateDecode"}
    extra["DecodeParms"] = pydyf.Dictionary(parameters)
    return pydyf.Stream([_png_data(array)], extra)


def _png_data(array: UInt8Array) -> bytes:
    """The compressed rows of a picture's PNG file."""
    data, place, parts = png_of(array), 8, []
    while place < len(data):
        length, name = struct.unpack_from(">I4s", data, place)
        if name == b"IDAT":
            parts.append(data[place + 8 : place + 8 + length])
        place += 12 + length
    return b"".join(parts)
