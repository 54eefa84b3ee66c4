"""Sheet -> file, by the ending of its name."""

from __future__ import annotations

from typing import BinaryIO

from vmesh.formats.registry import FORMATS
from vmesh.inspection.sheet.items import Sheet
from vmesh.inspection.sheet.pdf import write_sheet_pdf
from vmesh.inspection.sheet.raster import draw_sheet
from vmesh.inspection.sheet.svg import write_sheet_svg, write_sheet_svgz
from vmesh.limits import DEFAULT_LIMITS, Limits

_VECTOR_WRITERS = {
    ".svg": write_sheet_svg,
    ".svgz": write_sheet_svgz,
    ".pdf": write_sheet_pdf,
}


def write_sheet(
    sheet: Sheet, stream: BinaryIO, suffix: str, *, limits: Limits = DEFAULT_LIMITS
) -> None:
    """Write a sheet into an open file, in the format of a suffix of `SHEET_SUFFIXES`."""
    if suffix in _VECTOR_WRITERS:
        _VECTOR_WRITERS[suffix](sheet, stream)
    else:
        raster = FORMATS[suffix]
        raster.writer()(draw_sheet(sheet, limits=limits), stream, raster.name)
