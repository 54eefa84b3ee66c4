"""The picture as the encoder's stages take it."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.ndimage import distance_transform_edt

from vmesh.arrays import SampleArray
from vmesh.limits import MAX_SIDE


def as_image(array: npt.ArrayLike) -> SampleArray:
    """The picture as a contiguous array of shape (h, w, c), c being 1, 3 or 4."""
    given = np.asarray(array)
    if given.dtype not in (np.uint8, np.uint16):
        raise TypeError(f"expected a picture of uint8 or uint16, got {given.dtype}")
    if given.ndim == 2:
        given = given[:, :, None]
    if given.ndim != 3 or given.shape[2] not in (1, 3, 4):
        raise ValueError(
            f"expected a picture of shape (h, w), (h, w, 3) or (h, w, 4), got {given.shape}"
        )
    height, width = given.shape[:2]
    if not (1 <= width <= MAX_SIDE and 1 <= height <= MAX_SIDE):
        raise ValueError(
            f"expected a picture of 1 to {MAX_SIDE} pixels a side, got {width} x {height}"
        )
    return np.ascontiguousarray(given)


def depth_of(image: SampleArray) -> int:
    """Bits of a picture's samples."""
    return 8 * image.dtype.itemsize


def peak_of(image: SampleArray) -> int:
    """The largest sample that a picture may hold."""
    return (1 << depth_of(image)) - 1


def with_hidden_colors_replaced(image: SampleArray) -> SampleArray:
    """The picture with each fully transparent pixel in the colour of the nearest visible one.

    The hidden colours would show where the mesh's alpha reaches a little further than that of the
    picture. `image` has shape (h, w, c); only RGBA pictures change.
    """
    if image.shape[2] != 4 or image[:, :, 3].all():
        return image
    if not image[:, :, 3].any():
        return np.zeros_like(image)
    nearest = distance_transform_edt(
        image[:, :, 3] == 0, return_distances=False, return_indices=True
    )
    filled = image.copy()
    filled[:, :, :3] = image[:, :, :3][tuple(nearest)]
    return filled


def premultiplied_planes(image: SampleArray) -> SampleArray:
    """Planes of a picture, shape (c, h, w), with colours that are premultiplied by alpha."""
    # A copy in any case: the picture is the caller's, and a single pixel is contiguous either way.
    planes = np.array(image.transpose(2, 0, 1), order="C")
    if len(planes) == 4:
        peak = peak_of(image)
        alpha = planes[3].astype(np.uint32)
        planes[:3] = (planes[:3] * alpha + peak // 2) // peak
    return planes
