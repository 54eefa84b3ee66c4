"""Every byte of a .vmesh file outside the coded mesh (spec, sections 3 and 4).

::

    signature   5 bytes
    header      version 1 | format 1 | depth 1, if not 8 | width, height, number of vertices,
                steps of the components, varints of 1 to 5 | CRC-32 of signature and header 4
    chunk       tag 1 | length, a varint | content, length bytes | CRC-32 of all that 4
    ...         metadata, then the mesh, with which the file ends: M, or G and a T for each tile

    format      bits 0-1  components - 1, or 1: in the next byte
                bits 2-5  subdivision        bits 6-7  connectivity
    depth       bits 0-1  components - 1     bits 2-5  depth - 8       bits 6-7  0

A tag is a letter. A capital one is critical: a reader that does not know it gives up. A small one
is ancillary: it is kept as it is.
"""

from __future__ import annotations

import re
import struct
import zlib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Final

from vmesh.codec.policy import Policy
from vmesh.errors import FormatError
from vmesh.limits import (
    MAX_DEPTH,
    MAX_LATTICE_SIDE,
    MAX_SIDE,
    MAX_SUBDIVISION,
    PLAIN_DEPTH,
)

FILE_SUFFIX: Final = ".vmesh"
SIGNATURE: Final = b"\x8bVM\r\n"
VERSION: Final = (1, 1)
"""The latest version. A file that uses nothing of it is of version 1.0."""

MESH_TAG: Final = b"M"
GRID_TAG: Final = b"G"
TILE_TAG: Final = b"T"
METADATA_TAGS: Final = {"icc": b"i", "exif": b"e", "xmp": b"x"}

IMPLIED_TRIANGLES: Final = 0
LISTED_TRIANGLES: Final = 1
FLIPPED_TRIANGLES: Final = 2

COMPONENT_NAMES: Final = {1: "grey", 3: "RGB", 4: "RGBA"}
CONNECTIVITY_NAMES: Final = {
    IMPLIED_TRIANGLES: "implied",
    LISTED_TRIANGLES: "listed",
    FLIPPED_TRIANGLES: "flipped",
}
CHUNK_NAMES: Final = {
    MESH_TAG: "mesh",
    GRID_TAG: "grid",
    TILE_TAG: "tile",
    **{tag: name for name, tag in METADATA_TAGS.items()},
}

_DEEP: Final = 1  # in place of the components: they follow, with the depth
_CHECKSUM = struct.Struct("<I")
_TAG_PATTERN = re.compile(rb"[A-Za-z]")
_MAX_VARINT: Final = (1 << 31) - 1
# A level takes a bit at least, and a bit that was most probable 0.0014 bits of the stream: 5,678 to
# a byte. What the stream holds at its end is at most a byte more than its bytes. So this refuses a
# small file that claims a huge mesh before it is decoded, and never one that could be.
_LEVELS_PER_BYTE: Final = 5_700


@dataclass(frozen=True, slots=True)
class Chunk:
    """One chunk: its tag, its content, and where it and its content start in the file.

    The content is shorter than `length` if the file ends within it.
    """

    tag: bytes
    length: int
    content: bytes
    offset: int
    content_offset: int

    @property
    def name(self) -> str:
        """Name in messages."""
        return f"chunk {self.tag.decode()}"

    @property
    def content_end(self) -> int:
        """Offset of its checksum."""
        return self.content_offset + self.length

    @property
    def end(self) -> int:
        """Offset of what follows it."""
        return self.content_end + _CHECKSUM.size

    @property
    def is_whole(self) -> bool:
        """Completeness: true if all of the content is there."""
        return len(self.content) == self.length

    @property
    def is_critical(self) -> bool:
        """Criticality: true if a reader has to know this chunk."""
        return self.tag.isupper()


