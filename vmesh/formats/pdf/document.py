"""Meshes -> PDF: a page each, with the mesh as shadings of type 4, which draw such meshes exactly.

::

    catalog -- XMP
      outline -- the pages' titles, in an album
      pages
        page -- the picture's own XMP
          content:   scale to pixels, the mesh (``mesh_content.py``)

References
----------
ISO 32000-2, 8.7.4.5.5: free-form Gouraud-shaded triangle meshes. H. Gouraud, "Continuous shading of
curved surfaces", IEEE Transactions on Computers C-20(6), 1971.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, BinaryIO, Literal, Protocol, get_args

import pydyf

from vmesh.formats.color.profiles import srgb_profile
from vmesh.formats.metadata.description import Description
from vmesh.formats.pdf.file import PdfFile
from vmesh.formats.pdf.mesh_content import MeshPainter, add, compressed, page_of
from vmesh.formats.pdf.page_size import Layout, Orientation, Page
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
    page_size: str | None = None,
    orientation: Orientation | None = None,
    margin: str | None = None,
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
    page_width, page_size, orientation, margin
        As of :class:`vmesh.formats.pdf.page_size.Layout`.
    limits : Limits
        What the mesh may ask for.

    Raises
    ------
    VmeshError
        If cairo is asked for and not installed.
    """
    if mode not in get_args(Mode):
        raise ValueError(f"expected mode to be {' or '.join(get_args(Mode))}, got {mode!r}")
    layout = Layout(page_width, page_size, orientation, margin)
    album = open_album(stream, backend, Description.of(mesh.metadata))
    limits.check_vertices(mesh.n_vertices)
    album.add_page(mesh, layout.page_of(mesh), "")
    album.close()


def write_album(
    pages: Iterable[tuple[str, Mesh]],
    stream: BinaryIO,
    *,
    backend: Backend = "native",
    layout: Layout,
    limits: Limits = DEFAULT_LIMITS,
) -> None:
    """Write meshes as the pages of a PDF document, one after another as they come.

    Parameters
    ----------
    pages : iterable of (str, Mesh)
        Titles for the outline, and meshes.
    stream : binary file
    backend : {"native", "cairo"}
    layout : Layout
    limits : Limits
        What a mesh may ask for.

    Raises
    ------
    ValueError
        If there are no pages.
    """
    album = open_album(stream, backend)
    n_pages = 0
    for title, mesh in pages:
        limits.check_vertices(mesh.n_vertices)
        album.add_page(mesh, layout.page_of(mesh), title)
        n_pages += 1
    if not n_pages:
        raise ValueError("an album has pages: expected a mesh at least")
    album.close()


class Album(Protocol):
    """A document whose pages show meshes."""

    def add_page(self, mesh: Mesh, page: Page, title: str) -> None:
        """Add a page, with a title for the outline if there is to be one."""

    def close(self) -> None:
        """Write what is left to write."""


def open_album(stream: BinaryIO, backend: Backend, description: Description | None = None) -> Album:
    """A document that a backend writes; without a description of its own it has an outline."""
    if backend not in get_args(Backend):
        raise ValueError(
            f"expected backend to be {' or '.join(get_args(Backend))}, got {backend!r}"
        )
    if backend == "cairo":
        from vmesh.formats.pdf.cairo_backend import CairoAlbum

        return CairoAlbum(stream, description)
    return _NativeAlbum(stream, description)


class _NativeAlbum:
    """A PDF document that we write."""

    def __init__(self, stream: BinaryIO, description: Description | None) -> None:
        self._pdf = PdfFile(stream)
        self._description = description
        self._profiles: dict[bytes, bytes] = {}

    def add_page(self, mesh: Mesh, page: Page, title: str) -> None:
        """Add a page, a unit of whose content is a pixel, y down."""
        unit, box = page.user_unit, page.picture
        width, height = box.width / unit, box.height / unit
        left, top = box.left / unit, box.bottom / unit + height
        content = pydyf.Stream(compress=True)
        content.set_matrix(width / mesh.width, 0, 0, -height / mesh.height, left, top)
        resources = MeshPainter(self._pdf, mesh, self._color_space(mesh)).draw(content)
        entries = page_of(self._pdf, page, content, resources)
        if mesh.metadata.xmp:
            entries["Metadata"] = self._add_xmp(mesh.metadata.xmp)
        self._pdf.add_page(entries, title)

    def close(self) -> None:
        """Write the rest of the file."""
        description = self._description or Description()
        self._pdf.catalog["Metadata"] = self._add_xmp(description.as_xmp())
        for name, text in description.as_information().items():
            self._pdf.info[name] = pydyf.String(text)
        self._pdf.close(has_outline=self._description is None)

    def _add_xmp(self, packet: bytes) -> bytes:
        """Write an XMP packet; returns a reference to it."""
        return add(self._pdf, compressed(packet, {"Type": "/Metadata", "Subtype": "/XML"}))

    def _color_space(self, mesh: Mesh) -> Any:
        """The picture's own profile, or sRGB; grey without a profile is the device's."""
        own, n_components = mesh.metadata.icc, mesh.n_components
        if not fits_icc(own, n_components):
            if n_components == 1:
                return "/DeviceGray"
            own = srgb_profile()
        if own not in self._profiles:
            profile = compressed(own, {"N": min(n_components, 3)})
            self._profiles[own] = add(self._pdf, profile)
        return pydyf.Array(["/ICCBased", self._profiles[own]])
