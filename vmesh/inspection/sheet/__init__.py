"""Sheets: pictures, drawings and words at their places, and their writers."""

from __future__ import annotations

from typing import Final

from vmesh.formats.registry import RASTER_SUFFIXES

SHEET_SUFFIXES: Final = (*RASTER_SUFFIXES, ".svg", ".svgz", ".pdf")
"""Endings of the files that a sheet is written to."""
