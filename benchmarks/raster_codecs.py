"""The codecs that vmesh is measured against: the best picture of each within a budget of bytes."""

from __future__ import annotations

import io
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import product
from typing import Final

import numpy as np
from PIL import Image, features

from benchmarks.measurement import import_optional
from vmesh.arrays import UInt8Array
from vmesh.metrics import psnr
from vmesh.report.search import largest_within

JPEG: Final = "JPEG"
MOZJPEG: Final = "JPEG, mozjpeg"
WEBP: Final = "WebP"
JPEG2000: Final = "JPEG 2000"
AVIF: Final = "AVIF"

_MOZJPEG_MODULE: Final = "mozjpeg_lossless_optimization"
_SUBSAMPLINGS: Final = ("4:2:0", "4:4:4")
_JPEG_LEVELS: Final = range(1, 96)
_WEBP_LEVELS: Final = range(257)  # twice as many as there are quantisers
_AVIF_LEVELS: Final = range(64)  # libaom's quantisers, the finest last
# Slower ones gain about 0.1 dB, for 2 to 4 times the seconds.
_AVIF_SPEED: Final = 4
# Code blocks of the largest area: one or the other is better, by up to 0.1 dB.
_J2K_BLOCKS: Final = ((64, 64), (128, 32))
_J2K_COMMENT: Final = b"\xff\x64"
_J2K_TILE: Final = b"\xff\x90"
_J2K_TRIES: Final = 6
_J2K_SLACK: Final = 0.002  # of the budget: a file that wastes no more is good enough


@dataclass(frozen=True, slots=True)
class Coded:
    """A picture that came back from a file: shape (h, w, 3), uint8, and what the file took."""

    codec: str
    settings: str
    n_bytes: int
    pixels: UInt8Array
    encode_seconds: float
    decode_seconds: float


@dataclass(frozen=True, slots=True)
class _File:
    data: bytes
    seconds: float


@dataclass(frozen=True, slots=True)
class _Encoder:
    """One way of writing a codec's files, and how to find its largest file within a budget."""

    codec: str
    settings: str
    encode: Callable[[Image.Image, int], bytes]
    find: Callable[[_Files, int], _File | None]


class _Files:
    """Files of one image by one encoder, each written once: numbers are levels or requests."""

    def __init__(self, encoder: _Encoder, image: Image.Image) -> None:
        self.known: dict[int, _File] = {}
        self._encoder = encoder
        self._image = image

    def at(self, number: int) -> _File:
        if number not in self.known:
            started = time.perf_counter()
            data = self._encoder.encode(self._image, number)
            self.known[number] = _File(data, time.perf_counter() - started)
        return self.known[number]

    def largest_within(self, budget: int) -> _File | None:
        return self._encoder.find(self, budget)


class CodecSearch:
    """What each codec makes of one picture, at its own size and at half of it.

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
        self._files: dict[tuple[str, str], list[tuple[_Encoder, _Files]]] = {}

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

    def _files_of(self, codec: str, size: str) -> list[tuple[_Encoder, _Files]]:
        image = self._images[size]
        if (codec, size) not in self._files:
            self._files[codec, size] = [
                (encoder, _Files(encoder, image)) for encoder in _ENCODERS[codec](image)
            ]
        return self._files[codec, size]

    def _decode(self, encoder: _Encoder, size: str, file: _File) -> Coded:
        started = time.perf_counter()
        image = _open(file.data)
        if size == "half":
            image = image.resize(self._images["full"].size, Image.Resampling.BICUBIC)
        pixels = np.asarray(image)
        seconds = time.perf_counter() - started
        settings = f"{encoder.settings} {size}".strip()
        return Coded(encoder.codec, settings, len(file.data), pixels, file.seconds, seconds)


def available_codecs() -> tuple[str, ...]:
    """Names of the codecs that this machine's Pillow and packages have."""
    needed = {
        JPEG2000: features.check("jpg_2000"),
        AVIF: features.check("avif"),
        WEBP: features.check("webp"),
        JPEG: features.check("jpg"),
        MOZJPEG: import_optional(_MOZJPEG_MODULE) is not None,
    }
    return tuple(name for name, found in needed.items() if found)


def lossless_sizes(pixels: UInt8Array) -> dict[str, int]:
    """Bytes of a picture's lossless files, by codec."""
    image = Image.fromarray(pixels)
    return {
        "PNG": len(_saved(image, "PNG", optimize=True)),
        "WebP lossless": len(_saved(image, "WEBP", lossless=True, quality=100, method=6)),
    }


def describe_codecs() -> str:
    """The codecs' versions and the settings that are tried."""
    names = {"jpg": "JPEG", "webp": "WebP", "jpg_2000": "OpenJPEG", "avif": "AVIF"}
    versions = ", ".join(f"{name} {features.version(key)}" for key, name in names.items())
    turbo = features.version("libjpeg_turbo")
    return (
        f"Pillow's libraries: {versions}, libjpeg-turbo {turbo}. JPEG: optimised, progressive or "
        "not, 4:2:0 and 4:4:4; with mozjpeg's scans where that is named. WebP: method 6. "
        "JPEG 2000: irreversible, a codestream without container and comment, code blocks of "
        f"64 x 64 and 128 x 32. AVIF: libaom at speed {_AVIF_SPEED}, tuned for PSNR, 4:2:0 and "
        "4:4:4. Each at its own size and at half of it (Lanczos down, bicubic up); the better "
        "picture counts."
    )


def _find_level(levels: range) -> Callable[[_Files, int], _File | None]:
    """A search for encoders whose files grow with a level, by about the same factor each."""

    def find(files: _Files, budget: int) -> _File | None:
        known = {level: _size(file) for level, file in files.known.items()}
        level = largest_within(budget, levels, lambda level: _size(files.at(level)), known)
        return None if level is None else files.at(level)

    return find


