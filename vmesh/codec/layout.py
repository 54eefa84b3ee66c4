"""Every byte of a .vmesh file outside the coded payloads (spec, sections 3 and 4).

::

    signature   8 bytes
    chunk       tag 4 | length 4 | content, length bytes | CRC-32 of tag, length and content 4
    ...         HEAD, then metadata, VERT, TRIS if the triangles are listed, COLR, DONE

Integers are little-endian. A tag that begins with a capital letter is critical: a reader that
does not know it gives up. One that begins with a small letter is ancillary: it is kept as it is.
"""

from __future__ import annotations

import re
import struct
import zlib
from collections.abc import Iterable, Iterator
from dataclasses import astuple, dataclass
from typing import Final

from vmesh.errors import FormatError

SIGNATURE: Final = b"\x8bVMS\r\n\x1a\n"
MAJOR_VERSION: Final = 0
MINOR_VERSION: Final = 0

HEADER_TAG: Final = b"HEAD"
POSITIONS_TAG: Final = b"VERT"
TRIANGLES_TAG: Final = b"TRIS"
COLORS_TAG: Final = b"COLR"
END_TAG: Final = b"DONE"
METADATA_TAGS: Final = {"icc": b"iccp", "exif": b"exif", "xmp": b"xmpp"}

IMPLIED_TRIANGLES: Final = 0
LISTED_TRIANGLES: Final = 1

_FRAME = struct.Struct("<4sI")
_CHECKSUM = struct.Struct("<I")
_HEADER = struct.Struct("<BBHHBBIIB")
_TAG_PATTERN = re.compile(rb"[A-Za-z]{4}")
_MAX_LENGTH: Final = (1 << 31) - 1
# Each level takes a bit at least, which costs 0.0014 bits at the longest odds: 5,677 levels to a
# byte. With some margin, this refuses a small file that claims a huge mesh before it is decoded.
_LEVELS_PER_BYTE: Final = 8192
_COLOR_SLACK: Final = 16
_MAX_SUBDIVISION: Final = 8
_MAX_LATTICE_SIDE: Final = 1 << 19


@dataclass(frozen=True, slots=True)
class Chunk:
    """One chunk: its tag, its content and where it starts in the file."""

    tag: bytes
    content: bytes
    offset: int

    @property
    def is_critical(self) -> bool:
        """Whether a reader has to know this chunk."""
        return self.tag[:1].isupper()

    @property
    def content_offset(self) -> int:
        """Offset of the content's first byte in the file."""
        return self.offset + _FRAME.size

    @property
    def size(self) -> int:
        """Bytes of the whole chunk, frame included."""
        return _FRAME.size + len(self.content) + _CHECKSUM.size


@dataclass(frozen=True, slots=True)
class Header:
    """The content of HEAD, field by field; the steps of the colour components follow it."""

    major: int
    minor: int
    width: int
    height: int
    subdivision: int
    n_components: int
    n_vertices: int
    n_triangles: int
    connectivity: int
    steps: tuple[int, ...]

    @property
    def columns(self) -> int:
        """Lattice sites in a row of the canvas."""
        return (self.width << self.subdivision) + 1

    @property
    def rows(self) -> int:
        """Rows of lattice sites on the canvas."""
        return (self.height << self.subdivision) + 1

    def pack(self) -> bytes:
        """Content of the chunk HEAD."""
        *fields, steps = astuple(self)
        return _HEADER.pack(*fields) + bytes(steps)


def pack_chunk(tag: bytes, content: bytes) -> bytes:
    """Bytes of one chunk."""
    if len(content) > _MAX_LENGTH:
        raise ValueError(f"a chunk holds at most {_MAX_LENGTH} bytes, got {len(content)}")
    framed = _FRAME.pack(tag, len(content)) + content
    return framed + _CHECKSUM.pack(zlib.crc32(framed))


def pack_file(chunks: Iterable[tuple[bytes, bytes]]) -> bytes:
    """Bytes of a file of chunks given as tag and content."""
    return SIGNATURE + b"".join(pack_chunk(tag, content) for tag, content in chunks)


def check_ancillary(tag: bytes) -> None:
    """Raise :class:`ValueError` unless a tag can name an ancillary chunk that is not known."""
    if not (_TAG_PATTERN.fullmatch(tag) and tag[:1].islower()):
        raise ValueError(f"expected a tag of four letters, the first one small, got {tag!r}")
    if tag in METADATA_TAGS.values():
        raise ValueError(f"chunk {tag.decode()} is known: it cannot be kept as an unknown one")


def is_vmesh(start: bytes) -> bool:
    """Whether a file that starts with these bytes calls itself a .vmesh file."""
    return start[: len(SIGNATURE)] == SIGNATURE


def read_chunks(data: bytes) -> list[Chunk]:
    """All chunks of a file, their checksums and order verified.

    Raises
    ------
    FormatError
        With the code ``signature``, ``truncated``, ``version``, ``chunk``, ``checksum`` or
        ``trailing``.
    """
    if not is_vmesh(data):
        if SIGNATURE.startswith(data):
            raise FormatError("truncated", "the file ends within its signature", len(data))
        raise FormatError(
            "signature",
            f"expected the signature of a .vmesh file, got {data[: len(SIGNATURE)].hex(' ')!r}",
            0,
        )
    chunks: list[Chunk] = []
    for chunk in _iterate_chunks(data):
        if not chunks:
            _check_version(chunk)
        chunks.append(chunk)
    _check_order(chunks)
    return chunks


