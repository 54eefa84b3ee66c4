"""ICC profiles of spaces that are not sRGB, and what littleCMS makes of their colours."""

from __future__ import annotations

import io
import struct
from typing import Final

import imagecodecs
import numpy as np
from PIL import Image, ImageCms

from vmesh.arrays import UInt8Array

_D65: Final = (0.3127, 0.3290, 1.0)
_D50: Final = (0.9642, 1.0, 0.8249)
# Lab of the solids and overprints of cyan, magenta and yellow on coated paper, about.
_INKS: Final = (
    ((95, 0, -2), (89, -5, 93), (48, 74, -3), (47, 68, 48)),
    ((55, -37, -50), (50, -65, 27), (24, 22, -46), (23, 0, 0)),
)


def wide_profile(gamma: float = 2.2) -> bytes:
    """RGB with the primaries of Display P3."""
    primaries = (0.680, 0.320, 1.0, 0.265, 0.690, 1.0, 0.150, 0.060, 1.0)
    return imagecodecs.cms_profile("rgb", whitepoint=_D65, primaries=primaries, gamma=gamma)


def grey_profile(gamma: float = 1.8) -> bytes:
    """Grey whose tones are not those of sRGB."""
    return imagecodecs.cms_profile("gray", whitepoint=_D65, gamma=gamma)


def press_profile(name: str = "Press") -> bytes:
    """CMYK with two grid points for each ink."""
    grid = bytearray()
    for cyan in _INKS:
        for lightness, a, b in cyan:
            for black in (1.0, 0.13):
                tint = black if black == 1 else 0.1
                grid += bytes(
                    (round(2.55 * lightness * black), round(a * tint) + 128, round(b * tint) + 128)
                )
    identity = struct.pack(">9i", *np.ravel(np.eye(3, dtype=int) << 16))
    ramp = bytes(range(256))
    table = b"mft1\0\0\0\0" + bytes((4, 3, 2, 0)) + identity + 4 * ramp + bytes(grid) + 3 * ramp
    white = b"XYZ \0\0\0\0" + struct.pack(">3i", *(round(65536 * value) for value in _D50))
    text = name.encode("ascii") + b"\0"
    description = b"desc\0\0\0\0" + struct.pack(">I", len(text)) + text + bytes(78)
    return _profile(b"prtr", b"CMYK", b"Lab ", desc=description, wtpt=white, A2B0=table)


def _profile(kind: bytes, space: bytes, connection: bytes, **tags: bytes) -> bytes:
    """A profile of version 2.4 with these tags."""
    start, rows, data = 132 + 12 * len(tags), b"", b""
    for name, body in tags.items():
        rows += struct.pack(">4sII", name.encode("ascii"), start + len(data), len(body))
        data += body + bytes(-len(body) % 4)
    head = struct.pack(">I4sI", start + len(data), b"none", 0x02400000) + kind + space + connection
    head += struct.pack(">6H", 2000, 1, 1, 0, 0, 0) + b"acsp" + bytes(28)
    head += struct.pack(">3i", *(round(65536 * value) for value in _D50))
    return head.ljust(128, b"\0") + struct.pack(">I", len(tags)) + rows + data


def managed(image: Image.Image, profile: bytes) -> UInt8Array:
    """RGB of what a colour-managed viewer shows of an image."""
    shown = ImageCms.profileToProfile(
        image, io.BytesIO(profile), ImageCms.createProfile("sRGB"), outputMode="RGB"
    )
    assert shown is not None
    return np.asarray(shown)
