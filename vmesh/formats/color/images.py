"""The space that the colours of an image of Pillow belong to."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np
from PIL import Image

from vmesh.arrays import SampleArray
from vmesh.formats.color.interpretation import Interpretation, interpret, interpret_inks
from vmesh.formats.metadata.exif import names_adobe_rgb

_GREY: Final = ("1", "L", "LA", "La", "I", "F")  # and all that begin with "I;"
_DEFINED: Final = ("LAB", "HSV")  # a profile has nothing to add


def interpret_image(
    image: Image.Image, pixels: Callable[[Image.Image], SampleArray], format_name: str | None
) -> Interpretation:
    """Interpretation of an image that is loaded.

    Parameters
    ----------
    image : Image
    pixels : callable
        Gives the samples of an image of any mode but "CMYK" as an array.
    format_name : str, optional
        The format of its file: the inks of a JPEG may be stored in two ways.
    """
    profile = image.info.get("icc_profile") or b""
    if image.mode == "CMYK":
        is_bare = format_name in ("JPEG", "MPO") and "adobe" not in image.info
        return interpret_inks(np.asarray(image), profile, is_bare=is_bare)
    return interpret(
        pixels(image),
        b"" if image.mode in _DEFINED else profile,
        image.info,
        is_grey=image.mode in _GREY or image.mode.startswith("I;"),
        is_adobe_rgb=_names_adobe_rgb(image),
    )


def _names_adobe_rgb(image: Image.Image) -> bool:
    """True if the EXIF block of an image says that its colours are in Adobe RGB."""
    try:
        return names_adobe_rgb(image.getexif())
    except Exception:  # Pillow fails on blocks that make no sense with errors of any kind
        return False
