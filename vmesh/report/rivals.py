"""The codecs of Pillow at given sizes: the largest file of each that is no larger than asked."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final, NamedTuple

from PIL import Image

from vmesh.arrays import UInt8Array
from vmesh.errors import ImageError
from vmesh.formats.picture.conversion import flatten
from vmesh.formats.picture.picture import read_picture
from vmesh.formats.raster.rendering import LONGEST_SIDES
from vmesh.limits import MAX_SIDE, Limits
from vmesh.metrics import psnr
from vmesh.report.search import largest_within

_NO_LIMIT: Final = Limits(max_pixels=MAX_SIDE**2)  # for files that are made here


class Point(NamedTuple):
    """Bytes of a file, and the PSNR of its picture over RGB in dB."""

    n_bytes: int
    psnr: float


@dataclass(frozen=True, slots=True)
class Curve:
    """Rate-distortion curve of a codec on one picture.

    Parameters
    ----------
    codec : str
    points : tuple of Point
        From small to large.
    absence : str
        Why there are none.
    """

    codec: str
    points: tuple[Point, ...]
    absence: str = ""


@dataclass(frozen=True, slots=True)
class Rival:
    """A codec whose files grow with their quality, and what Pillow is told besides."""

    name: str
    qualities: range
    options: dict[str, Any]

    def curve_of(self, pixels: UInt8Array, budgets: Sequence[int]) -> Curve:
        """For each budget in bytes what the largest file within it gives.

        `pixels` has shape (h, w, 3), uint8. A budget that no file is within has no point.
        """
        most = LONGEST_SIDES.get(self.name.upper(), MAX_SIDE)
        if max(pixels.shape) > most:
            return Curve(self.name, (), f"holds sides of at most {most} pixels")
        if not self._is_written():
            return Curve(self.name, (), "cannot be written by this Pillow")
        files = self._largest_files(_image_of(pixels), budgets)
        points = sorted({Point(len(data), psnr(pixels, _pixels_of(data))) for data in files})
        return Curve(self.name, tuple(points), "" if points else "has no file as small as these")

    def _largest_files(self, image: Image.Image, budgets: Sequence[int]) -> set[bytes]:
        files: dict[int, bytes] = {}

        def size_of(quality: int) -> int:
            files[quality] = self._write(image, quality)
            return len(files[quality])

        found = set()
        for budget in budgets:
            known = {quality: len(data) for quality, data in files.items()}
            quality = largest_within(budget, self.qualities, size_of, known)
            if quality is not None:
                found.add(files[quality])
        return found

    def _write(self, image: Image.Image, quality: int) -> bytes:
        stream = io.BytesIO()
        image.save(stream, self.name, quality=quality, **self.options)
        return stream.getvalue()

    def _is_written(self) -> bool:
        """Support by this Pillow, which is built with a codec, without it, or with a part of it."""
        try:
            _pixels_of(self._write(Image.new("RGB", (8, 8)), self.qualities[0]))
        except (KeyError, OSError, ValueError, RuntimeError, ImageError):
            return False
        return True


# AVIF is cut in more tiles, which cost bytes, the more threads there are.
RIVALS: Final = (
    Rival("JPEG", range(1, 96), {"optimize": True, "progressive": True}),
    Rival("WebP", range(101), {"method": 6}),
    Rival("AVIF", range(101), {"speed": 6, "max_threads": 1, "advanced": {"tune": "psnr"}}),
)
DESCRIPTION: Final = (
    "JPEG optimised and progressive, WebP with method 6, AVIF with speed 6 and tuned for PSNR, "
    "all as Pillow writes them, with chroma of half the resolution"
)


def _image_of(pixels: UInt8Array) -> Image.Image:
    """An image of one component where all three are equal, for those who can tell."""
    image = Image.fromarray(pixels)
    is_grey = bool((pixels == pixels[:, :, :1]).all())
    return image.convert("L") if is_grey else image


def _pixels_of(data: bytes) -> UInt8Array:
    return flatten(read_picture(io.BytesIO(data), limits=_NO_LIMIT).array)
