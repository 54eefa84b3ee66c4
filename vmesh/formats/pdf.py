"""Mesh -> PDF: one page of the canvas's size, the triangles as cairo mesh patterns."""

from __future__ import annotations

import io
from typing import Any, BinaryIO, Final

import numpy as np

from vmesh.formats.cairo_mesh import MeshPattern, import_cairo
from vmesh.formats.raster import with_alpha
from vmesh.limits import DEFAULT_LIMITS, Limits
from vmesh.mesh import Mesh

# One pattern holds all triangles of most meshes; cairo keeps a pattern in memory several times.
_PATTERN_TRIANGLES: Final = 100_000
_CREATION_DATE: Final = "2000-01-01T00:00:00Z"  # fixed: the same mesh gives the same bytes


def write_pdf(mesh: Mesh, stream: BinaryIO, *, limits: Limits = DEFAULT_LIMITS) -> None:
    """Write a mesh as a PDF page, a pixel of the canvas being 1/72 inch.

    Raises
    ------
    VmeshError
        If the cairo library is not installed.
    """
    limits.check_vertices(mesh.n_vertices)
    cairocffi = import_cairo()
    # Cairo cannot pass on an error of the stream it writes to: it gets one that has none.
    buffer = io.BytesIO()
    surface = cairocffi.PDFSurface(buffer, mesh.width, mesh.height)
    surface.set_metadata(cairocffi.PDF_METADATA_CREATE_DATE, _CREATION_DATE)
    context = cairocffi.Context(surface)
    if mesh.n_components != 4 and mesh.covers_canvas:
        # Shows where a viewer leaves the outermost row of pixels partly uncovered.
        context.set_source_rgb(*(mesh.plain_colors.mean(axis=0) / 255.0 * np.ones(3)))
        context.paint()
    paint_mesh(mesh, context)
    surface.finish()
    stream.write(buffer.getvalue())


def paint_mesh(mesh: Mesh, context: Any) -> None:
    """Paint a mesh on a ``cairocffi.Context``, a pixel of the canvas being a unit of user space."""
    colors = with_alpha(mesh.plain_colors) / 255.0
    points = mesh.points
    for first in range(0, mesh.n_triangles, _PATTERN_TRIANGLES):
        triangles = mesh.triangles[first : first + _PATTERN_TRIANGLES]
        pattern = MeshPattern()
        pattern.add_triangles(points[triangles], colors[triangles])
        pattern.paint(context)
