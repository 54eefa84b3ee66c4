"""A mesh in the content of a PDF page or form, and the page.

::

    content:   backdrop, soft mask if there is one, picture
    /P         a form: /S0 sh /S1 sh ...   the colours    (an isolated group)
    /A         a soft mask: /S0 sh ...     the alpha, drawn as grey
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Final

import deflate
import pydyf

from vmesh.arrays import UInt8Array
from vmesh.formats.pdf.file import PdfFile
from vmesh.formats.pdf.page_size import Page
from vmesh.formats.pdf.shading import Shading, make_shadings
from vmesh.mesh import Mesh

# The highest: 3 to 4 % smaller than zlib's best, in a tenth of a second for 40,000 triangles.
_LEVEL: Final = 12


class MeshPainter:
    """Draws a mesh in a content stream, a unit of which is a pixel, y down.

    Parameters
    ----------
    pdf : PdfFile
        The file, to which objects are added.
    mesh : Mesh
    space : str or pydyf.Array
        Colour space of the mesh's colours without alpha.
    """

    def __init__(self, pdf: PdfFile, mesh: Mesh, space: Any) -> None:
        self._pdf = pdf
        self._mesh = mesh
        self._space = space

    def draw(self, content: Any) -> Any:
        """Write the operators that draw the mesh; returns the resources that they need."""
        mesh, colors = self._mesh, self._mesh.plain_colors
        if mesh.n_components == 4 and (colors[:, 3] < 255).any():
            return self._draw_masked(content, colors)
        colors = colors[:, :3]
        spaces = {}
        if mesh.covers_canvas:
            self._fill(content, (colors.mean(axis=0) / 255).round(3).tolist())
            spaces["ColorSpace"] = pydyf.Dictionary({"C": self._space})
        resources = self._add_shadings(content, colors, self._space)
        resources.update(spaces)
        return resources

    def _fill(self, content: Any, color: list[float]) -> None:
        """Fill the canvas, under the hundredths of a pixel that the shift leaves open."""
        content.set_color_space("C")
        content.set_color_special(None, False, *color)
        content.rectangle(0, 0, self._mesh.width, self._mesh.height)
        content.fill()

    def _draw_masked(self, content: Any, colors: UInt8Array) -> Any:
        """Write the operators that draw a mesh with alpha; returns the resources that they need."""
        mask: dict[str, Any] = {"Type": "/Mask", "S": "/Luminosity"}
        mask["G"] = add(self._pdf, self._group(colors[:, 3:], "/DeviceGray"))
        content.set_state("A")
        content.draw_x_object("P")
        states = pydyf.Dictionary({"A": pydyf.Dictionary({"SMask": pydyf.Dictionary(mask)})})
        picture = add(self._pdf, self._group(colors[:, :3], self._space))
        forms = pydyf.Dictionary({"P": picture})
        return pydyf.Dictionary({"ExtGState": states, "XObject": forms})

    def _group(self, colors: UInt8Array, space: Any) -> Any:
        """A form that draws the mesh as an isolated transparency group."""
        box = pydyf.Array([0, 0, self._mesh.width, self._mesh.height])
        group = pydyf.Dictionary({"S": "/Transparency", "CS": space, "I": "true"})
        form = pydyf.Stream(compress=True)
        form.extra = {"Type": "/XObject", "Subtype": "/Form", "BBox": box, "Group": group}
        form.extra["Resources"] = self._add_shadings(form, colors, space)
        return form

    def _add_shadings(self, content: Any, colors: UInt8Array, space: Any) -> Any:
        """Draw the mesh in a content stream; returns the resources that this needs."""
        shadings = pydyf.Dictionary()
        for i, shading in enumerate(make_shadings(self._mesh, colors)):
            shadings[f"S{i}"] = add(self._pdf, _shading_stream(shading, colors.shape[1], space))
            content.paint_shading(f"S{i}")
        return pydyf.Dictionary({"Shading": shadings})


def page_of(pdf: PdfFile, size: Page, content: Any, resources: Any) -> Any:
    """A page for a file, which is still to be added to it."""
    unit = size.user_unit
    page = pydyf.Dictionary({"Type": "/Page", "Parent": pdf.pages.reference})
    page["MediaBox"] = pydyf.Array([0, 0, size.width / unit, size.height / unit])
    if unit > 1:
        page["UserUnit"] = unit
    page["Contents"] = add(pdf, content)
    page["Resources"] = resources
    return page


def add(pdf: PdfFile, item: Any) -> bytes:
    """Add an object to a file; returns a reference to it."""
    pdf.add_object(item)
    reference: bytes = item.reference
    return reference


def compressed(data: bytes, extra: dict[str, Any]) -> Any:
    """A compressed stream."""
    packed = bytes(deflate.zlib_compress(data, _LEVEL))
    return pydyf.Stream([packed], {**extra, "Filter": "/FlateDecode"})


def _shading_stream(shading: Shading, n_components: int, space: Any) -> Any:
    """The stream of a shading, with the dictionary that says how to read it."""
    ranges: Iterable[float] = (*shading.bounds, *(0, 1) * n_components)
    widths = {"BitsPerFlag": 8, "BitsPerCoordinate": 16, "BitsPerComponent": 8}
    extra = {"ShadingType": 4, "ColorSpace": space, **widths, "Decode": pydyf.Array(ranges)}
    return compressed(shading.records, extra)