def _find_request(files: _Files, budget: int) -> _File | None:
    """The largest file of an encoder that is asked for bytes and nearly meets the request."""
    fits = {request for request, file in files.known.items() if len(file.data) <= budget}
    best = max((files.known[request] for request in fits), key=_size, default=None)
    low = max(fits, default=0)
    high = min((request for request in files.known if request > low), default=2 * budget + 256)
    request = budget
    for _ in range(_J2K_TRIES):
        if best is not None and _size(best) >= budget * (1 - _J2K_SLACK):
            break
        if not low < request < high:
            request = (low + high) // 2
        if request in (0, low):
            break
        file = files.at(request)
        if _size(file) <= budget:
            low = request
            best = file if best is None else max(best, file, key=_size)
        else:
            high = request
        request += budget - _size(file)
    return best


def _size(file: _File) -> int:
    return len(file.data)


def _jpeg_encoders(image: Image.Image) -> Iterator[_Encoder]:
    for subsampling in _SUBSAMPLINGS:

        def encode(image: Image.Image, level: int, subsampling: str = subsampling) -> bytes:
            return min(_jpegs(image, level, subsampling), key=len)

        yield _Encoder(JPEG, subsampling, encode, _find_level(_JPEG_LEVELS))


def _mozjpeg_encoders(image: Image.Image) -> Iterator[_Encoder]:
    mozjpeg = import_optional(_MOZJPEG_MODULE)
    for subsampling in _SUBSAMPLINGS:

        def encode(image: Image.Image, level: int, subsampling: str = subsampling) -> bytes:
            plain, progressive = _jpegs(image, level, subsampling)
            rewritten: bytes = mozjpeg.optimize(progressive)
            return min(plain, progressive, rewritten, key=len)

        yield _Encoder(MOZJPEG, subsampling, encode, _find_level(_JPEG_LEVELS))


def _webp_encoders(image: Image.Image) -> Iterator[_Encoder]:
    def encode(image: Image.Image, level: int) -> bytes:
        return _saved(image, "WEBP", quality=_webp_quality(level), method=6)

    yield _Encoder(WEBP, "", encode, _find_level(_WEBP_LEVELS))


def _webp_quality(level: int) -> float:
    """The quality, a float, of equal steps of the quantiser: libwebp takes a cube root of it."""
    cube = (level / _WEBP_LEVELS[-1]) ** 3
    return 100 * min(1.5 * cube, (1 + cube) / 2)


def _avif_encoders(image: Image.Image) -> Iterator[_Encoder]:
    for subsampling in _SUBSAMPLINGS:

        def encode(image: Image.Image, level: int, subsampling: str = subsampling) -> bytes:
            return _saved(
                image,
                "AVIF",
                quality=round(level * 100 / _AVIF_LEVELS[-1]),
                speed=_AVIF_SPEED,
                subsampling=subsampling,
                max_threads=1,
                advanced={"tune": "psnr"},
            )

        yield _Encoder(AVIF, subsampling, encode, _find_level(_AVIF_LEVELS))


def _j2k_encoders(image: Image.Image) -> Iterator[_Encoder]:
    # Decompositions down to a band of 8 to 31 samples.
    most = min(image.size).bit_length() - 4
    for block, resolutions in product(_J2K_BLOCKS, (most, most - 1)):
        if resolutions < 1:
            continue

        def encode(
            image: Image.Image,
            request: int,
            block: tuple[int, int] = block,
            resolutions: int = resolutions,
        ) -> bytes:
            return _j2k(image, request, block, resolutions)

        settings = f"{block[0]} x {block[1]}, {resolutions} resolutions"
        yield _Encoder(JPEG2000, settings, encode, _find_request)


_ENCODERS: Final[dict[str, Callable[[Image.Image], Iterator[_Encoder]]]] = {
    JPEG: _jpeg_encoders,
    MOZJPEG: _mozjpeg_encoders,
    WEBP: _webp_encoders,
    JPEG2000: _j2k_encoders,
    AVIF: _avif_encoders,
}


def _jpegs(image: Image.Image, quality: int, subsampling: str) -> list[bytes]:
    """The same pixels in one scan and in many: the smallest files have one."""
    options = {"quality": quality, "subsampling": subsampling, "optimize": True}
    return [_saved(image, "JPEG", progressive=scans, **options) for scans in (False, True)]


def _j2k(image: Image.Image, request: int, block: tuple[int, int], resolutions: int) -> bytes:
    """A codestream of about `request` bytes."""
    data = _saved(
        image,
        "JPEG2000",
        quality_mode="rates",
        quality_layers=[3 * image.width * image.height / request],
        irreversible=True,
        mct=1,
        no_jp2=True,
        codeblock_size=block,
        num_resolutions=resolutions,
    )
    return _without_comments(data)


def _without_comments(data: bytes) -> bytes:
    """A JPEG 2000 codestream without the comments in its main header, which name the library."""
    kept, position = [data[:2]], 2
    while (marker := data[position : position + 2]) != _J2K_TILE:
        end = position + 2 + int.from_bytes(data[position + 2 : position + 4], "big")
        if marker != _J2K_COMMENT:
            kept.append(data[position:end])
        position = end
    return b"".join([*kept, data[position:]])


def _saved(image: Image.Image, format_name: str, **options: object) -> bytes:
    stream = io.BytesIO()
    image.save(stream, format_name, **options)
    return stream.getvalue()


def _open(data: bytes) -> Image.Image:
    with Image.open(io.BytesIO(data)) as image:
        return image.convert("RGB")
