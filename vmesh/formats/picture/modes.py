"""Images of Pillow of any mode -> arrays of samples."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from PIL import Image

from vmesh.arrays import SampleArray
from vmesh.errors import ImageError
from vmesh.formats.picture.samples import from_numbers, with_key

_SIXTEEN_BIT: Final = ("I;16", "I;16L", "I;16B", "I;16N")
_OPAQUE: Final = ("RGB", "CMYK", "YCbCr", "LAB", "HSV", "RGBX", "P")
_MULTIPLIED: Final = "La"  # which Pillow converts to no other mode with colours
_BITS_PER_SAMPLE, _SAMPLE_FORMAT = 258, 339  # tags of TIFF
_UNSIGNED: Final = 1


def array_of(
    image: Image.Image, *, opened: Image.Image | None = None
) -> tuple[SampleArray, tuple[str, ...]]:
    """Pixels of an image, with notes about samples that had to be spread.

    Parameters
    ----------
    image : Image
        Of any mode.
    opened : Image, optional
        The image of a file that `image` is a copy of; it tells how integers of 32 bits are meant.

    Returns
    -------
    array : ndarray
        uint8 or uint16, shape (h, w), (h, w, 3) or (h, w, 4).
    notes : tuple of str

    Raises
    ------
    ImageError
        If pixels of its mode have no colours.
    """
    if image.mode in _SIXTEEN_BIT:
        grey = np.asarray(image).astype(np.uint16)
        key = image.info.get("transparency")
        return (with_key(grey, (key,), 16) if isinstance(key, int) else grey), ()
    if image.mode == "I":
        return _from_integers(np.asarray(image), opened or image)
    if image.mode == "F":
        return from_numbers(np.asarray(image))
    if image.mode == _MULTIPLIED:
        image = image.convert("LA")
    if image.has_transparency_data:
        return np.asarray(image.convert("RGBA")), ()
    if image.mode in ("1", "L"):
        return np.asarray(image.convert("L")), ()
    if image.mode in _OPAQUE:
        return np.asarray(image.convert("RGB")), ()
    raise ImageError(f"unsupported: pixels of Pillow's mode {image.mode}")


def _from_integers(
    values: np.ndarray[Any, Any], opened: Image.Image
) -> tuple[SampleArray, tuple[str, ...]]:
    """Grey of integers of 32 bits.

    Pillow has them for what has up to 16 bits too: such values are what they are, unless a TIFF
    says that they are of another type. Unsigned ones beyond 2**31 have wrapped around in Pillow.
    """
    tags: Any = getattr(opened, "tag_v2", {})
    n_bits = max(tags.get(_BITS_PER_SAMPLE, (16,)))
    is_unsigned = tags.get(_SAMPLE_FORMAT, (_UNSIGNED,))[0] == _UNSIGNED
    if n_bits == 32 and is_unsigned:
        values = values.astype(np.uint32)
    if n_bits <= 16 and is_unsigned and values.min() >= 0 and values.max() <= 65_535:
        return values.astype(np.uint16), ()
    if n_bits <= 16 and tags:
        values = values.astype(np.int16)
    return from_numbers(values)
