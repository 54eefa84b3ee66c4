"""Mesh -> PDF: one page with the mesh as shadings of type 4, which draw such meshes exactly.

::

    catalog -- XMP
      page -- the picture's own XMP
        content:   scale to pixels, the mesh (``mesh_content.py``)

References
----------
ISO 32000-2, 8.7.4.5.5: free-form Gouraud-shaded triangle meshes. H. Gouraud, "Continuous shading of
curved surfaces", IEEE Transactions on Computers C-20(6), 1971.
"""

from __future__ import annotations

from typing import Any, BinaryIO, Literal, get_args

import pydyf

from vmesh.formats.color.profiles import srgb_profile
from vmesh.formats.metadata.description import Description
from vmesh.formats.pdf.mesh_content import MeshPainter, add, compressed, page_of
from vmesh.formats.pdf.page_size import Page, make_page
from vmesh.formats.raster.rendering import fits_icc
from vmesh.limits import DEFAULT_LIMITS, Limits
from vmesh.mesh import Mesh

Backend = Literal["native", "cairo"]
Mode = Literal["exact"]


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
        from vmesh.formats.pdf.cairo_backend import write_cairo_pdf

        write_cairo_pdf(mesh, stream, page)
    else:
        _Document(mesh, page).write(stream)


class _Document:
    """A PDF document with a mesh on its page."""

    def __init__(self, mesh: Mesh, page: Page) -> None:
        self._pdf: Any = pydyf.PDF()
        self._mesh = mesh
        self._description = Description.of(mesh.metadata)
        self._add_page(page)

    def write(self, stream: BinaryIO) -> None:
        """Write the file."""
        pdf, description = self._pdf, self._description
        xmp = {"Type": "/Metadata", "Subtype": "/XML"}
        pdf.catalog["Metadata"] = add(pdf, compressed(description.as_xmp(), xmp))
        for name, text in description.as_information().items():
            pdf.info[name] = pydyf.String(text)
        pdf.write(stream, version=b"1.7", identifier=True, compress=True)

    def _add_page(self, size: Page) -> None:
        """Add the page, a unit of whose content is a pixel, y down."""
        mesh, unit = self._mesh, size.user_unit
        width, height = size.width / unit, size.height / unit
        content = pydyf.Stream(compress=True)
        content.set_matrix(width / mesh.width, 0, 0, -height / mesh.height, 0, height)
        resources = MeshPainter(self._pdf, mesh, self._color_space()).draw(content)
        page = page_of(self._pdf, size, content, resources)
        if mesh.metadata.xmp:
            xmp = {"Type": "/Metadata", "Subtype": "/XML"}
            page["Metadata"] = add(self._pdf, compressed(mesh.metadata.xmp, xmp))
        self._pdf.add_page(page)

    def _color_space(self) -> Any:
        """The picture's own profile, or sRGB; grey without a profile is the device's."""
        own, n_components = self._mesh.metadata.icc, self._mesh.n_components
        if not fits_icc(own, n_components):
            if n_components == 1:
                return "/DeviceGray"
            own = srgb_profile()
        profile = compressed(own, {"N": min(n_components, 3)})
        return pydyf.Array(["/ICCBased", add(self._pdf, profile)])
