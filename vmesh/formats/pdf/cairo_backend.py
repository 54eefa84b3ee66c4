"""Mesh -> cairo: painted on any context, or on a PDF page that cairo writes."""

from __future__ import annotations

import io
from typing import Any, BinaryIO, Final

from vmesh.formats.color.conversion import mesh_in_srgb
from vmesh.formats.metadata.description import Description
from vmesh.formats.pdf.cairo_patterns import MeshPattern, import_cairo
from vmesh.formats.pdf.page_size import Page
from vmesh.formats.raster.rendering import with_alpha
from vmesh.mesh import Mesh

# One pattern holds all triangles of most meshes; cairo keeps a pattern in memory several times.
_PATTERN_TRIANGLES: Final = 100_000
_CREATION_DATE: Final = "2000-01-01T00:00:00Z"  # fixed: the same mesh gives the same bytes


def paint_mesh(mesh: Mesh, context: Any) -> None:
    """Paint a mesh on a cairo context.

    The top left corner of the canvas comes to the origin of user space, and a pixel is a unit of
    it: translate and scale the context to place the mesh. Nothing but the source of the context is
    changed. Cairo knows no profiles: colours are converted to sRGB.

    Parameters
    ----------
    mesh : Mesh
    context : cairocffi.Context
        Of a surface of any kind.

    Raises
    ------
    VmeshError
        If cairo is not installed.
    """
    mesh = mesh_in_srgb(mesh)
    colors = with_alpha(mesh.plain_colors) / 255.0
    points = mesh.points
    for first in range(0, mesh.n_triangles, _PATTERN_TRIANGLES):
        triangles = mesh.triangles[first : first + _PATTERN_TRIANGLES]
        pattern = MeshPattern()
        pattern.add_triangles(points[triangles], colors[triangles])
        pattern.paint(context)


class CairoAlbum:
    """A PDF document that cairo writes, of version 1.4.

    Parameters
    ----------
    stream : binary file
    description : Description, optional
        Of the only picture; without it the document has an outline.
    """

    def __init__(self, stream: BinaryIO, description: Description | None) -> None:
        self._cairo = import_cairo()
        self._stream = stream
        # Cairo cannot pass on an error of the stream it writes to: it gets one that has none.
        self._buffer = io.BytesIO()
        self._surface: Any = self._cairo.PDFSurface(self._buffer, 1, 1)
        self._surface.restrict_to_version(self._cairo.PDF_VERSION_1_4)
        self._surface.set_metadata(self._cairo.PDF_METADATA_CREATE_DATE, _CREATION_DATE)
        self._has_outline = description is None
        if description is not None:
            self._surface.set_metadata(self._cairo.PDF_METADATA_TITLE, description.title)
            self._surface.set_metadata(self._cairo.PDF_METADATA_AUTHOR, description.author)
        self._n_pages = 0

    def add_page(self, mesh: Mesh, page: Page, title: str) -> None:
        """Add a page, in sRGB."""
        mesh = mesh_in_srgb(mesh)
        if self._n_pages:
            self._surface.show_page()
        self._n_pages += 1
        self._surface.set_size(page.width, page.height)
        if self._has_outline:
            link = f"page={self._n_pages} pos=[0 0]"
            self._surface.add_outline(0, title, link, 0)
        context, box = self._cairo.Context(self._surface), page.picture
        context.translate(box.left, page.height - box.bottom - box.height)
        context.scale(box.width / mesh.width, box.height / mesh.height)
        if page.box is not None:
            context.rectangle(0, 0, mesh.width, mesh.height)
            context.clip()
        if mesh.n_components != 4 and mesh.covers_canvas:
            # Shows where a viewer leaves the outermost row of pixels partly uncovered.
            context.set_source_rgb(*with_alpha(mesh.plain_colors)[:, :3].mean(axis=0) / 255.0)
            context.paint()
        paint_mesh(mesh, context)

    def close(self) -> None:
        """Write the file."""
        self._surface.finish()
        self._stream.write(self._buffer.getvalue())
