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
    Complain,
    Header,
    check_room,
    read_chunk,
    read_header,
    read_varint,
    refuse,
    truncated,
    verify_chunk,
)
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
    """What a file holds.

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
        """What is coded and not lost."""
        return [coded for coded in self.coded if coded is not None]


def read_file(data: bytes, complain: Complain = refuse, lose: Complain = refuse) -> Container:
    """The header of a file, every field within its range, and all chunks.

    Checksums are verified, the contents of the chunks are not looked at, but for the grid and the
    number of vertices with which each tile starts.

    Parameters
    ----------
    data : bytes
    complain : callable
        Told of each error after which the file can still be read on. Without one it is raised.
    lose : callable
        Told of each error by which tiles are lost. Without one it is raised.

    Raises
    ------
    FormatError
        With the code ``signature``, ``version``, ``truncated``, ``checksum``, ``header``,
        ``chunk``, ``trailing`` or ``tiles``.
    """
    header, offset = read_header(data, complain)
    *ancillary, first = _iterate_chunks(data, offset, complain)
    if first.tag == MESH_TAG:
        _check_end(data, first, complain)
        check_room(header, first, "header")
        return Container(header, ancillary, None, [Coded(header, first)])
    grid = read_grid(first, header)
    chunks = list(_iterate_tiles(data, first.end, grid, complain, lose))
    tiles = zip(grid.tiles(), chunks, strict=False)
    coded = [_open_tile(header, tile, chunk, lose) for tile, chunk in tiles]
    return Container(header, ancillary, grid, coded)


def read_ancillary(data: bytes) -> list[Chunk]:
    """The chunks before the mesh of a file, of which this start is known.

    Raises
    ------
    FormatError
        As `read_file`; ``truncated`` if the start ends before the mesh begins.
    """

    def pass_over(error: FormatError) -> None:
        if error.code != "truncated":
            raise error

    _, offset = read_header(data)
    *ancillary, _ = _iterate_chunks(data, offset, pass_over)
    return ancillary


def read_grid(chunk: Chunk, header: Header) -> Grid:
    """The grid that a chunk describes: the side of its tiles, in pixels."""
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


def _iterate_chunks(data: bytes, offset: int, complain: Complain) -> Iterator[Chunk]:
    """Chunks from an offset up to the mesh, or to the grid of one in tiles."""
    known: set[bytes] = set()
    tag = b""
    while tag not in (MESH_TAG, GRID_TAG):
        chunk = read_chunk(data, offset)
        tag = chunk.tag
        if tag == MESH_TAG and len(data) < chunk.end:
            complain(truncated(data, chunk.name))
            yield chunk
            return
        verify_chunk(data, chunk, complain)
        if tag == TILE_TAG:
            complain(FormatError("chunk", f"{chunk.name}, a tile, comes before a grid", offset))
        elif chunk.is_critical and tag not in CHUNK_NAMES:
            complain(FormatError("chunk", f"critical {chunk.name} is unknown", offset))
        if tag in known:
            complain(FormatError("chunk", f"{chunk.name} appears twice", offset))
        if tag in METADATA_TAGS.values():
            known.add(tag)
        yield chunk
        offset = chunk.end


def _iterate_tiles(
    data: bytes, offset: int, grid: Grid, complain: Complain, lose: Complain
) -> Iterator[Chunk | None]:
    """The chunks of the tiles, with which a file ends; None for one that is damaged."""
    damages: list[FormatError] = []
    chunk = None
    for _ in range(grid.n_tiles):
        try:
            chunk = read_chunk(data, offset)
            verify_chunk(data, chunk, damages.append)
        except FormatError as error:
            lose(error)  # What follows cannot be told apart any more.
            return
        if chunk.tag != TILE_TAG:
            damages.append(FormatError("chunk", f"expected a tile, got {chunk.name}", offset))
        for damage in damages:
            lose(damage)
        yield None if damages else chunk
        damages.clear()
        offset = chunk.end
    if chunk:
        _check_end(data, chunk, complain)


def _check_end(data: bytes, last: Chunk, complain: Complain) -> None:
    """Complain of what follows the last chunk."""
    if last.end < len(data):
        text = f"{len(data) - last.end} bytes follow the mesh"
        complain(FormatError("trailing", text, last.end))


def _open_tile(header: Header, tile: Tile, chunk: Chunk | None, lose: Complain) -> Coded | None:
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
        lose(error)
        return None
    return Coded(own, coded)


def first_number(chunk: Chunk) -> tuple[int, int]:
    """The number that the content of a chunk starts with, and its length."""
    try:
        return read_varint(chunk.content, 0, "tiles")
    except FormatError:
        text = f"expected {chunk.name} to start with a number in its shortest form"
        raise FormatError("tiles", text, chunk.content_offset) from None
