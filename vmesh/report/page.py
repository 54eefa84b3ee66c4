"""Studies -> one self-contained page: pictures to compare, plots and tables."""

from __future__ import annotations

import base64
import math
from collections.abc import Iterable
from html import escape
from string import Template
from typing import TYPE_CHECKING, Final

from vmesh.arrays import UInt8Array
from vmesh.codec.writer import dumps
from vmesh.formats.color.conversion import mesh_in_srgb
from vmesh.formats.html.document import VIEWER, fill_page
from vmesh.formats.metadata.description import Description
from vmesh.formats.metadata.privacy import stripped
from vmesh.formats.picture.conversion import resize
from vmesh.formats.raster.rendering import png_of
from vmesh.mesh import Metadata
from vmesh.report.plot import check_matplotlib, plot_curves
from vmesh.report.rivals import DESCRIPTION
from vmesh.report.tables import decibels, parts_table, sizes_table, times_table

if TYPE_CHECKING:
    from vmesh.report.study import Study

_TITLE: Final = "Photographs and their meshes"
_FRAME: Final = "border: 0; width: 100%; height: 60rem"
# Of a photograph in the page: all that two screens of 1200 pixels show, in 17 MB at the very most.
_MOST_PIXELS: Final = 1 << 22


def page_of(sections: Iterable[str]) -> bytes:
    """The page of some sections, UTF-8."""
    page = fill_page("report", title=_TITLE, rivals=DESCRIPTION, sections="\n".join(sections))
    return page.encode(errors="replace")  # names of files need not be text


def frame_of(study: Study) -> str:
    """The page on one photograph in a frame, which keeps its styles and names to itself.

    Raises
    ------
    VmeshError
        If matplotlib is not installed.
    """
    check_matplotlib()
    page = page_of([section_of(study, 0)]).decode()
    return f'<iframe srcdoc="{escape(page)}" style="{_FRAME}"></iframe>'


def section_of(study: Study, number: int) -> str:
    """Section of a page, by its number, on one photograph.

    Names and metadata are text in it and nothing else.
    """
    mesh, shown = study.mesh, _reduced(study.original)
    tables = sizes_table(study.curves), parts_table(study.figures), times_table(study.seconds)
    return Template((VIEWER / "report-section.html").read_text("utf-8")).substitute(
        name=escape(study.name),
        summary=escape(_summary(study)),
        width=mesh.width,
        height=mesh.height,
        columns=shown.shape[1],
        rows=shown.shape[0],
        original=_base64(png_of(shown)),
        data=_base64(_public_data(study)),
        plot=plot_curves(study.curves, salt=str(number)),
        tables="\n".join(tables),
        absences=escape(_absences(study)),
    )


def _public_data(study: Study) -> bytes:
    """The file as a page shows it: in sRGB, without private metadata."""
    metadata = study.mesh.metadata
    if metadata == Metadata():
        return study.data
    public = study.mesh.replaced(metadata=stripped(metadata, "private"))
    return dumps(mesh_in_srgb(public, refinement=2))


def _summary(study: Study) -> str:
    """Summary of the picture and of its mesh."""
    mesh, size, closeness = study.mesh, len(study.data), study.closeness
    about = Description.of(mesh.metadata)
    said = ", ".join(filter(None, (about.title, about.author, about.rights)))
    bits = 8 * size / (mesh.width * mesh.height)
    return (
        f"{said + '. ' if said else ''}{mesh.width} × {mesh.height} pixels; "
        f"{mesh.n_vertices:,} vertices, {mesh.n_triangles:,} triangles; "
        f"{size:,} bytes, {bits:.3f} bits per pixel; "
        f"PSNR {decibels(closeness['psnr_rgb'])} dB over RGB, SSIM {closeness['ssim']:.4f}."
    )


def _absences(study: Study) -> str:
    """Reasons why some codecs have no curve."""
    return " ".join(
        f"{curve.codec} is left out: it {curve.absence}."
        for curve in study.curves
        if not curve.points
    )


def _reduced(pixels: UInt8Array) -> UInt8Array:
    """A picture of shape (h, w, 3) with as many pixels as a page has room for."""
    height, width = pixels.shape[:2]
    factor = math.sqrt(_MOST_PIXELS / (width * height))
    if factor >= 1:
        return pixels
    return resize(pixels, (max(1, int(width * factor)), max(1, int(height * factor))))


def _base64(data: bytes) -> str:
    return base64.b64encode(data).decode()
