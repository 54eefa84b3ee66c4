"""The chunks of a .vmesh file, in the order that the format asks for (spec, section 3).

::

    ancillary ...   M                 one mesh
    ancillary ...   G   T   T   ...   a mesh in tiles: the grid, and a chunk for each tile of it
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

from vmesh.codec.layout import (
    CHUNK_NAMES,
    GRID_TAG,
    MESH_TAG,
    METADATA_TAGS,
    TILE_TAG,
    Chunk,
    Header,
    check_room,
    read_chunk,
    read_header,
    read_varint,
    truncated,
    verify_chunk,
)
from vmesh.codec.policy import Collecting, Partial, Policy, Strict
from vmesh.errors import FormatError
from vmesh.grid import Grid, Tile
from vmesh.limits import MAX_TILE_SIDE


class Coded(NamedTuple):
    """A mesh before it is decoded: that of the file, or of one tile.

    Attributes
    ----------
    header : Header
        That of the file, with canvas and vertices of the tile.
    chunk : Chunk
        Its content is what is coded.
    """

    header: Header
    chunk: Chunk


class Container(NamedTuple):
    """Contents of a file, by its chunks.

    Attributes
    ----------
    header : Header
    ancillary : list of Chunk
    grid : Grid or None
        None if the mesh is not in tiles.
    coded : list of Coded or None
        The mesh, or the tiles of the grid in their order, with None for each that is lost. It ends
        early where the file does.
    """

    header: Header
    ancillary: list[Chunk]
    grid: Grid | None
    coded: list[Coded | None]

    @property
    def found(self) -> list[Coded]:
        """Coded meshes that are not lost."""
        return [coded for coded in self.coded if coded is not None]


def read_file(data: bytes, policy: Policy) -> Container:
    """Container in the bytes of a file: its header, every field within its range, and all chunks.

    Checksums are verified, the contents of the chunks are not looked at, but for the grid and the
    number of vertices with which each tile starts.

    Parameters
    ----------
    data : bytes
    policy : Policy
        Told of errors after which the file can still be read on, of tiles that are lost, and, once
        all chunks are known, of those that no version up to this one knows.

    Raises
    ------
    FormatError
        With the code ``signature``, ``version``, ``truncated``, ``checksum``, ``header``,
        ``chunk``, ``trailing`` or ``tiles``.
    """
    header, offset = read_header(data, policy)
    *ancillary, first = _iterate_chunks(data, offset, policy)
    grid: Grid | None = None
    coded: list[Coded | None] = [Coded(header, first)]
    if first.tag == MESH_TAG:
        _check_end(data, first, policy)
        check_room(header, first, "header")
    else:
        grid = read_grid(first, header)
        chunks = list(_iterate_tiles(data, first.end, grid, policy))
        tiles = zip(grid.tiles(), chunks, strict=False)
        coded = [_open_tile(header, tile, chunk, policy) for tile, chunk in tiles]
    for chunk in ancillary:
        if not chunk.is_critical and chunk.tag not in CHUNK_NAMES:
            policy.keep(chunk)
    return Container(header, ancillary, grid, coded)


def read_ancillary(data: bytes) -> list[Chunk]:
    """Chunks before the mesh of a file, of which this start is known.

    Raises
    ------
    FormatError
        As `read_file`; ``truncated`` if the start ends before the mesh begins.
    """
    _, offset = read_header(data, Strict())
    *ancillary, _ = _iterate_chunks(data, offset, Partial())
    return ancillary


def read_grid(chunk: Chunk, header: Header) -> Grid:
    """Grid that a chunk describes: the side of its tiles, in pixels."""
    most = MAX_TILE_SIDE >> header.subdivision
    side, end = first_number(chunk)
    if end != chunk.length or not 1 <= side <= most:
        text = f"expected tiles of 1 to {most} pixels a side, got {chunk.content.hex(' ')!r}"
        raise FormatError("tiles", text, chunk.content_offset)
    grid = Grid(header.width, header.height, side)
    if (grid.columns + 1) * (grid.rows + 1) > header.n_vertices:
        text = f"{grid.n_tiles} tiles have more corners than {header.n_vertices}"
        raise FormatError("tiles", text, chunk.content_offset)
    return grid


def _iterate_chunks(data: bytes, offset: int, policy: Policy) -> Iterator[Chunk]:
    """Chunks from an offset up to the mesh, or to the grid of one in tiles."""
    known: set[bytes] = set()
    tag = b""
    while tag not in (MESH_TAG, GRID_TAG):
        chunk = read_chunk(data, offset)
        tag = chunk.tag
        if tag == MESH_TAG and len(data) < chunk.end:
            policy.complain(truncated(data, chunk.name))
            yield chunk
            return
        verify_chunk(data, chunk, policy)
        if tag == TILE_TAG:
            policy.complain(
                FormatError("chunk", f"{chunk.name}, a tile, comes before a grid", offset)
            )
        elif chunk.is_critical and tag not in CHUNK_NAMES:
            policy.complain(FormatError("chunk", f"critical {chunk.name} is unknown", offset))
        if tag in known:
            policy.complain(FormatError("chunk", f"{chunk.name} appears twice", offset))
        if tag in METADATA_TAGS.values():
            known.add(tag)
        yield chunk
        offset = chunk.end


def _iterate_tiles(data: bytes, offset: int, grid: Grid, policy: Policy) -> Iterator[Chunk | None]:
    """The chunks of the tiles, with which a file ends; None for one that is damaged."""
    chunk = None
    for _ in range(grid.n_tiles):
        damages = Collecting()
        try:
            chunk = read_chunk(data, offset)
            verify_chunk(data, chunk, damages)
        except FormatError as error:
            policy.lose(error)  # What follows cannot be told apart any more.
            return
        if chunk.tag != TILE_TAG:
            damages.complain(FormatError("chunk", f"expected a tile, got {chunk.name}", offset))
        for damage in damages.errors:
            policy.lose(damage)
        yield None if damages.errors else chunk
        offset = chunk.end
    if chunk:
        _check_end(data, chunk, policy)


def _check_end(data: bytes, last: Chunk, policy: Policy) -> None:
    """Complain of what follows the last chunk."""
    if last.end < len(data):
        text = f"{len(data) - last.end} bytes follow the mesh"
        policy.complain(FormatError("trailing", text, last.end))


def _open_tile(header: Header, tile: Tile, chunk: Chunk | None, policy: Policy) -> Coded | None:
    """A tile and what it says of itself, None if that cannot be."""
    if chunk is None:
        return None
    try:
        n_vertices, start = first_number(chunk)
        own = replace(header, width=tile.width, height=tile.height, n_vertices=n_vertices)
        most = own.columns * own.rows
        if not 4 <= n_vertices <= most:
            text = f"expected 4 to {most} vertices in a tile, got {n_vertices}"
            raise FormatError("tiles", text, chunk.content_offset)
        coded = replace(
            chunk,
            length=chunk.length - start,
            content=chunk.content[start:],
            content_offset=chunk.content_offset + start,
        )
        check_room(own, coded, "tiles")
    except FormatError as error:
        policy.lose(error)
        return None
    return Coded(own, coded)


def first_number(chunk: Chunk) -> tuple[int, int]:
    """Number that the content of a chunk starts with, and its length."""
    try:
        return read_varint(chunk.content, 0, "tiles")
    except FormatError:
        text = f"expected {chunk.name} to start with a number in its shortest form"
        raise FormatError("tiles", text, chunk.content_offset) from None
