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


def write_cairo_pdf(mesh: Mesh, stream: BinaryIO, page: Page) -> None:
    """Write a mesh as a PDF page of a size, through cairo, in sRGB."""
    cairocffi, mesh = import_cairo(), mesh_in_srgb(mesh)
    # Cairo cannot pass on an error of the stream it writes to: it gets one that has none.
    buffer = io.BytesIO()
    surface = cairocffi.PDFSurface(buffer, page.width, page.height)
    description = Description.of(mesh.metadata)
    surface.set_metadata(cairocffi.PDF_METADATA_CREATE_DATE, _CREATION_DATE)
    surface.set_metadata(cairocffi.PDF_METADATA_TITLE, description.title)
    surface.set_metadata(cairocffi.PDF_METADATA_AUTHOR, description.author)
    context = cairocffi.Context(surface)
    context.scale(page.width / mesh.width, page.height / mesh.height)
    if mesh.n_components != 4 and mesh.covers_canvas:
        # Shows where a viewer leaves the outermost row of pixels partly uncovered.
        context.set_source_rgb(*with_alpha(mesh.plain_colors)[:, :3].mean(axis=0) / 255.0)
        context.paint()
    paint_mesh(mesh, context)
    surface.finish()
    stream.write(buffer.getvalue())
