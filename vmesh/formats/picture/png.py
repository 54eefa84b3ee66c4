"""Chunks of PNG files: what Pillow cuts, mixes up or refuses is taken from them.

Texts and profiles are inflated here, within limits, and kept from Pillow, which refuses a whole
file for one of more than a mebibyte. Samples of 16 bits, of which Pillow keeps 8 in colour, come
from libpng through `imagecodecs`. Transparent levels are compared at the depth of the file, and not
after they were scaled.

References
----------
Portable Network Graphics (PNG) Specification (Third Edition), W3C Recommendation, 2025.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Final, NamedTuple

import numpy as np

from vmesh.arrays import SampleArray
from vmesh.errors import ImageError
from vmesh.formats.picture.adam7 import PASSES
from vmesh.limits import Limits

_START: Final = b"\x89PNG\r\n\x1a\n"

_XMP: Final = b"XML:com.adobe.xmp"
_RAW_PROFILES: Final = (b"Raw profile type exif", b"Raw profile type APP1")
_GREY, _RGB = 0, 2
_N_SAMPLES: Final = {_GREY: 1, _RGB: 3, 3: 1, 4: 2, 6: 4}
_DEPTHS: Final = (1, 2, 4, 8, 16)
_CRITICAL: Final = (b"IHDR", b"PLTE", b"IDAT", b"IEND")
_COLOR_SPACE: Final = b"cICP"
_OF_ANIMATIONS: Final = (b"acTL", b"fcTL", b"fdAT")
_PIECE: Final = 1 << 12  # bytes inflated at once; those before a fault are lost with it

_Chunk = tuple[bytes, bytes]


class Header(NamedTuple):
    """Header of a PNG file, chunk IHDR."""

    width: int
    height: int
    depth: int
    color_type: int
    compression: int
    filtering: int
    interlacing: int

    @property
    def n_bytes(self) -> int:
        """Bytes of the filtered samples."""
        return sum(n_rows * n_bytes for n_rows, n_bytes in self.passes())

    def passes(self) -> list[tuple[int, int]]:
        """Rows of each pass, one if it is not interlaced, with the bytes that a row takes."""
        n_bits = self.depth * _N_SAMPLES[self.color_type]
        whole = [(self.width, self.height)]
        sizes = [p.size(*whole[0]) for p in PASSES] if self.interlacing else whole
        return [
            (n_rows if n_columns else 0, 1 + (n_columns * n_bits + 7) // 8)
            for n_columns, n_rows in sizes
        ]


@dataclass(frozen=True, slots=True)
class Png:
    """Parts of a PNG file.

    Parameters
    ----------
    header : Header
    chunks : list of (bytes, bytes)
        Kinds and contents that Pillow is to see, but for the header.
    icc, xmp : bytes
        Profile and XMP, inflated.
    key : tuple of int, optional
        Grey level, or red, green and blue, at the depth of the file, that is transparent.
    is_whole : bool
        True if the file goes on to its last chunk.
    notes : tuple of str
        What was left out because it is too long.
    """

    header: Header
    chunks: list[_Chunk]
    icc: bytes = b""
    xmp: bytes = b""
    key: tuple[int, ...] | None = None
    is_whole: bool = True
    notes: tuple[str, ...] = ()

    @property
    def is_deep(self) -> bool:
        """True if Pillow would keep 8 of 16 bits."""
        return self.header.depth == 16 and self.header.color_type != _GREY

    def to_bytes(self) -> bytes:
        """The file, without texts and profile, and without its transparent colour."""
        return self._joined(self.chunks)

    def carrier(self) -> bytes:
        """A file of one pixel with the metadata of this one."""
        left_out: tuple[bytes, ...] = (b"PLTE", b"tRNS", b"IDAT", b"IEND", *_OF_ANIMATIONS)
        if any(kind == _COLOR_SPACE for kind, _ in self.chunks):  # which goes before these
            left_out += (b"gAMA", b"cHRM")
        chunks = [chunk for chunk in self.chunks if chunk[0] not in left_out]
        chunks += [(b"IDAT", zlib.compress(bytes(2))), (b"IEND", b"")]
        return replace(self, header=Header(1, 1, 8, _GREY, 0, 0, 0))._joined(chunks)

    def samples(self) -> SampleArray:
        """Samples of 16 bits, shape (h, w, c), uint16, c being 2, 3 or 4.

        A pass of an interlaced picture is filtered as a picture of its own, and read as one.
        """
        import imagecodecs

        if not self.header.interlacing:
            chunks = [chunk for chunk in self.chunks if chunk[0] in (b"IDAT", b"IEND")]
            return np.asarray(imagecodecs.png_decode(self._joined(chunks)))
        width, height = self.header[:2]
        samples = np.zeros((height, width, _N_SAMPLES[self.header.color_type]), dtype=np.uint16)
        filtered, at = self._inflated(), 0
        for place, (n_rows, n_bytes) in zip(PASSES, self.header.passes(), strict=True):
            part = filtered[at : at + n_rows * n_bytes]
            at += n_rows * n_bytes
            if part:
                n_columns = place.size(width, height)[0]
                header = self.header._replace(width=n_columns, height=n_rows, interlacing=0)
                chunks = [(b"IDAT", zlib.compress(part, 1)), (b"IEND", b"")]
                pixels = imagecodecs.png_decode(replace(self, header=header)._joined(chunks))
                samples[place.y :: place.rows, place.x :: place.columns] = pixels
        if at > len(filtered):
            raise EOFError("samples are missing")
        return samples

    def count_rows(self) -> tuple[list[int], float]:
        """Rows of each pass that are there, and the share of the samples that is, from 0 to 1."""
        n_left = n_there = len(self._inflated())
        counts = []
        for n_rows, n_bytes in self.header.passes():
            counts.append(min(n_rows, n_left // n_bytes))
            n_left -= counts[-1] * n_bytes
            if counts[-1] < n_rows:
                n_left = 0
        return counts, n_there / self.header.n_bytes if any(counts) else 0.0

    def mended(self, counts: list[int]) -> Png:
        """The still picture of a file that was cut off, after so many rows of each pass.

        The others are grey, or transparent where there is alpha.
        """
        is_grey = self.header.color_type in (_GREY, _RGB) and self.header.depth >= 8
        passes = self.header.passes()
        n_kept = sum(n * n_bytes for n, (_, n_bytes) in zip(counts, passes, strict=True))
        missing = (
            (b"\0" + (b"\x80" if is_grey else b"\0") * (n_bytes - 1)) * (n_rows - n)
            for n, (n_rows, n_bytes) in zip(counts, passes, strict=True)
        )
        filled = zlib.compress(self._inflated()[:n_kept] + b"".join(missing), 1)
        chunks = [c for c in self.chunks if c[0] not in (b"IDAT", b"IEND", *_OF_ANIMATIONS)]
        chunks += [(b"IDAT", filled), (b"IEND", b"")]
        return replace(self, chunks=chunks, is_whole=True)

    def _inflated(self) -> bytes:
        """Filtered samples, as far as they can be inflated."""
        pieces = (data for kind, data in self.chunks if kind == b"IDAT")
        return _inflate_some(pieces, self.header.n_bytes)

    def _joined(self, chunks: list[_Chunk]) -> bytes:
        header = (b"IHDR", struct.pack(">IIBBBBB", *self.header))
        return _START + b"".join(_packed(*chunk) for chunk in (header, *chunks))


def is_png(data: bytes) -> bool:
    """True of a PNG file, by its start."""
    return data.startswith(_START)


def read_png(data: bytes, limits: Limits) -> Png:
    """Parts of a PNG file.

    Raises
    ------
    ImageError
        If its header or an important chunk is damaged.
    """
    chunks, is_whole = _read_chunks(data)
    if not chunks or chunks[0][0] != b"IHDR" or len(chunks[0][1]) != 13:
        raise ImageError("the image is damaged: this PNG file has no header")
    header = Header(*struct.unpack(">IIBBBBB", chunks[0][1]))
    if header.color_type not in _N_SAMPLES or header.depth not in _DEPTHS:
        raise ImageError(
            f"the image is damaged: there are no PNG files of {header.depth} bits and "
            f"colour type {header.color_type}"
        )
    if not any(kind == b"IDAT" for kind, _ in chunks):
        raise ImageError("the image is damaged: there are no samples in this PNG file")
    kept: list[_Chunk] = []
    icc = xmp = b""
    key: tuple[int, ...] | None = None
    notes: list[str] = []
    for kind, content in chunks[1:]:
        try:
            if kind == b"iCCP":
                icc = _inflate(content.split(b"\0", 1)[1][1:], limits)
            elif kind in (b"tEXt", b"zTXt", b"iTXt"):
                name, text = _read_text(kind, content, limits)
                if name == _XMP:
                    xmp = text
                elif name in _RAW_PROFILES:
                    kept.append((b"tEXt", name + b"\0" + text))
            elif kind == b"tRNS" and header.color_type in (_GREY, _RGB):
                mask = (1 << header.depth) - 1
                n = _N_SAMPLES[header.color_type]
                key = tuple(value & mask for value in struct.unpack(f">{n}H", content[: 2 * n]))
            else:
                kept.append((kind, content))
        except _TooLongError:
            notes.append(
                f"{'its profile' if kind == b'iCCP' else 'a text'} of more than "
                f"{limits.max_metadata} bytes was left out"
            )
        except (zlib.error, struct.error, IndexError):
            continue  # a block that makes no sense is not worth the picture
    return Png(header, kept, icc, xmp, key, is_whole, tuple(notes))


class _TooLongError(Exception):
    """A text inflates to more than a limit."""


def _read_chunks(data: bytes) -> tuple[list[_Chunk], bool]:
    """Chunks of a file, the last one perhaps a part, and whether the file goes on to its end."""
    view, at, chunks = memoryview(data), len(_START), []
    while at + 8 <= len(data):
        length, kind = int.from_bytes(data[at : at + 4], "big"), data[at + 4 : at + 8]
        if not kind.isalpha():
            raise ImageError("the image is damaged: a chunk of this PNG file has no name")
        end = at + 8 + length
        content = bytes(view[at + 8 : end])
        chunks.append((kind, content))
        if end + 4 > len(data):
            return chunks, False
        if kind in _CRITICAL and zlib.crc32(content, zlib.crc32(kind)) != int.from_bytes(
            data[end : end + 4], "big"
        ):
            raise ImageError(f"the image is damaged: wrong checksum of a chunk {kind.decode()}")
        if kind == b"IEND":
            return chunks, True
        at = end + 4
    return chunks, False


def _read_text(kind: bytes, content: bytes, limits: Limits) -> tuple[bytes, bytes]:
    """Name and text of a chunk; texts that nobody asks for stay deflated."""
    name, rest = content.split(b"\0", 1)
    if name != _XMP and name not in _RAW_PROFILES:
        return name, b""
    is_deflated = kind == b"zTXt"
    if kind == b"zTXt":
        rest = rest[1:]
    elif kind == b"iTXt":
        is_deflated = rest[0] == 1
        rest = rest[2:].split(b"\0", 2)[2]  # after a language and a translated name
    if is_deflated:
        return name, _inflate(rest, limits)
    if len(rest) > limits.max_metadata:
        raise _TooLongError
    return name, rest


def _inflate(data: bytes, limits: Limits) -> bytes:
    """Inflate a stream, within the limit on metadata."""
    stream = zlib.decompressobj()
    text = stream.decompress(data, limits.max_metadata + 1)
    if len(text) > limits.max_metadata:
        raise _TooLongError
    return text


def _inflate_some(pieces: Iterable[bytes], n_wanted: int) -> bytes:
    """Inflate a stream that may be cut off as far as it goes, to so many bytes at most."""
    stream, inflated = zlib.decompressobj(), bytearray()
    for piece in pieces:
        for at in range(0, len(piece), _PIECE):
            left = piece[at : at + _PIECE]
            while left and len(inflated) < n_wanted:
                try:
                    inflated += stream.decompress(left, n_wanted - len(inflated))
                except zlib.error:
                    return bytes(inflated)
                left = stream.unconsumed_tail
    return bytes(inflated)


def _packed(kind: bytes, content: bytes) -> bytes:
    """A chunk with its length and its checksum."""
    checksum = zlib.crc32(content, zlib.crc32(kind))
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", checksum)
