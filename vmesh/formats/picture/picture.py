"""Image files -> pictures: arrays with their metadata."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace
from typing import BinaryIO, Final

import numpy as np
from PIL import Image, ImageOps

from vmesh.arrays import Float64Array, SampleArray
from vmesh.errors import ImageError, LimitError
from vmesh.formats.color.images import interpret_image
from vmesh.formats.metadata.exif import (
    EXIF_START,
    INCH,
    RESOLUTION_UNIT,
    X_RESOLUTION,
    Y_RESOLUTION,
)
from vmesh.formats.picture.decoding import Decoded, decode
from vmesh.formats.picture.modes import array_of
from vmesh.formats.picture.options import DEFAULT_OPTIONS, PictureOptions
from vmesh.formats.picture.tiff import STRUCTURE
from vmesh.limits import DEFAULT_LIMITS, Limits
from vmesh.mesh import Metadata

# Per inch: what programs write where nobody knows. To carry it along takes 53 bytes.
_NO_DENSITIES: Final = ((72, 72), (96, 96), (0, 0))
_ORIENTATION: Final = 274


@dataclass(frozen=True, slots=True)
class Picture:
    """A photograph as the encoder takes it.

    Parameters
    ----------
    array : ndarray
        uint8 or uint16, shape (h, w), (h, w, 3) or (h, w, 4), upright.
    metadata : Metadata
        ICC profile, EXIF without its orientation, XMP.
    notes : tuple of str
        Sentences for the user about what was left out, or had to be guessed.
    weights : ndarray, optional
        Shape (h, w), float64: what an error in each pixel counts, where a mask says so.
    """

    array: SampleArray
    metadata: Metadata
    notes: tuple[str, ...] = ()
    weights: Float64Array | None = None


def read_picture(
    stream: BinaryIO,
    *,
    options: PictureOptions = DEFAULT_OPTIONS,
    limits: Limits = DEFAULT_LIMITS,
) -> Picture:
    """The photograph in an open file.

    Its EXIF orientation is applied, alpha and palettes are resolved; of several pages the largest
    is taken, of an animation the first frame, unless the options say another. Samples of 16 bits in
    PNG and TIFF stay what they are; those whose white is not known, as floats beyond 0 to 1, are
    spread over 16 bits from the lowest to the highest.

    Raises
    ------
    ImageError
        If the file is not an image that can be read to its end, or as far as it goes if the options
        allow that.
    LimitError
        If it has more pixels than `limits` allow.
    """
    with warnings.catch_warnings():
        # The limits take the place of Pillow's warning about large pictures.
        warnings.simplefilter("ignore", Image.DecompressionBombWarning)
        warnings.simplefilter("ignore", UserWarning)
        try:
            return _picture_of(decode(stream.read(), options, limits), options, limits)
        except (ImageError, LimitError, MemoryError):
            raise
        except Exception as error:
            # The decoders of damaged images raise errors of many kinds.
            raise ImageError(f"the image is damaged: {error}") from None


def picture_of(
    image: Image.Image, *, opened: Image.Image | None = None, to_srgb: bool = False
) -> Picture:
    """Picture of an image of Pillow: its EXIF orientation applied, alpha and palette resolved.

    Colours are taken as `formats/color/` interprets them, and brought to sRGB if that is asked for.

    Parameters
    ----------
    image : Image
        Of any mode whose pixels have colours.
    opened : Image, optional
        The image of a file that `image` is a copy of; it tells how integers of 32 bits, and inks
        of a JPEG, are meant.
    to_srgb : bool
        Whether colours are converted to sRGB.

    Raises
    ------
    ImageError
        If pixels of its mode have no colours.
    """
    upright = _upright(image)
    opened = opened or image
    if upright.mode == "CMYK":
        return _interpreted(upright, np.asarray(upright), opened.format, to_srgb=to_srgb)
    array, notes = array_of(upright, opened=opened)
    picture = _interpreted(upright, array, opened.format, to_srgb=to_srgb)
    return replace(picture, notes=notes + picture.notes)


def _interpreted(
    image: Image.Image, array: SampleArray, format_name: str | None, *, to_srgb: bool
) -> Picture:
    """Picture of samples, whose colours are what the metadata of an image say."""
    found = interpret_image(image, array, format_name)
    if to_srgb:
        found = found.in_srgb()
    return Picture(found.array, _metadata_of(image, found.icc), found.notes)


def _picture_of(decoded: Decoded, options: PictureOptions, limits: Limits) -> Picture:
    """Picture of what a file held, turned upright, with metadata within the limits."""
    image = decoded.image
    if decoded.is_upright:
        exif = image.getexif()
        exif.pop(_ORIENTATION, None)
        image.info["exif"] = exif.tobytes() if len(exif) else b""
    if decoded.samples is None:
        picture = picture_of(image, to_srgb=options.to_srgb)
    else:
        array = _turned(decoded.samples, image.getexif().get(_ORIENTATION, 1))
        picture = _interpreted(_upright(image), array, image.format, to_srgb=options.to_srgb)
    metadata, notes = _within(picture.metadata, limits)
    return Picture(picture.array, metadata, decoded.notes + picture.notes + notes)


def _turned(array: SampleArray, orientation: int) -> SampleArray:
    """Samples turned and mirrored as an EXIF orientation says."""
    if orientation in (5, 6, 7, 8):
        array = array.swapaxes(0, 1)
    if orientation in (2, 3, 6, 7):
        array = array[:, ::-1]
    if orientation in (3, 4, 7, 8):
        array = array[::-1]
    return np.ascontiguousarray(array)


def _within(metadata: Metadata, limits: Limits) -> tuple[Metadata, tuple[str, ...]]:
    """Metadata without their longest blocks where all together are over the limit."""
    blocks = [("ICC", metadata.icc), ("EXIF", metadata.exif), ("XMP", metadata.xmp)]
    blocks.sort(key=lambda block: len(block[1]))
    left_out = []
    while sum(len(content) for _, content in blocks) > limits.max_metadata:
        left_out.append(blocks.pop())
    kept = dict(blocks)
    return (
        Metadata(icc=kept.get("ICC", b""), exif=kept.get("EXIF", b""), xmp=kept.get("XMP", b"")),
        tuple(f"its {name} of {len(content)} bytes was left out" for name, content in left_out),
    )


def _upright(image: Image.Image) -> Image.Image:
    """The image with its EXIF orientation applied, or as it is if its EXIF makes no sense."""
    try:
        return ImageOps.exif_transpose(image)
    except Exception:
        return image


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
        for tag in exif.keys() & STRUCTURE:
            del exif[tag]
        density = image.info.get("dpi", _NO_DENSITIES[0])
        if X_RESOLUTION not in exif and tuple(map(round, density)) not in _NO_DENSITIES:
            exif[X_RESOLUTION], exif[Y_RESOLUTION] = (round(float(value), 2) for value in density)
            exif[RESOLUTION_UNIT] = INCH
        return exif.tobytes().removeprefix(EXIF_START) if len(exif) else b""
    except Exception:  # a block that makes no sense is not worth the picture
        return b""
