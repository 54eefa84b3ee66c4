"""Colours of PNG files that state their gamma and primaries -> sRGB, as browsers show them.

References
----------
Portable Network Graphics (PNG) Specification (Third Edition), W3C Recommendation, 2025, chunks gAMA
and cHRM.
IEC 61966-2-1:1999, Multimedia systems and equipment - Colour measurement and management - Default
RGB colour space - sRGB.
"""

from __future__ import annotations

import struct
from typing import Final

import numpy as np

from vmesh.arrays import Float64Array, SampleArray

_UNIT: Final = 100_000  # of the numbers in both chunks
_GAMMA: Final = 45_455
_TOLERANCE: Final = 500  # within which both are those of sRGB
# x and y of white, red, green and blue.
_CHROMATICITIES: Final = (31_270, 32_900, 64_000, 33_000, 30_000, 60_000, 15_000, 6_000)
# The cone responses of Bradford, by which whites are adapted.
_CONES: Final = np.array(
    [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]]
)


def in_srgb(
    samples: SampleArray, gamma: bytes, chromaticities: bytes
) -> tuple[SampleArray, tuple[str, ...]]:
    """Samples in sRGB, with a note if they had to be converted.

    Parameters
    ----------
    samples : ndarray
        uint8 or uint16, shape (h, w), (h, w, 3) or (h, w, 4).
    gamma, chromaticities : bytes
        Contents of the chunks gAMA and cHRM, empty where there are none.
    """
    exponent = int.from_bytes(gamma[:4], "big")
    if not exponent:
        return samples, ()
    matrix = None
    if samples.ndim == 3 and len(chromaticities) == 32:
        matrix = _to_srgb(struct.unpack(">8I", chromaticities))
    if matrix is None and abs(exponent - _GAMMA) <= _TOLERANCE:
        return samples, ()
    white = np.iinfo(samples.dtype).max
    linear = np.linspace(0, 1, white + 1) ** (_UNIT / exponent)
    converted = samples.copy()
    if matrix is None:
        table = np.rint(_encoded(linear) * white).astype(samples.dtype)
        colors = slice(0, 3) if samples.ndim == 3 else slice(None)
        converted[..., colors] = table[samples[..., colors]]
    else:
        for row in range(len(samples)):
            mixed = np.clip(linear[samples[row, :, :3]] @ matrix.T, 0, 1)
            converted[row, :, :3] = np.rint(_encoded(mixed) * white)
    return converted, (f"its colours of gamma {_UNIT / exponent:.2g} were converted to sRGB",)


def _encoded(linear: Float64Array) -> Float64Array:
    """Light of 0 to 1 in the tones of sRGB."""
    return np.where(
        linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055
    )


def _to_srgb(numbers: tuple[int, ...]) -> Float64Array | None:
    """Matrix from primaries to those of sRGB, None if they are the same or make no sense."""
    if all(
        abs(a - b) <= _TOLERANCE for a, b in zip(numbers, _CHROMATICITIES, strict=True)
    ) or not all(numbers[1::2]):
        return None
    try:
        source, white = _to_xyz(numbers)
        target, srgb_white = _to_xyz(_CHROMATICITIES)
        scale = (_CONES @ srgb_white) / (_CONES @ white)
        adapted = np.linalg.inv(_CONES) @ np.diag(scale) @ _CONES @ source
        matrix: Float64Array = np.linalg.inv(target) @ adapted
    except np.linalg.LinAlgError:
        return None
    return matrix if np.isfinite(matrix).all() else None


def _to_xyz(numbers: tuple[int, ...]) -> tuple[Float64Array, Float64Array]:
    """Matrix from primaries to XYZ, and the XYZ of white."""
    points = [
        np.array([x / y, 1.0, (_UNIT - x - y) / y])
        for x, y in zip(numbers[::2], numbers[1::2], strict=True)
    ]
    white, primaries = points[0], np.array(points[1:]).T
    return primaries * np.linalg.solve(primaries, white), white
