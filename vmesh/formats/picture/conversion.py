"""Pictures in another form: on white, at another size."""

from __future__ import annotations

import numpy as np
from PIL import Image

from vmesh.arrays import SampleArray, UInt8Array
from vmesh.color_lattice import rescale


def flatten(array: SampleArray, depth: int | None = None) -> UInt8Array:
    """A picture as RGB of 8 bits on white, shape (h, w, 3), uint8.

    `array` has shape (h, w) or (h, w, c) with c of 1, 3 or 4, and samples of `depth` bits: as many
    as its type holds, unless given.
    """
    array = rescale(array, depth or 8 * array.dtype.itemsize, 8)
    if array.ndim == 2:
        array = array[:, :, None]
    if array.shape[2] == 1:
        return np.repeat(array, 3, axis=2)
    if array.shape[2] == 3:
        return array
    alpha = array[:, :, 3:].astype(np.int64)
    return ((array[:, :, :3] * alpha + 255 * (255 - alpha) + 127) // 255).astype(np.uint8)


def resize(array: UInt8Array, size: tuple[int, int]) -> UInt8Array:
    """A picture of shape (h, w, 3) at another width and height, by bicubic resampling."""
    if (array.shape[1], array.shape[0]) == size:
        return array
    return np.asarray(Image.fromarray(array).resize(size, Image.Resampling.BICUBIC))
