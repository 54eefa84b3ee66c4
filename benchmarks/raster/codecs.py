"""The codecs that vmesh is measured against, with the settings that are tried of each."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator
from itertools import product
from typing import Final

from PIL import Image, features

from benchmarks.raster.files import Encoder, find_level, find_request
from benchmarks.software import import_optional
from vmesh.arrays import UInt8Array

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


def _jpeg_encoders(image: Image.Image) -> Iterator[Encoder]:
    for subsampling in _SUBSAMPLINGS:

        def encode(image: Image.Image, level: int, subsampling: str = subsampling) -> bytes:
            return min(_jpegs(image, level, subsampling), key=len)

        yield Encoder(JPEG, subsampling, encode, find_level(_JPEG_LEVELS))


def _mozjpeg_encoders(image: Image.Image) -> Iterator[Encoder]:
    mozjpeg = import_optional(_MOZJPEG_MODULE)
    for subsampling in _SUBSAMPLINGS:

        def encode(image: Image.Image, level: int, subsampling: str = subsampling) -> bytes:
            plain, progressive = _jpegs(image, level, subsampling)
            rewritten: bytes = mozjpeg.optimize(progressive)
            return min(plain, progressive, rewritten, key=len)

        yield Encoder(MOZJPEG, subsampling, encode, find_level(_JPEG_LEVELS))


def _webp_encoders(image: Image.Image) -> Iterator[Encoder]:
    def encode(image: Image.Image, level: int) -> bytes:
        return _saved(image, "WEBP", quality=_webp_quality(level), method=6)

    yield Encoder(WEBP, "", encode, find_level(_WEBP_LEVELS))


def _webp_quality(level: int) -> float:
    """The quality, a float, of equal steps of the quantiser: libwebp takes a cube root of it."""
    cube = (level / _WEBP_LEVELS[-1]) ** 3
    return 100 * min(1.5 * cube, (1 + cube) / 2)


def _avif_encoders(image: Image.Image) -> Iterator[Encoder]:
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

        yield Encoder(AVIF, subsampling, encode, find_level(_AVIF_LEVELS))


def _j2k_encoders(image: Image.Image) -> Iterator[Encoder]:
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
        yield Encoder(JPEG2000, settings, encode, find_request)


ENCODERS: Final[dict[str, Callable[[Image.Image], Iterator[Encoder]]]] = {
    JPEG: _jpeg_encoders,
    MOZJPEG: _mozjpeg_encoders,
    WEBP: _webp_encoders,
    JPEG2000: _j2k_encoders,
    AVIF: _avif_encoders,
}


def _jpegs(image: Image.Image, quality: int, subsampling: str) -> list[bytes]:
    """JPEG files of an image in one scan and in many: the smallest files have one."""
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
