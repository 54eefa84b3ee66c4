"""Metadata of a picture: ICC profile, EXIF and XMP."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Metadata:
    """Metadata that travel with a picture beside its pixels.

    Parameters
    ----------
    icc, exif, xmp : bytes
        ICC profile, EXIF block from its TIFF header on (its orientation already applied to the
        picture) and XMP packet, empty if there is none.
    unknown : tuple of (bytes, bytes)
        Tag and content of ancillary chunks that this version does not know: kept as they are.
    """

    icc: bytes = b""
    exif: bytes = b""
    xmp: bytes = b""
    unknown: tuple[tuple[bytes, bytes], ...] = ()
