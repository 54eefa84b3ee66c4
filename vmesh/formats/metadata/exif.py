"""Entries of a picture's EXIF block."""

from __future__ import annotations

from typing import Any, Final

from PIL import Image
from PIL.TiffImagePlugin import IFDRational as Rational

__all__ = [
    "CENTIMETRE",
    "EXIF_START",
    "INCH",
    "RESOLUTION_UNIT",
    "X_RESOLUTION",
    "Y_RESOLUTION",
    "Rational",
    "read_exif",
]

EXIF_START: Final = b"Exif\0\0"  # as Pillow and JPEG have it, and a .vmesh file does not
X_RESOLUTION: Final = 282
Y_RESOLUTION: Final = 283
RESOLUTION_UNIT: Final = 296
INCH: Final = 2  # as the unit of resolution
CENTIMETRE: Final = 3

_DETAILS: Final = 0x8769  # tag of the second directory, with the camera's entries


def read_exif(block: bytes) -> dict[int, Any]:
    """Entries by tag of the first two directories of an EXIF block, none if it is damaged."""
    if not block:
        return {}
    exif = Image.Exif()
    try:
        exif.load(EXIF_START + block)
        return {**exif.get_ifd(_DETAILS), **exif}
    except Exception:  # Pillow fails on blocks that make no sense with errors of any kind
        return {}