def _iterate_chunks(data: bytes) -> Iterator[Chunk]:
    """Chunks up to DONE, with nothing after it."""
    offset = len(SIGNATURE)
    tag = b""
    while tag != END_TAG:
        if len(data) - offset < _FRAME.size:
            raise FormatError("truncated", "the file ends where a chunk should begin", len(data))
        tag, length = _FRAME.unpack_from(data, offset)
        if not _TAG_PATTERN.fullmatch(tag):
            raise FormatError("chunk", f"expected a tag of four letters, got {tag!r}", offset)
        if length > _MAX_LENGTH:
            raise FormatError("chunk", f"chunk {tag.decode()} claims {length} bytes", offset)
        start = offset + _FRAME.size
        end = start + length
        if len(data) < end + _CHECKSUM.size:
            raise FormatError("truncated", f"the file ends within {tag.decode()}", len(data))
        (stored,) = _CHECKSUM.unpack_from(data, end)
        if stored != zlib.crc32(data[offset:end]):
            raise FormatError("checksum", f"chunk {tag.decode()} is damaged", offset)
        yield Chunk(tag, data[start:end], offset)
        offset = end + _CHECKSUM.size
    if offset != len(data):
        raise FormatError("trailing", f"{len(data) - offset} bytes follow the end", offset)


def _check_version(chunk: Chunk) -> None:
    """Refuse a file of a newer version by its first chunk, before anything else in it matters."""
    if chunk.tag != HEADER_TAG or len(chunk.content) < 2:
        raise FormatError("chunk", "the first chunk must be HEAD with a version", chunk.offset)
    version = (chunk.content[0], chunk.content[1])
    if version > (MAJOR_VERSION, MINOR_VERSION):
        raise FormatError(
            "version",
            f"the file is of version {version[0]}.{version[1]}, "
            f"this program reads up to {MAJOR_VERSION}.{MINOR_VERSION}",
            chunk.content_offset,
        )


def _check_order(chunks: list[Chunk]) -> None:
    """Refuse unknown critical, duplicate and misordered chunks."""
    expected = [HEADER_TAG, POSITIONS_TAG, TRIANGLES_TAG, COLORS_TAG, END_TAG]
    place = 0
    seen: set[bytes] = set()
    for chunk in chunks:
        name = chunk.tag.decode()
        if chunk.tag in METADATA_TAGS.values() and chunk.tag in seen:
            raise FormatError("chunk", f"chunk {name} appears twice", chunk.offset)
        seen.add(chunk.tag)
        if not chunk.is_critical:
            if place != 1:
                raise FormatError("chunk", f"chunk {name} must follow HEAD", chunk.offset)
            continue
        if chunk.tag not in expected:
            raise FormatError("chunk", f"critical chunk {name} is unknown", chunk.offset)
        if chunk.tag not in expected[place : place + 2] or (
            chunk.tag != expected[place] and expected[place] != TRIANGLES_TAG
        ):
            raise FormatError("chunk", f"chunk {name} is out of place", chunk.offset)
        place = expected.index(chunk.tag) + 1
    if chunks[-1].content:
        raise FormatError("chunk", "chunk DONE must be empty", chunks[-1].offset)


def read_header(chunks: list[Chunk]) -> Header:
    """The header of a file, every field within its range.

    Raises
    ------
    FormatError
        With the code ``header``.
    """
    chunk = chunks[0]
    content, offset = chunk.content, chunk.content_offset
    if len(content) < _HEADER.size:
        raise FormatError("header", "chunk HEAD is too short", offset)
    steps = tuple(content[_HEADER.size :])
    header = Header(*(*_HEADER.unpack_from(content), steps))
    for complaint in _header_complaints(header, chunks):
        raise FormatError("header", complaint, offset)
    return header


def _header_complaints(header: Header, chunks: list[Chunk]) -> Iterator[str]:
    """What is wrong with a header, in words."""
    if not (header.width and header.height):
        yield f"expected a canvas with pixels, got {header.width} x {header.height}"
    if header.subdivision > _MAX_SUBDIVISION:
        yield f"expected a subdivision of 0 to {_MAX_SUBDIVISION}, got {header.subdivision}"
    if max(header.columns, header.rows) - 1 > _MAX_LATTICE_SIDE:
        yield f"expected a canvas of at most {_MAX_LATTICE_SIDE} lattice units a side"
    if header.n_components not in (1, 3, 4):
        yield f"expected 1, 3 or 4 colour components, got {header.n_components}"
    if len(header.steps) != header.n_components or 0 in header.steps:
        yield f"expected {header.n_components} steps of 1 to 255, got {list(header.steps)}"
    if not 4 <= header.n_vertices <= header.columns * header.rows:
        yield f"expected 4 to {header.columns * header.rows} vertices, got {header.n_vertices}"
    if not 2 <= header.n_triangles <= 2 * header.n_vertices - 6:
        yield f"{header.n_vertices} vertices cannot form {header.n_triangles} triangles"
    levels = header.n_vertices * header.n_components
    room = sum(len(chunk.content) for chunk in chunks if chunk.tag == COLORS_TAG)
    if levels > _LEVELS_PER_BYTE * (room + _COLOR_SLACK):
        yield f"{room} bytes of colours cannot hold {levels} levels"
    listed = any(chunk.tag == TRIANGLES_TAG for chunk in chunks)
    if header.connectivity not in (IMPLIED_TRIANGLES, LISTED_TRIANGLES):
        yield f"connectivity {header.connectivity} is unknown"
    elif listed != (header.connectivity == LISTED_TRIANGLES):
        yield "chunk TRIS must be there if and only if the triangles are listed"
