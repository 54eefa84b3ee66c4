"""Openers of Pillow for a file: ours, those of plug-ins, and those of an application."""

from __future__ import annotations

import importlib
import io
import threading
from collections.abc import Callable
from typing import Final, NamedTuple

from PIL import Image, UnidentifiedImageError

from vmesh.errors import ImageError
from vmesh.formats.picture.jxl import size_of_jxl
from vmesh.formats.picture.recognition import describe_foreign, is_avif, is_heif, is_jxl
from vmesh.limits import MAX_SIDE, Limits

# Well-kept decoders of what people have; not those that run other programs, as for PostScript.
_FORMATS: Final = (
    *("PNG", "JPEG", "MPO", "WEBP", "AVIF", "TIFF", "GIF", "BMP", "PPM", "JPEG2000"),
    *("TGA", "ICO", "PCX", "QOI", "SGI", "DIB"),
)
_OWN: Final = ("PIL.", "vmesh.")  # modules of openers that nobody else registered
_OPENING: Final = threading.Lock()  # Pillow's own limit is a global variable


class DamagedError(ImageError):
    """A file starts as one of a format that is read, and makes no sense."""


class _Plugin(NamedTuple):
    """A format that another package teaches Pillow to read."""

    accepts: Callable[[bytes], bool]
    opener: str
    module: str
    name: str
    extra: str


_PLUGINS: Final = (
    _Plugin(is_heif, "HEIF", "pillow_heif", "HEIC", "heif"),
    _Plugin(is_jxl, "JXL", "pillow_jxl", "JPEG XL", "jxl"),
)


def open_image(data: bytes, limits: Limits) -> Image.Image:
    """An image with its header read.

    Its size is not limited here but for JPEG XL, whose plug-in decodes as it opens.

    Raises
    ------
    ImageError
        If its format is none that can be read, or its header is damaged.
    LimitError
    """
    _load_plugin(data)
    if is_jxl(data):
        check_size(size_of_jxl(data), limits)
    if is_avif(data) and "AVIF" not in _formats():
        raise ImageError("this is an AVIF file; to read it, install a newer Pillow")
    with _OPENING:
        allowed, Image.MAX_IMAGE_PIXELS = Image.MAX_IMAGE_PIXELS, None
        try:
            return Image.open(io.BytesIO(data), formats=_formats())
        except MemoryError:
            raise
        except Exception as error:
            # Openers raise errors of many kinds on damaged headers.
            raise _refusal(data, error) from None
        finally:
            Image.MAX_IMAGE_PIXELS = allowed


def check_size(size: tuple[int, int], limits: Limits) -> None:
    """Refuse a picture of too many pixels, too long a side, or none.

    Raises
    ------
    ImageError, LimitError
    """
    limits.check_pixels(*size)
    if not 1 <= min(size) <= max(size) <= MAX_SIDE:
        width, height = size
        raise ImageError(
            f"expected a picture of 1 to {MAX_SIDE} pixels a side, got {width} x {height}"
        )


def _load_plugin(data: bytes) -> None:
    """Import the package that reads a format which Pillow by itself does not."""
    for plugin in _PLUGINS:
        if not plugin.accepts(data) or plugin.opener in Image.OPEN:
            continue
        try:
            module = importlib.import_module(plugin.module)
        except ImportError:
            raise ImageError(
                f"this is a {plugin.name} file; to read it, install its plug-in: "
                f"pip install 'vmesh[{plugin.extra}]'"
            ) from None
        # One of the two registers itself as it is imported.
        if plugin.opener not in Image.OPEN:
            module.register_heif_opener()


def _formats() -> list[str]:
    """Names of the openers that may be used: ours, and all that an application registered."""
    Image.init()
    registered = [
        name
        for name, (factory, _) in Image.OPEN.items()
        if not getattr(factory, "__module__", "").startswith(_OWN)
    ]
    return [*(name for name in _FORMATS if name in Image.OPEN), *registered]


def _refusal(data: bytes, error: Exception) -> ImageError:
    """The error about a file that no opener takes."""
    known = [name for name in _formats() if _has_signature(name, data)]
    if known:
        reason = "it makes no sense" if isinstance(error, UnidentifiedImageError) else error
        return DamagedError(f"the image is damaged: as a {known[0]} file, {reason}")
    if b"PNG" in data[:8]:
        return ImageError(
            "the image is damaged: the start of this PNG file was changed, as by a transfer as text"
        )
    foreign = describe_foreign(data)
    return ImageError(
        f"this is {foreign}" if foreign else "not an image in a format that can be read"
    )


def _has_signature(name: str, data: bytes) -> bool:
    """True if a file starts as those of a format do."""
    accepts = Image.OPEN[name][1]
    try:
        return accepts is not None and accepts(data[:16]) is True
    except Exception:  # of very short files
        return False
