"""Entries of a picture's EXIF block."""

from __future__ import annotations

from typing import Any, Final

from PIL import Image
from PIL.TiffImagePlugin import IFDRational as Rational

from vmesh.formats.metadata.directories import DETAILS, INTEROPERABILITY

__all__ = [
    "CENTIMETRE",
    "EXIF_START",
    "INCH",
    "RESOLUTION_UNIT",
    "X_RESOLUTION",
    "Y_RESOLUTION",
    "Rational",
    "names_adobe_rgb",
    "read_exif",
]

EXIF_START: Final = b"Exif\0\0"  # as Pillow and JPEG have it, and a .vmesh file does not
X_RESOLUTION: Final = 282
Y_RESOLUTION: Final = 283
RESOLUTION_UNIT: Final = 296
INCH: Final = 2  # as the unit of resolution
CENTIMETRE: Final = 3

_ADOBE_RGB: Final = "R03"  # as DCF 2.0 names it
_SPACE: Final = 1


def read_exif(block: bytes) -> dict[int, Any]:
    """Entries by tag of the first two directories of an EXIF block, none if it is damaged."""
    if not block:
        return {}
    exif = Image.Exif()
    try:
        exif.load(EXIF_START + block)
        return {**exif.get_ifd(DETAILS), **exif}
    except Exception:  # Pillow fails on blocks that make no sense with errors of any kind
        return {}


def names_adobe_rgb(image: Image.Image) -> bool:
    """True if an image's EXIF block says that its colours are in Adobe RGB.

    Cameras say so instead of embedding a profile.
    """
    try:
        return (
            str(image.getexif().get_ifd(INTEROPERABILITY).get(_SPACE, "")).strip("\0 ")
            == _ADOBE_RGB
        )
    except Exception:  # as above
        return False
