"""The space that the colours of an image of Pillow belong to."""

from __future__ import annotations

from typing import Final

from PIL import Image

from vmesh.arrays import SampleArray
from vmesh.formats.color.interpretation import Interpretation, interpret, interpret_inks
from vmesh.formats.metadata.exif import names_adobe_rgb

_DEFINED: Final = ("LAB", "HSV")  # a profile has nothing to add


def interpret_image(
    image: Image.Image, array: SampleArray, format_name: str | None = None
) -> Interpretation:
    """Interpretation of an image by its profile, or by what else is known of it.

    Parameters
    ----------
    image : Image
        Its mode and its metadata are used.
    array : ndarray
        uint8 or uint16: its samples, shape (h, w), (h, w, 3) or (h, w, 4); of an image of mode
        "CMYK" the inks, shape (h, w, 4).
    format_name : str, optional
        Format of its file: the inks of a JPEG may be stored in two ways.
    """
    profile = image.info.get("icc_profile") or b""
    if image.mode == "CMYK":
        is_bare = format_name in ("JPEG", "MPO") and "adobe" not in image.info
        return interpret_inks(array, profile, is_bare=is_bare)
    return interpret(
        array,
        b"" if image.mode in _DEFINED else profile,
        image.info,
        is_adobe_rgb=names_adobe_rgb(image),
    )
