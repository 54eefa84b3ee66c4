"""Pictures in files that were cut off: what is there of them, and how much that is.

A file is read as far as it goes, and once more with noise in place of what is missing. What both
readings agree on is there; the rest depends on bytes that nobody has.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Final

import numpy as np
from PIL import Image, ImageFile

from vmesh.arrays import BoolArray
from vmesh.formats.picture.jpeg import has_all_scans, has_first_scan, is_jpeg

_READING: Final = threading.Lock()  # Pillow's tolerance is a global variable
_MOST_MISSING: Final = 1 << 26  # that a header makes us believe in
_SLACK: Final = 1 << 16
_MOST_BYTES: Final = 4  # of a pixel, in whatever format
_N_NOISES: Final = 2
_GREYS: Final = {"L": 128, "RGB": 128, "I": 32_768, "I;16": 32_768, "F": 0.5}

Decode = Callable[[bytes], Image.Image]


@dataclass(frozen=True, slots=True)
class Partial:
    """Part of a picture.

    Parameters
    ----------
    image : Image
        With the missing pixels in grey, or transparent where there is alpha.
    share : float or None
        Of the pixels, from 0 to 1, that is there; None if nobody knows.
    is_coarse : bool
        True if all of it is there, but not with all of its detail.
    """

    image: Image.Image
    share: float | None
    is_coarse: bool = False


def how_much(share: float | None, *, is_coarse: bool = False) -> str:
    """Words for a share of a picture."""
    if is_coarse:
        return "all of its picture is there, but without its finest detail"
    if share is None:
        return "a part of its picture is there"
    percent = round(100 * share)
    if 0 < share < 1:
        percent = min(99, max(1, percent))
    return f"about {percent} % of its picture is there"


NOTHING: Final = "the file is cut off: nothing of its picture is there"


def refusal(share: float | None, *, is_coarse: bool = False) -> str:
    """Words that refuse a file that was cut off."""
    if share == 0:
        return NOTHING
    return (
        f"the file is cut off: {how_much(share, is_coarse=is_coarse)}; "
        "--allow-truncated reads it as it is"
    )


def note(share: float | None, *, is_coarse: bool = False) -> str:
    """Words about a picture that was read although its file is cut off."""
    if share == 1 and not is_coarse:
        return "the end of the file is missing, but nothing of its picture is"
    return f"the file is cut off: {how_much(share, is_coarse=is_coarse)}"


def read_partly(data: bytes, decode: Decode) -> Partial | None:
    """Part of a picture that a file holds, None if its decoder makes nothing of a part.

    Parameters
    ----------
    data : bytes
    decode : callable
        Opens and loads an image.
    """
    if is_jpeg(data):
        data = data.rstrip(b"\xff")  # half a marker
    with _tolerance():
        try:
            image = decode(data)
        except MemoryError:
            raise
        except Exception:
            image = None
        if image is None:
            n_missing = _n_missing(data)
            if not n_missing:
                return None
            try:
                image = decode(data + bytes(n_missing))
            except MemoryError:
                raise
            except Exception:  # of whatever kind: it needs all of the file
                return None
        is_there, n_read = _agreement(data, image, decode)
    if is_jpeg(data):
        # libjpeg fills up by itself, and what is refined halfway is there all the same.
        share = float(is_there.all(axis=1).mean())
        if share == 1:
            return Partial(image, 1.0, is_coarse=not has_all_scans(data))
        return Partial(image, share, is_coarse=has_first_scan(data))
    if not is_there.all():
        return Partial(_greyed(image, ~is_there), float(is_there.mean()))
    if _n_missing(data):
        return Partial(image, 1.0 if n_read else None)
    # Noise that changes nothing was not read: the decoder stopped before, or read nothing at all.
    low, high = image.convert("L").getextrema()
    return Partial(image, 0.0 if low == high else None)


def ends_early(error: Exception) -> bool:
    """True of errors by which Pillow's decoders say that a file ends too early."""
    return isinstance(error, EOFError) or "truncated" in str(error).lower()


def is_cut_in_riff(data: bytes) -> bool:
    """True if a RIFF file, as WebP is, ends before its own header says."""
    return _n_missing(data) > 0


def is_cut_in_boxes(data: bytes) -> bool:
    """True if a file of boxes, as HEIC, AVIF and JPEG 2000 are, ends within one."""
    if data[4:8] not in (b"ftyp", b"jP  ", b"JXL "):
        return False
    at = 0
    while at + 8 <= len(data):
        length = int.from_bytes(data[at : at + 4], "big")
        if length == 1:
            length = int.from_bytes(data[at + 8 : at + 16], "big")
        if length == 0:
            return False
        at += max(8, length)
    return at != len(data)


@contextmanager
def _tolerance() -> Iterator[None]:
    """Let Pillow's decoders stop where a file ends."""
    with _READING:
        before = ImageFile.LOAD_TRUNCATED_IMAGES
        ImageFile.LOAD_TRUNCATED_IMAGES = True
        try:
            yield
        finally:
            ImageFile.LOAD_TRUNCATED_IMAGES = before


def _agreement(data: bytes, image: Image.Image, decode: Decode) -> tuple[BoolArray, int]:
    """Pixels that stay the same if noise follows the data, shape (h, w), and how often it was read.

    Decoders that noise brings to a stop leave the rest as it was: it is missing too.
    """
    n_bytes = 1 if is_jpeg(data) else _MOST_BYTES
    n_noise = max(_n_missing(data), n_bytes * image.width * image.height + _SLACK)
    pixels = np.asarray(image)
    is_there = np.ones(pixels.shape[:2], dtype=bool)
    n_read = 0
    for seed in range(_N_NOISES):
        # Without 255, which begins the markers of JPEG.
        noise = np.random.default_rng(seed).integers(1, 255, n_noise, dtype=np.uint8)
        try:
            other = decode(data + noise.tobytes())
        except MemoryError:
            raise
        except Exception:  # of whatever kind: this noise says nothing
            continue
        if other.size == image.size and other.mode == image.mode:
            is_equal = pixels == np.asarray(other)
            is_there &= is_equal if is_equal.ndim == 2 else is_equal.all(axis=2)
            n_read += 1
    rows = np.flatnonzero(~is_there.all(axis=1))
    if len(rows):
        first, last = rows[0], rows[-1]
        if is_jpeg(data) or (last + 1 < len(pixels) and not pixels[last + 1 :].any()):
            is_there[first + 1 :] = False
        elif first > 0 and not pixels[:first].any():  # from the bottom up
            is_there[:last] = False
    return is_there, n_read


def _greyed(image: Image.Image, is_missing: BoolArray) -> Image.Image:
    """An image with some pixels in grey, or transparent where there is alpha.

    Rows missing between others, as of an interlaced GIF, are as the one above.
    """
    info = image.info
    if image.mode not in _GREYS and image.mode != "RGBA":
        image = image.convert("RGBA" if image.has_transparency_data else "RGB")
    pixels = np.array(image)
    pixels[is_missing] = _GREYS.get(image.mode, 0)
    there = np.flatnonzero(~is_missing.any(axis=1))
    if len(there):
        between = np.arange(there[0], there[-1] + 1)
        pixels[between] = pixels[there[np.searchsorted(there, between, side="right") - 1]]
    greyed = Image.fromarray(pixels)
    greyed.info = info
    return greyed


def _n_missing(data: bytes) -> int:
    """Bytes that a RIFF file lacks by its own header; none of other files."""
    if data[:4] != b"RIFF":
        return 0
    return min(_MOST_MISSING, max(0, int.from_bytes(data[4:8], "little") + 8 - len(data)))
