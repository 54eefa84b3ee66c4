"""Masks: pictures that say which parts of a photograph matter more."""

from __future__ import annotations

from typing import BinaryIO, Final

import numpy as np
from PIL import Image

from vmesh.arrays import Float64Array
from vmesh.errors import ImageError
from vmesh.formats.picture.picture import read_picture
from vmesh.limits import DEFAULT_LIMITS, Limits

# ITU-R BT.601, as Pillow turns colours to grey.
_LUMA: Final = (0.299, 0.587, 0.114)


def read_mask(
    stream: BinaryIO, width: int, height: int, *, limits: Limits = DEFAULT_LIMITS
) -> Float64Array:
    """Weights of a photograph's pixels by the picture in an open file: the whiter, the more.

    The picture is stretched over the photograph, whatever its size. Colours count as their grey,
    and what is transparent as black.

    Parameters
    ----------
    stream : binary file
    width, height : int
        Pixels of the photograph.
    limits : Limits
        Limits on the mask's own size.

    Returns
    -------
    ndarray
        Shape (h, w), float64, 0 to 1.

    Raises
    ------
    ImageError
        If the file cannot be read as a picture, or is black all over.
    LimitError
        If it has more pixels than `limits` allow.
    """
    array = read_picture(stream, limits=limits).array
    grey = array.astype(np.float64) / np.iinfo(array.dtype).max
    if grey.ndim == 3 and grey.shape[2] >= 3:
        alpha = grey[:, :, 3] if grey.shape[2] == 4 else 1.0
        grey = alpha * (grey[:, :, :3] * _LUMA).sum(axis=2)
    # Where it shrinks, Pillow's filter covers all pixels that fall into one.
    image = Image.fromarray(grey.reshape(grey.shape[:2]).astype(np.float32))
    if image.size != (width, height):
        image = image.resize((width, height), Image.Resampling.BILINEAR)
    weights: Float64Array = np.clip(np.asarray(image, dtype=np.float64), 0.0, 1.0)
    if not weights.any():
        raise ImageError("the mask is black all over: nothing would matter")
    return weights
