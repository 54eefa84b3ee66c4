"""The best picture of each codec within a budget of bytes."""

from __future__ import annotations

import io
import time
from dataclasses import dataclass

import numpy as np
from PIL import Image

from benchmarks.raster.codecs import ENCODERS
from benchmarks.raster.files import Encoder, File, Files
from vmesh.arrays import UInt8Array
from vmesh.metrics import psnr


@dataclass(frozen=True, slots=True)
class Coded:
    """A picture that came back from a file: shape (h, w, 3), uint8, and what the file took."""

    codec: str
    settings: str
    n_bytes: int
    pixels: UInt8Array
    encode_seconds: float
    decode_seconds: float


class CodecSearch:
    """Searches for the best files of a picture by each codec, at its own size and at half of it.

    Half-size files are reduced with Lanczos' filter and enlarged again with the bicubic one.

    Parameters
    ----------
    pixels : ndarray
        Shape (h, w, 3), uint8.
    """

    def __init__(self, pixels: UInt8Array) -> None:
        self._pixels = pixels
        image = Image.fromarray(pixels)
        half = ((image.width + 1) // 2, (image.height + 1) // 2)
        self._images = {"full": image, "half": image.resize(half, Image.Resampling.LANCZOS)}
        self._files: dict[tuple[str, str], list[tuple[Encoder, Files]]] = {}

    def best(self, codec: str, budget: int, size: str | None = None) -> Coded | None:
        """The best picture by PSNR (RGB) in at most `budget` bytes, None if no file is so small.

        Of both sizes unless `size`, "full" or "half", names one of them.
        """
        found = [
            self._decode(encoder, name, file)
            for name in ("full", "half")
            if size in (None, name)
            for encoder, files in self._files_of(codec, name)
            if (file := files.largest_within(budget)) is not None
        ]
        return max(found, key=lambda coded: psnr(self._pixels, coded.pixels), default=None)

    def _files_of(self, codec: str, size: str) -> list[tuple[Encoder, Files]]:
        image = self._images[size]
        if (codec, size) not in self._files:
            self._files[codec, size] = [
                (encoder, Files(encoder, image)) for encoder in ENCODERS[codec](image)
            ]
        return self._files[codec, size]

    def _decode(self, encoder: Encoder, size: str, file: File) -> Coded:
        started = time.perf_counter()
        image = _open(file.data)
        if size == "half":
            image = image.resize(self._images["full"].size, Image.Resampling.BICUBIC)
        pixels = np.asarray(image)
        seconds = time.perf_counter() - started
        settings = f"{encoder.settings} {size}".strip()
        return Coded(encoder.codec, settings, len(file.data), pixels, file.seconds, seconds)


def _open(data: bytes) -> Image.Image:
    with Image.open(io.BytesIO(data)) as image:
        return image.convert("RGB")
