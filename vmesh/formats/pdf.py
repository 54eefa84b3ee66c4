"""Mesh -> PDF: one page with the mesh as shadings of type 4, which are made for such meshes.

::

    catalog -- XMP
      page -- the picture's own XMP
        content:   scale to pixels, backdrop, soft mask if there is one, picture
        /P         a form: /S0 sh /S1 sh ...   the colours    (an isolated group)
        /A         a soft mask: /S0 sh ...     the alpha, drawn as grey
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, BinaryIO, Final, Literal, get_args

import deflate
import pydyf

from vmesh.arrays import UInt8Array
from vmesh.formats.description import Description
from vmesh.formats.page import Page, make_page
from vmesh.formats.profiles import srgb_profile
from vmesh.formats.raster import fits_icc
from vmesh.formats.shading import Shading, make_shadings
from vmesh.limits import DEFAULT_LIMITS, Limits
from vmesh.mesh import Mesh

Backend = Literal["native", "cairo"]
Mode = Literal["exact"]

# Of 12: 3 to 4 % smaller than zlib's best, in a tenth of a second for 40,000 triangles.
_LEVEL: Final = 12


def write_pdf(
    mesh: Mesh,
    stream: BinaryIO,
    *,
    mode: Mode = "exact",
    backend: Backend = "native",
    page_width: str | None = None,
    limits: Limits = DEFAULT_LIMITS,
) -> None:
    """Write a mesh as a PDF page.

    Parameters
    ----------
    mesh : Mesh
    stream : binary file
    mode : {"exact"}
        PDF draws meshes as they are: there is nothing to choose.
    backend : {"native", "cairo"}
        What draws: shadings of type 4, or cairo's mesh patterns in a file that cairo writes.
    page_width : str, optional
        Width of the page, such as "210mm", "8.5in" or "400pt". Without it the resolution in the
        picture's EXIF decides, and where there is none a pixel is 1/72 inch.
    limits : Limits
        What the mesh may ask for.

    Raises
    ------
    VmeshError
        If cairo is asked for and not installed.
    """
    limits.check_vertices(mesh.n_vertices)
    for name, value, known in (("mode", mode, Mode), ("backend", backend, Backend)):
        if value not in get_args(known):
            raise ValueError(f"expected {name} to be {' or '.join(get_args(known))}, got {value!r}")
    page = make_page(mesh, page_width)
    if backend == "cairo":
        from vmesh.formats.cairo_pdf import write_cairo_pdf

        write_cairo_pdf(mesh, stream, page)
    else:
        _Document(mesh, page).write(stream)


class _Document:
    """A PDF document with a mesh on its page."""

    def __init__(self, mesh: Mesh, page: Page) -> None:
        self._pdf: Any = pydyf.PDF()
        self._mesh = mesh
        self._description = Description.of(mesh.metadata)
        self._space = self._color_space()
        self._add_page(page)

    def write(self, stream: BinaryIO) -> None:
        """Write the file."""
        pdf, description = self._pdf, self._description
        xmp = {"Type": "/Metadata", "Subtype": "/XML"}
        pdf.catalog["Metadata"] = self._add(_compressed(description.as_xmp(), xmp))
        for name, text in description.as_information().items():
            pdf.info[name] = pydyf.String(text)
        pdf.write(stream, version=b"1.7", identifier=True, compress=True)

    def _add_page(self, size: Page) -> None:
        """Add the page, a unit of whose content is a pixel, y down."""
        mesh, unit = self._mesh, size.user_unit
        width, height = size.width / unit, size.height / unit
        content = pydyf.Stream(compress=True)
        content.set_matrix(width / mesh.width, 0, 0, -height / mesh.height, 0, height)
        resources = self._draw(content)
        page = pydyf.Dictionary({"Type": "/Page", "Parent": self._pdf.pages.reference})
        page["MediaBox"] = pydyf.Array([0, 0, width, height])
        if unit > 1:
            page["UserUnit"] = unit
        page["Contents"] = self._add(content)
        page["Resources"] = resources
        if mesh.metadata.xmp:
            xmp = {"Type": "/Metadata", "Subtype": "/XML"}
            page["Metadata"] = self._add(_compressed(mesh.metadata.xmp, xmp))
        self._pdf.add_page(page)

    def _draw(self, content: Any) -> Any:
        """Write the content of the page; the resources that it needs."""
        mesh, colors = self._mesh, self._mesh.plain_colors
        if mesh.n_components == 4 and (colors[:, 3] < 255).any():
            mask: dict[str, Any] = {"Type": "/Mask", "S": "/Luminosity"}
            mask["G"] = self._add(self._group(colors[:, 3:], "/DeviceGray"))
            content.set_state("A")
            content.draw_x_object("P")
            states = pydyf.Dictionary({"A": pydyf.Dictionary({"SMask": pydyf.Dictionary(mask)})})
            picture = self._add(self._group(colors[:, :3], self._space))
            forms = pydyf.Dictionary({"P": picture})
            return pydyf.Dictionary({"ExtGState": states, "XObject": forms})
        colors = colors[:, :3]
        resources = self._add_shadings(content, colors, self._space)
        if mesh.covers_canvas:
            # Under the hundredths of a pixel that the shift leaves open on two sides.
            mean = (colors.mean(axis=0) / 255).round(3).tolist()
            fill = pydyf.Stream()
            fill.set_color_space("C")
            fill.set_color_special(None, False, *mean)
            fill.rectangle(0, 0, mesh.width, mesh.height)
            fill.fill()
            content.stream[1:1] = fill.stream
            resources["ColorSpace"] = pydyf.Dictionary({"C": self._space})
        return resources

    def _group(self, colors: UInt8Array, space: Any) -> Any:
        """A form that draws the mesh as an isolated transparency group."""
        box = pydyf.Array([0, 0, self._mesh.width, self._mesh.height])
        group = pydyf.Dictionary({"S": "/Transparency", "CS": space, "I": "true"})
        form = pydyf.Stream(compress=True)
        form.extra = {"Type": "/XObject", "Subtype": "/Form", "BBox": box, "Group": group}
        form.extra["Resources"] = self._add_shadings(form, colors, space)
        return form

    def _add_shadings(self, content: Any, colors: UInt8Array, space: Any) -> Any:
        """Draw the mesh in a content stream; the resources that this needs."""
        shadings = pydyf.Dictionary()
        for i, shading in enumerate(make_shadings(self._mesh, colors)):
            shadings[f"S{i}"] = self._add(_shading_stream(shading, colors.shape[1], space))
            content.paint_shading(f"S{i}")
        return pydyf.Dictionary({"Shading": shadings})

    def _color_space(self) -> Any:
        """The picture's own profile, or sRGB; grey without a profile is the device's."""
        own, n_components = self._mesh.metadata.icc, self._mesh.n_components
        if not fits_icc(own, n_components):
            if n_components == 1:
                return "/DeviceGray"
            own = srgb_profile()
        profile = _compressed(own, {"N": min(n_components, 3)})
        return pydyf.Array(["/ICCBased", self._add(profile)])

    def _add(self, item: Any) -> bytes:
        """Add an object; a reference to it."""
        self._pdf.add_object(item)
        reference: bytes = item.reference
        return reference


def _shading_stream(shading: Shading, n_components: int, space: Any) -> Any:
    """The stream of a shading, with the dictionary that says how to read it."""
    ranges: Iterable[float] = (*shading.bounds, *(0, 1) * n_components)
    widths = {"BitsPerFlag": 8, "BitsPerCoordinate": 16, "BitsPerComponent": 8}
    extra = {"ShadingType": 4, "ColorSpace": space, **widths, "Decode": pydyf.Array(ranges)}
    return _compressed(shading.records, extra)


def _compressed(data: bytes, extra: dict[str, Any]) -> Any:
    """A compressed stream."""
    packed = bytes(deflate.zlib_compress(data, _LEVEL))
    return pydyf.Stream([packed], {**extra, "Filter": "/FlateDecode"})
