"""The bytes of a .vmesh file, field by field, for people; the file may be damaged."""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from typing import NamedTuple

from vmesh.codec import layout
from vmesh.codec.container import first_number, read_grid
from vmesh.codec.layout import Chunk
from vmesh.codec.policy import Collecting, Strict
from vmesh.errors import FormatError
from vmesh.limits import PLAIN_DEPTH


class Field(NamedTuple):
    """A run of bytes of a file and its meaning."""

    offset: int
    data: bytes
    meaning: str


def annotate(data: bytes) -> Iterator[Field]:
    """The fields of a file, one after the other; all bytes belong to one of them.

    Where the file breaks a rule so that its fields cannot be told apart any more, the rest is one
    field that says why.
    """
    offset = 0
    try:
        for size, meaning in _sizes(data):
            yield Field(offset, layout.take(data, offset, size, meaning.strip()), meaning)
            offset += size
    except FormatError as error:
        yield Field(offset, data[offset:], f"{error.code}: {error.message}")


def _sizes(data: bytes) -> Iterator[tuple[int, str]]:
    """Size and meaning of each field."""
    yield from _header_sizes(data)
    header, at = layout.read_header(data, Collecting())
    n_left = 1  # tiles, or the mesh
    while n_left:
        chunk = layout.read_chunk(data, at)
        tag = chunk.tag
        kind = "critical" if chunk.is_critical else "ancillary"
        yield 1, f"{chunk.name}: {layout.CHUNK_NAMES.get(tag, f'unknown, {kind}')}"
        yield chunk.content_offset - at - 1, f"  {chunk.length} bytes"
        yield from _content_sizes(chunk)
        yield 4, "  " + _checksum(data, at, chunk.content_end)
        if tag == layout.GRID_TAG:
            n_left = read_grid(chunk, header).n_tiles
        elif tag in (layout.MESH_TAG, layout.TILE_TAG):
            n_left -= 1
        at = chunk.end
    if at < len(data):
        yield len(data) - at, "trailing: nothing may follow the mesh"


def _content_sizes(chunk: Chunk) -> Iterator[tuple[int, str]]:
    """Size and meaning of each field of the content of a chunk."""
    size, meanings = 0, {layout.GRID_TAG: "tiles of {} pixels", layout.TILE_TAG: "vertices {}"}
    if chunk.tag in meanings and chunk.is_whole:
        number, size = first_number(chunk)
        yield size, "  " + meanings[chunk.tag].format(number)
    if chunk.length > size:
        yield chunk.length - size, "  content"


def _header_sizes(data: bytes) -> Iterator[tuple[int, str]]:
    """Size and meaning of each field of signature and header."""
    if not layout.is_vmesh(data):
        layout.read_header(data, Strict())  # It says what is wrong.
    at = len(layout.SIGNATURE)
    yield at, "signature"
    (version,) = layout.take(data, at, 1, "the header")
    yield 1, f"version {layout.version_name(version)}"
    layout.check_version(version)
    form, components, end = layout.read_form(data, at + 1)
    is_deep = end > at + 2
    n_components = (components & 3) + 1
    kind = layout.COMPONENT_NAMES.get(n_components, f"{n_components} components")
    triangles = layout.CONNECTIVITY_NAMES.get(form >> 6, "unknown")
    yield (
        1,
        f"{'deep' if is_deep else kind}, subdivision {form >> 2 & 15}, {triangles} triangles",
    )
    if is_deep:
        yield 1, f"{kind} of {PLAIN_DEPTH + (components >> 2)} bits"
    at = end
    for name in ("width", "height", "vertices", *["colour step"] * n_components):
        number, end = layout.read_varint(data, at, "header")
        yield end - at, f"{name} {number}"
        at = end
    yield 4, _checksum(data, 0, at)


def _checksum(data: bytes, start: int, end: int) -> str:
    """Meaning of the checksum that follows some bytes: whether it is right."""
    stored = int.from_bytes(layout.take(data, end, 4, "a checksum"), "little")
    computed = zlib.crc32(data[start:end])
    return "CRC-32" if stored == computed else f"CRC-32, WRONG: it should be {computed:08x}"
