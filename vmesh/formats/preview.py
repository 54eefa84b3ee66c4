"""Previews of a mesh that is the value of a cell, for notebooks."""

from __future__ import annotations

import io
from typing import Final

from vmesh.formats.color.conversion import mesh_in_srgb
from vmesh.formats.metadata.privacy import stripped
from vmesh.formats.raster.rendering import render, write_raster
from vmesh.formats.svg.document import write_svg
from vmesh.mesh import Mesh

_LONGEST_SIDE: Final = 1024  # pixels: more than a notebook's column is wide
_MOST_SAMPLES: Final = 4  # per pixel and direction, where the picture is made smaller
# SVG takes some 150 kB for so many, 1.3 to 2.3 times the PNG of two photographs, and Chromium 0.1 s
# to draw; with ten times as many 1.6 MB and 0.9 to 1.5 s.
_MOST_TRIANGLES: Final = 1000


def png_preview(mesh: Mesh) -> bytes:
    """The picture as PNG, at its own size or, if that is large, with sides of at most 1,024.

    Of the metadata only the profile is in it: notebooks are passed on.
    """
    shrink = max(mesh.width, mesh.height) / _LONGEST_SIDE
    scale, samples = (None, 1) if shrink <= 1 else (1 / shrink, min(_MOST_SAMPLES, int(shrink) + 1))
    stream = io.BytesIO()
    pixels = render(mesh, scale=scale, supersample=samples)
    write_raster(pixels, stream, "PNG", metadata=stripped(mesh.metadata, "all"), depth=mesh.depth)
    return stream.getvalue()


def svg_preview(mesh: Mesh) -> str | None:
    """The drawing as SVG, or none if it has too many triangles for a notebook's file."""
    if mesh.n_triangles > _MOST_TRIANGLES:
        return None
    stream = io.BytesIO()
    write_svg(mesh_in_srgb(mesh), stream)
    return stream.getvalue().decode()
