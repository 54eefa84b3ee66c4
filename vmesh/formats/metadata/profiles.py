"""ICC profiles."""

from __future__ import annotations

from functools import cache

from PIL import ImageCms

_DATE = slice(24, 36)


@cache
def srgb_profile() -> bytes:
    """The profile of sRGB, without the date at which it is made."""
    made = bytearray(ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes())
    made[_DATE] = bytes.fromhex("07d0 0001 0001 0000 0000 0000")  # 1 January 2000
    return bytes(made)
