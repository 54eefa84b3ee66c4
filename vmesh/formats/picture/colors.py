"""Colours of images of Pillow -> grey, RGB or RGBA."""

from __future__ import annotations

from PIL import Image


def in_rgb(image: Image.Image) -> Image.Image:
    """An opaque image of any kind of colours, as CMYK or YCbCr, in RGB."""
    return image.convert("RGB")