@dataclass(frozen=True, slots=True)
class Header:
    """Header of a file: canvas, lattice, counts and colour steps of its mesh."""

    width: int
    height: int
    subdivision: int
    connectivity: int
    n_vertices: int
    steps: tuple[int, ...]
    depth: int = PLAIN_DEPTH

    @property
    def n_components(self) -> int:
        """Number of colour components."""
        return len(self.steps)

    @property
    def columns(self) -> int:
        """Lattice sites in a row of the canvas."""
        return (self.width << self.subdivision) + 1

    @property
    def rows(self) -> int:
        """Rows of lattice sites on the canvas."""
        return (self.height << self.subdivision) + 1

    def pack(self, minor: int = 0) -> bytes:
        """Bytes of signature and header, with their checksum, of a file of version 1.`minor`."""
        version = VERSION[0] << 4 | minor
        components = self.n_components - 1 | (self.depth - PLAIN_DEPTH) << 2
        is_deep = self.depth != PLAIN_DEPTH
        form = (_DEEP if is_deep else components) | self.subdivision << 2 | self.connectivity << 6
        first = bytes([version, form, components] if is_deep else [version, form])
        numbers = (self.width, self.height, self.n_vertices, *self.steps)
        return _checked(SIGNATURE + first + b"".join(map(pack_varint, numbers)))


def pack_varint(number: int) -> bytes:
    """A number in bytes of seven bits each, the lowest first; all but the last have bit 7 set."""
    if not 0 <= number <= _MAX_VARINT:
        raise ValueError(f"expected a number of 0 to {_MAX_VARINT}, got {number}")
    groups = bytearray()
    while number > 0x7F:
        groups.append(number & 0x7F | 0x80)
        number >>= 7
    groups.append(number)
    return bytes(groups)


def pack_chunk(tag: bytes, content: bytes) -> bytes:
    """Bytes of one chunk."""
    return _checked(tag + pack_varint(len(content)) + content)


def pack_file(header: Header, chunks: Iterable[tuple[bytes, bytes]]) -> bytes:
    """Bytes of a file of a header and chunks, given as tag and content."""
    contents = list(chunks)
    minor = 1 if any(tag == GRID_TAG for tag, _ in contents) else 0
    return header.pack(minor) + b"".join(pack_chunk(*chunk) for chunk in contents)


def _checked(data: bytes) -> bytes:
    """Bytes and their checksum."""
    return data + _CHECKSUM.pack(zlib.crc32(data))


def check_ancillary(tag: bytes) -> None:
    """Raise :class:`ValueError` unless a tag can name an ancillary chunk that is not known."""
    if not (_TAG_PATTERN.fullmatch(tag) and tag.islower()):
        raise ValueError(f"expected a tag of one small letter, got {tag!r}")
    if tag in METADATA_TAGS.values():
        raise ValueError(f"chunk {tag.decode()} is known: it cannot be kept as an unknown one")


def is_vmesh(start: bytes) -> bool:
    """Check of a file's first bytes: true if they are those of a .vmesh file."""
    return start[: len(SIGNATURE)] == SIGNATURE


def read_header(data: bytes, policy: Policy) -> tuple[Header, int]:
    """Header, and the offset of what follows it; parameters and errors are as of `read_file`."""
    if not is_vmesh(data):
        if SIGNATURE.startswith(data):
            raise FormatError("truncated", "the file ends within its signature", len(data))
        raise FormatError(
            "signature",
            f"expected the signature of a .vmesh file, got {data[: len(SIGNATURE)].hex(' ')!r}",
            0,
        )
    start = len(SIGNATURE)
    # A newer version may have another header: its first byte alone is sure to mean the same.
    check_version(take(data, start, 1, "the header")[0])
    form, components, end = read_form(data, start + 1)
    numbers = []
    for _ in range(3 + (components & 3) + 1):
        number, end = read_varint(data, end, "header")
        numbers.append(number)
    _verify(data, 0, end, "the header", policy)
    width, height, n_vertices, *steps = numbers
    depth = PLAIN_DEPTH + (components >> 2)
    header = Header(width, height, form >> 2 & 15, form >> 6, n_vertices, tuple(steps), depth)
    is_deep = form & 3 == _DEEP
    errors = [FormatError("header", text, start) for text in _header_complaints(header, is_deep)]
    for error in errors:
        policy.complain(error)
    if errors:
        raise errors.pop()
    return header, end + _CHECKSUM.size


def read_form(data: bytes, start: int) -> tuple[int, int, int]:
    """The format byte, that of depth and components, and the offset of what follows.

    The second has components - 1 in its lower two bits and depth - 8 above them. It is made from
    the first where it is not in the file.
    """
    form = take(data, start, 1, "the header")[0]
    if form & 3 != _DEEP:
        return form, form & 3, start + 1
    return form, take(data, start + 1, 1, "the header")[0], start + 2


