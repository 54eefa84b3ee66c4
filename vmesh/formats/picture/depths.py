"""Bits of samples that a decoder rounds away."""

from __future__ import annotations

import re
from typing import Final

from PIL import Image

from vmesh.formats.picture.jxl import depth_of_jxl

_HEADERS: Final = 1 << 16  # bytes in which a file says its depth
_DEEP_MODES: Final = ("I;16", "I;16B", "I;16L", "I;16N", "I", "F")
_MAXIMUM: Final = re.compile(rb"P[36]\s+(?:#[^\n]*\s+)*\d+\s+(?:#[^\n]*\s+)*\d+\s+(\d+)\s")


def rounding_note(data: bytes, image: Image.Image) -> tuple[str, ...]:
    """A note if samples of more than 8 bits became 8; none if not, or if nobody knows."""
    if image.mode in _DEEP_MODES:
        return ()
    read_depth = _READERS.get(image.format or "")
    n_bits = read_depth(data[:_HEADERS]) if read_depth else 8
    return (f"its samples of {n_bits} bits were rounded to 8",) if n_bits > 8 else ()


def _in_boxes(start: bytes) -> int:
    """Bits by the property ``pixi`` of HEIC and AVIF: most of what they hold has the same."""
    at = start.find(b"pixi")
    return start[at + 9] if 0 <= at < len(start) - 9 else 8


def _in_ppm(start: bytes) -> int:
    found = _MAXIMUM.match(start)
    return int(found[1][:9]).bit_length() if found else 8


_READERS: Final = {"HEIF": _in_boxes, "AVIF": _in_boxes, "JXL": depth_of_jxl, "PPM": _in_ppm}
