"""Image files -> pictures: arrays with their metadata, through Pillow."""

from __future__ import annotations

import threading
import warnings
from dataclasses import dataclass
from typing import BinaryIO, Final

import numpy as np
from PIL import Image, ImageOps

from vmesh.arrays import SampleArray
from vmesh.errors import ImageError
from vmesh.formats.color.images import interpret_image
from vmesh.formats.metadata.exif import (
    EXIF_START,
    INCH,
    RESOLUTION_UNIT,
    X_RESOLUTION,
    Y_RESOLUTION,
)
from vmesh.formats.picture.options import DEFAULT_OPTIONS, PictureOptions
from vmesh.limits import DEFAULT_LIMITS, MAX_SIDE, Limits
from vmesh.mesh import Metadata

# Well-kept decoders of what people have; not those that run other programs, as for PostScript.
_FORMATS: Final = (
    *("PNG", "JPEG", "MPO", "WEBP", "AVIF", "TIFF", "GIF", "BMP", "PPM", "JPEG2000"),
    *("TGA", "ICO", "PCX", "QOI", "SGI", "DIB"),
)
_OPENING: Final = threading.Lock()  # Pillow's own limit is a global variable
# Per inch: what programs write where nobody knows. To carry it along takes 53 bytes.
_NO_DENSITIES: Final = ((72, 72), (96, 96), (0, 0))
_SIXTEEN_BIT: Final = ("I;16", "I;16L", "I;16B", "I;16N", "I")
_WITH_ALPHA: Final = ("RGBA", "LA", "La", "PA", "RGBa")
_OPAQUE: Final = ("RGB", "CMYK", "YCbCr", "LAB", "HSV", "RGBX", "P")


@dataclass(frozen=True, slots=True)
class Picture:
    """A photograph as the encoder takes it.

    Parameters
    ----------
    array : ndarray
        uint8, shape (h, w), (h, w, 3) or (h, w, 4), upright; or uint16, shape (h, w).
    metadata : Metadata
        ICC profile, EXIF without its orientation, XMP.
    notes : tuple of str
        Sentences for the user about what was left out, or had to be guessed.
    """

    array: SampleArray
    metadata: Metadata
    notes: tuple[str, ...] = ()


def read_picture(
    stream: BinaryIO,
    *,
    options: PictureOptions = DEFAULT_OPTIONS,
    limits: Limits = DEFAULT_LIMITS,
) -> Picture:
    """The photograph in an open file.

    Its EXIF orientation is applied, alpha and palettes are resolved, and of an animation the first
    frame is taken. Grey of 16 bits stays what it is; Pillow rounds colours of 16 bits to 8.

    Raises
    ------
    ImageError
        If the file is not an image that Pillow can read to its end.
    LimitError
        If it has more pixels than `limits` allow.
    """
    with warnings.catch_warnings():
        # The limits below take the place of Pillow's warning about large pictures.
        warnings.simplefilter("ignore", Image.DecompressionBombWarning)
        warnings.simplefilter("ignore", UserWarning)
        image = _open(stream)
        limits.check_pixels(*image.size)
        if not 1 <= min(image.size) <= max(image.size) <= MAX_SIDE:
            width, height = image.size
            raise ImageError(
                f"expected a picture of 1 to {MAX_SIDE} pixels a side, got {width} x {height}"
            )
        try:
            image.load()
            return picture_of(image, to_srgb=options.to_srgb)
        except MemoryError:
            raise
        except Exception as error:
            # The decoders of damaged images raise errors of many kinds.
            raise ImageError(f"the image is damaged: {error}") from None


def picture_of(image: Image.Image, *, to_srgb: bool = False) -> Picture:
    """Picture of an image of Pillow: its EXIF orientation applied, alpha and palette resolved.

    Colours are taken as `formats/color/` interprets them, and brought to sRGB if that is asked for.

    Raises
    ------
    ValueError
        If pixels of its mode have no colours, as those of "F".
    """
    upright = _upright(image)
    array = np.asarray(upright) if upright.mode == "CMYK" else _array_of(upright)
    found = interpret_image(upright, array, image.format)
    if to_srgb:
        found = found.in_srgb()
    return Picture(found.array, _metadata_of(upright, found.icc), found.notes)


def _open(stream: BinaryIO) -> Image.Image:
    """The image with its header read; its size is not limited here."""
    Image.init()
    formats: list[str] = [name for name in _FORMATS if name in Image.OPEN]
    with _OPENING:
        allowed, Image.MAX_IMAGE_PIXELS = Image.MAX_IMAGE_PIXELS, None
        try:
            return Image.open(stream, formats=formats)
        except Exception:
            # Plug-ins raise errors of many kinds on damaged headers; none of them says more.
            raise ImageError("not an image in a format that can be read") from None
        finally:
            Image.MAX_IMAGE_PIXELS = allowed


def _upright(image: Image.Image) -> Image.Image:
    """The image with its EXIF orientation applied, or as it is if its EXIF makes no sense."""
    try:
        return ImageOps.exif_transpose(image)
    except Exception:
        return image


def _array_of(image: Image.Image) -> SampleArray:
    """Pixels of an image of any mode, shape (h, w), (h, w, 3) or (h, w, 4)."""
    if image.mode in _SIXTEEN_BIT:
        return np.clip(np.asarray(image).astype(np.int64), 0, 65535).astype(np.uint16)
    if image.mode in _WITH_ALPHA or "transparency" in image.info:
        return np.asarray(image.convert("RGBA"))
    if image.mode in ("1", "L"):
        return np.asarray(image.convert("L"))
    if image.mode in _OPAQUE:
        return np.asarray(image.convert("RGB"))
    raise ValueError(f"pixels of type {image.mode} are not supported")


def _metadata_of(image: Image.Image, icc: bytes) -> Metadata:
    """Metadata of an image, with the ICC profile that its colours have now."""
    xmp = image.info.get("xmp") or b""
    return Metadata(
        icc=icc,
        exif=_exif_of(image),
        xmp=xmp.encode() if isinstance(xmp, str) else bytes(xmp),
    )


def _exif_of(image: Image.Image) -> bytes:
    """The EXIF block, with the density that PNG and JFIF have elsewhere; empty if there is none."""
    try:
        exif = image.getexif()
        density = image.info.get("dpi", _NO_DENSITIES[0])
        if X_RESOLUTION not in exif and tuple(map(round, density)) not in _NO_DENSITIES:
            exif[X_RESOLUTION], exif[Y_RESOLUTION] = (round(float(value), 2) for value in density)
            exif[RESOLUTION_UNIT] = INCH
        return exif.tobytes().removeprefix(EXIF_START) if len(exif) else b""
    except Exception:  # a block that makes no sense is not worth the picture
        return b""
