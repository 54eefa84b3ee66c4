"""Heat maps: how far two pictures are apart at each pixel, in colours of even steps.

The colours are those of *magma*, by Nathaniel Smith and Stéfan van der Walt for matplotlib (2015,
CC0): equal steps look equal, and lightness alone tells the order, so that the map reads the same
with any colour vision and in grey print.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from vmesh.arrays import Float64Array, UInt8Array

# Every tenth of the scale; straight lines between them stay within 4 levels of its 256 colours.
_ANCHORS: Final = np.array(
    [
        (0x00, 0x00, 0x04),
        (0x15, 0x0E, 0x38),
        (0x3B, 0x0F, 0x70),
        (0x64, 0x1A, 0x80),
        (0x8C, 0x29, 0x81),
        (0xB7, 0x37, 0x79),
        (0xDE, 0x49, 0x68),
        (0xF6, 0x6E, 0x5C),
        (0xFE, 0x9F, 0x6D),
        (0xFE, 0xCF, 0x92),
        (0xFC, 0xFD, 0xBF),
    ]
)
_SHARE_BELOW: Final = 99.0  # per cent of the pixels that the scale tells apart
_LEAST_TOP: Final = 4
_LARGEST_TOP: Final = 256


def heat_colors(values: Float64Array) -> UInt8Array:
    """Colours of values of any shape s, shape (\\*s, 3): 0 is black, 1 and more near white."""
    places = np.linspace(0.0, 1.0, len(_ANCHORS))
    channels = [np.interp(values, places, _ANCHORS[:, i]) for i in range(3)]
    colors: UInt8Array = np.rint(np.stack(channels, axis=-1)).astype(np.uint8)
    return colors


def error_levels(first: UInt8Array, second: UInt8Array) -> Float64Array:
    """Root mean square over the channels of the difference of two pictures, (h, w), in levels.

    The pictures have shape (h, w, 3). PSNR is computed from the mean of the same squares.
    """
    difference = first.astype(np.float64) - second
    levels: Float64Array = np.sqrt(np.mean(difference * difference, axis=2))
    return levels


def scale_top(levels: Float64Array) -> int:
    """Levels at the top of a scale: the power of two, 4 to 256, that 99 % of pixels do not exceed.

    Sheets of similar pictures then have the same scale, and can be compared.
    """
    high = float(np.percentile(levels, _SHARE_BELOW))
    top = _LEAST_TOP
    while top < min(high, _LARGEST_TOP):
        top *= 2
    return top