def check_version(byte: int) -> None:
    """Refuse a file of another major version, before anything else in it matters."""
    if byte >> 4 != VERSION[0]:
        raise FormatError(
            "version",
            f"the file is of version {version_name(byte)}, this program reads {VERSION[0]}.x",
            len(SIGNATURE),
        )


def version_name(byte: int) -> str:
    """A version as people write it."""
    return f"{byte >> 4}.{byte & 15}"


def _header_complaints(header: Header, is_deep: bool) -> Iterator[str]:
    """Faults of a header, in words; it has a byte for the depth if it is deep."""
    if not (1 <= header.width <= MAX_SIDE and 1 <= header.height <= MAX_SIDE):
        yield (
            f"expected a canvas of 1 to {MAX_SIDE} pixels a side, "
            f"got {header.width} x {header.height}"
        )
    if header.subdivision > MAX_SUBDIVISION:
        yield f"expected a subdivision of 0 to {MAX_SUBDIVISION}, got {header.subdivision}"
    if max(header.columns, header.rows) - 1 > MAX_LATTICE_SIDE:
        yield f"expected a canvas of at most {MAX_LATTICE_SIDE} lattice units a side"
    if header.n_components not in (1, 3, 4):
        yield f"expected 1, 3 or 4 colour components, got {header.n_components}"
    if header.connectivity > FLIPPED_TRIANGLES:
        yield f"connectivity {header.connectivity} is unknown"
    if not 4 <= header.n_vertices <= header.columns * header.rows:
        yield f"expected 4 to {header.columns * header.rows} vertices, got {header.n_vertices}"
    if is_deep and not PLAIN_DEPTH < header.depth <= MAX_DEPTH:
        yield f"expected {PLAIN_DEPTH + 1} to {MAX_DEPTH} bits in a sample, got {header.depth}"
    largest = (1 << header.depth) - 1
    if not all(1 <= step <= largest for step in header.steps):
        yield f"expected steps of 1 to {largest}, got {list(header.steps)}"


def read_chunk(data: bytes, offset: int) -> Chunk:
    """The chunk at an offset, cut short where the file ends; its checksum is not looked at."""
    tag = take(data, offset, 1, "a chunk")
    if not _TAG_PATTERN.fullmatch(tag):
        raise FormatError("chunk", f"expected a letter as a tag, got {tag!r}", offset)
    length, start = read_varint(data, offset + 1, "chunk")
    return Chunk(tag, length, data[start : start + length], offset, start)


def verify_chunk(data: bytes, chunk: Chunk, policy: Policy) -> None:
    """Refuse a chunk that the file does not hold all of, and compare its checksum."""
    take(data, chunk.content_offset, chunk.length, chunk.name)
    _verify(data, chunk.offset, chunk.content_end, chunk.name, policy)


def check_room(header: Header, chunk: Chunk, code: str) -> None:
    """Refuse a mesh of more colour levels than its bytes can hold, before it is decoded."""
    room = len(chunk.content)
    levels = header.n_vertices * header.n_components
    if levels > _LEVELS_PER_BYTE * (room + 1):
        text = f"a mesh of {room} bytes cannot hold {levels} colour levels"
        raise FormatError(code, text, len(SIGNATURE) if code == "header" else chunk.offset)


def take(data: bytes, offset: int, length: int, name: str) -> bytes:
    """Bytes of the file, which must go on that far."""
    if len(data) < offset + length:
        raise truncated(data, name)
    return data[offset : offset + length]


def truncated(data: bytes, name: str) -> FormatError:
    """The error of a file that ends too early."""
    return FormatError("truncated", f"the file ends within {name}", len(data))


def read_varint(data: bytes, offset: int, code: str) -> tuple[int, int]:
    """A number in the shortest form, and the offset of what follows it."""
    number = 0
    for i in range(5):
        (byte,) = take(data, offset + i, 1, f"a {code}")
        number |= (byte & 0x7F) << 7 * i
        if byte < 0x80:
            if (byte == 0 and i > 0) or number > _MAX_VARINT:
                break
            return number, offset + i + 1
    raise FormatError(code, f"expected a number of 0 to {_MAX_VARINT} in its shortest form", offset)


def _verify(data: bytes, start: int, end: int, name: str, policy: Policy) -> None:
    """Compare the checksum that follows some bytes."""
    (stored,) = _CHECKSUM.unpack(take(data, end, _CHECKSUM.size, name))
    if stored != zlib.crc32(data[start:end]):
        policy.complain(FormatError("checksum", f"{name} is damaged", start))
