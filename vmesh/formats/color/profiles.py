"""ICC profiles: the space they are for, and those that are made here."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Final

from PIL import ImageCms

GREY: Final = b"GRAY"
RGB: Final = b"RGB "
CMYK: Final = b"CMYK"

_DATE: Final = slice(24, 36)
_FIRST_OF_2000: Final = bytes.fromhex("07d0 0001 0001 0000 0000 0000")
_D65: Final = (0.3127, 0.3290, 1.0)


@cache
def srgb_profile() -> bytes:
    """The profile of sRGB, without the date at which it is made."""
    return _dated(ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes())


def grey_profile(gamma: float) -> bytes:
    """A profile of grey whose light is the power `gamma` of its samples."""
    from imagecodecs import cms_profile

    return _dated(cms_profile("gray", whitepoint=_D65, gamma=gamma))


def rgb_profile(places: Sequence[float], gamma: float) -> bytes:
    """A profile of RGB whose light is a power of its samples; empty if there is no such space.

    `places` are the chromaticities x and y of white, red, green and blue, eight numbers.
    """
    from imagecodecs import CmsError, cms_profile

    colors = [value for i in (2, 4, 6) for value in (*places[i : i + 2], 1.0)]
    try:
        made = cms_profile("rgb", whitepoint=(*places[:2], 1.0), primaries=colors, gamma=gamma)
    except (CmsError, ValueError):
        return b""
    return _dated(made)


def space_of(profile: bytes) -> bytes:
    """Signature of the space that a profile is for, such as ``b"RGB "``; empty if it is none."""
    return profile[16:20] if profile[36:40] == b"acsp" else b""


def _dated(profile: bytes) -> bytes:
    """A profile without the date at which it was made: the same always."""
    return profile[: _DATE.start] + _FIRST_OF_2000 + profile[_DATE.stop :]
