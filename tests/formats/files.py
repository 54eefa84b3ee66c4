"""Files of pictures as other programs write them, made in memory."""

from __future__ import annotations

import io
import struct
import zlib
from collections.abc import Iterable
from typing import Any

import numpy as np
import tifffile
from PIL import Image

from vmesh.formats.picture.options import PictureOptions
from vmesh.formats.picture.picture import Picture, read_picture
from vmesh.limits import DEFAULT_LIMITS, Limits

__all__ = ["apng", "chunk", "png", "read", "saved", "scene", "tiff"]

PNG_START = b"\x89PNG\r\n\x1a\n"


def scene(height: int = 48, width: int = 64) -> np.ndarray:
    """A picture with detail everywhere, shape (h, w, 3), uint8."""
    y, x = np.mgrid[0:height, 0:width]
    smooth = np.stack([x * 4, y * 5, (x + y) * 2], axis=2) % 200
    return (smooth + np.random.default_rng(1).integers(0, 40, smooth.shape)).astype(np.uint8)


def read(data: bytes | bytearray, limits: Limits = DEFAULT_LIMITS, **options: Any) -> Picture:
    """The picture in the bytes of a file."""
    return read_picture(io.BytesIO(data), options=PictureOptions(**options), limits=limits)


def saved(image: Image.Image | np.ndarray, format_name: str, **options: Any) -> bytes:
    """Bytes of a file as Pillow writes it."""
    stream = io.BytesIO()
    image = image if isinstance(image, Image.Image) else Image.fromarray(image)
    image.save(stream, format_name, **options)
    return stream.getvalue()


def tiff(array: np.ndarray, **options: Any) -> bytes:
    """Bytes of a TIFF as tifffile writes it."""
    stream = io.BytesIO()
    tifffile.imwrite(stream, array, metadata=None, **options)
    return stream.getvalue()


def chunk(kind: bytes, content: bytes) -> bytes:
    """A chunk of a PNG."""
    checksum = zlib.crc32(kind + content)
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", checksum)


def png(
    rows: np.ndarray,
    depth: int,
    color_type: int,
    more: Iterable[tuple[bytes, bytes]] = (),
    last: Iterable[tuple[bytes, bytes]] = (),
) -> bytes:
    """A PNG of samples, shape (h, w) or (h, w, c), with chunks before and after them."""
    height, width = rows.shape[:2]
    if depth == 16:
        packed = [row.astype(">u2").tobytes() for row in rows]
    else:
        shifts = np.arange(depth)[::-1]
        bits = (rows.reshape(height, -1)[:, :, None].astype(np.uint8) >> shifts) & 1
        packed = [np.packbits(row).tobytes() for row in bits]
    header = struct.pack(">IIBBBBB", width, height, depth, color_type, 0, 0, 0)
    filtered = zlib.compress(b"".join(b"\0" + row for row in packed))
    chunks = [(b"IHDR", header), *more, (b"IDAT", filtered), *last, (b"IEND", b"")]
    return PNG_START + b"".join(chunk(*each) for each in chunks)


def apng(still: np.ndarray, frames: list[np.ndarray], *, still_is_first: bool) -> bytes:
    """An APNG whose still picture is its first frame, or is shown where nothing moves."""
    images = [Image.fromarray(frame) for frame in frames]
    if still_is_first:
        return saved(still, "PNG", save_all=True, append_images=images)
    return saved(still, "PNG", save_all=True, default_image=True, append_images=images)
