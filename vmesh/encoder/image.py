"""The picture as the encoder's stages take it."""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt
from scipy.ndimage import distance_transform_edt

from vmesh.arrays import Float64Array, SampleArray
from vmesh.grid import Tile
from vmesh.kernels.remeshing import WeightedImage
from vmesh.limits import MAX_SIDE

# A pixel that does not matter still counts so much of the one that matters most: what nothing
# holds to the picture could become anything.
_LEAST_WEIGHT: Final = 1 / 1024

SMALL: Final = 1 << 12
"""Pictures of fewer pixels have many meshes made and compared."""


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


def weighted(array: npt.ArrayLike, weights: npt.ArrayLike | None = None) -> WeightedImage:
    """The picture as :func:`as_image` takes it, and what a squared error in each pixel counts.

    Parameters
    ----------
    array : array_like
        Shape (h, w), (h, w, 3) or (h, w, 4), uint8 or uint16.
    weights : array_like, optional
        Shape (h, w), 0 or more, not all 0, of any scale; every pixel counts alike unless given.

    Returns
    -------
    WeightedImage
        Its weights have a mean of 1.

    Raises
    ------
    ValueError, TypeError
        If the array or the weights are not as described.
    """
    samples = with_hidden_colors_replaced(as_image(array))
    if weights is None:
        return WeightedImage(samples, np.ones(samples.shape[:2]))
    return WeightedImage(samples, _normalised(weights, samples.shape[:2]))


def is_small(image: WeightedImage) -> bool:
    """True for a picture so small that many meshes of it can be made and compared."""
    return image.weights.size < SMALL


def crop(image: WeightedImage, tile: Tile) -> WeightedImage:
    """The part of a picture that lies in a tile."""
    x, y, width, height = tile
    part = np.s_[y : y + height, x : x + width]
    return WeightedImage(*(np.ascontiguousarray(plane[part]) for plane in image))


def _normalised(weights: npt.ArrayLike, shape: tuple[int, ...]) -> Float64Array:
    """Weights with a mean of 1, none of them much smaller than the largest."""
    given = np.asarray(weights)
    if given.dtype.kind not in "buif":
        raise TypeError(f"expected weights that are real numbers, got {given.dtype}")
    if given.shape != shape:
        raise ValueError(f"expected weights of the picture's shape {shape}, got {given.shape}")
    given = given.astype(np.float64)
    largest = float(given.max())
    if not (given.min() >= 0.0 and 0.0 < largest < np.inf):
        raise ValueError("expected weights that are finite, 0 or more, and not all 0")
    if given.min() == largest:
        return np.ones(shape)
    # To single precision, in which a factor on all of them hardly ever shows.
    shares = np.maximum(given / largest, _LEAST_WEIGHT).astype(np.float32).astype(np.float64)
    result: Float64Array = shares / shares.mean()
    return result


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
