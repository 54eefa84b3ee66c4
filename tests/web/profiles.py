"""ICC profiles of a matrix and curves, and of grey, made byte by byte."""

from __future__ import annotations

import struct
from collections.abc import Mapping, Sequence
from typing import Final

# Red, green and blue as XYZ of D50, adapted from D65 as their profiles have them.
SRGB: Final = (
    (0.43607, 0.22249, 0.01392),
    (0.38515, 0.71687, 0.09708),
    (0.14307, 0.06061, 0.71410),
)
DISPLAY_P3: Final = (
    (0.51512, 0.24120, -0.00105),
    (0.29198, 0.69225, 0.04189),
    (0.15710, 0.06657, 0.78407),
)
ADOBE_RGB: Final = (
    (0.60974, 0.31111, 0.01947),
    (0.20528, 0.62567, 0.06087),
    (0.14919, 0.06322, 0.74457),
)
_D50: Final = (0.9642, 1.0, 0.8249)


def fixed(*numbers: float) -> bytes:
    """Numbers with 16 bits after the point."""
    return b"".join(struct.pack(">i", round(65536 * number)) for number in numbers)


def parametric(kind: int, *parameters: float) -> bytes:
    """A curve of a formula."""
    return b"para" + bytes(4) + struct.pack(">HH", kind, 0) + fixed(*parameters)


def sampled(entries: Sequence[int]) -> bytes:
    """A curve of a table, or with one entry of an exponent in units of 1 / 256."""
    return b"curv" + bytes(4) + struct.pack(f">I{len(entries)}H", len(entries), *entries)


SRGB_CURVE: Final = parametric(3, 2.4, 1 / 1.055, 0.055 / 1.055, 1 / 12.92, 0.04045)


def profile_of(space: str, connection: str, tags: Mapping[str, bytes]) -> bytes:
    """A profile of a display with some tags beside those that each must have."""
    named = b"mluc" + bytes(4) + struct.pack(">II", 0, 12)
    white = b"XYZ " + bytes(4) + fixed(*_D50)
    all_tags = {"desc": named, "cprt": named, "wtpt": white, **tags}
    table, content = b"", b""
    start = 128 + 4 + 12 * len(all_tags)
    for name, tag in all_tags.items():
        table += name.encode() + struct.pack(">II", start + len(content), len(tag))
        content += tag + bytes(-len(tag) % 4)
    header = struct.pack(
        ">I4sI4s4s4s12s4s4sI4s4sQI12s",
        start + len(content), b"\0\0\0\0", 0x04200000, b"mntr", space.encode(), connection.encode(),
        bytes(12), b"acsp", bytes(4), 0, bytes(4), bytes(4), 0, 0, fixed(*_D50),
    )  # fmt: skip
    return header.ljust(128, b"\0") + struct.pack(">I", len(all_tags)) + table + content


def matrix_profile(
    primaries: Sequence[Sequence[float]], curve: bytes = SRGB_CURVE, **tags: bytes
) -> bytes:
    """A profile of primaries and a curve."""
    columns = zip("rgb", primaries, strict=True)
    colors = {f"{letter}XYZ": b"XYZ " + bytes(4) + fixed(*xyz) for letter, xyz in columns}
    curves = dict.fromkeys(("rTRC", "gTRC", "bTRC"), curve)
    return profile_of("RGB ", "XYZ ", {**colors, **curves, **tags})


def grey_profile(curve: bytes, connection: str = "XYZ ") -> bytes:
    """A profile of greys."""
    return profile_of("GRAY", connection, {"kTRC": curve})
