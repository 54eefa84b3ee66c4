"""Bytes of a .vmesh file -> Mesh; written for hostile files."""

from __future__ import annotations

import zlib

from vmesh.codec import layout
from vmesh.codec.layout import Chunk, Header
from vmesh.codec.payloads import decode_levels, decode_positions, decode_triangles
from vmesh.color_lattice import ColorLattice
from vmesh.errors import FormatError
from vmesh.kernels.delaunay import delaunay
from vmesh.limits import DEFAULT_LIMITS, Limits
from vmesh.mesh import Mesh, Metadata


def loads(data: bytes | bytearray | memoryview, *, limits: Limits = DEFAULT_LIMITS) -> Mesh:
    """Mesh of the bytes of a ``.vmesh`` file, in canonical order.

    Parameters
    ----------
    data : bytes-like
        A whole file.
    limits : Limits
        What the file may ask for; checked before anything is allocated.

    Raises
    ------
    FormatError
        If the bytes are not a conforming file; `code` and `offset` say what and where.
    LimitError
        If they are, but ask for more than `limits` allow.
    """
    chunks = layout.read_chunks(bytes(memoryview(data)))
    header = layout.read_header(chunks)
    limits.check_pixels(header.width, header.height)
    limits.check_vertices(header.n_vertices)
    by_tag = {chunk.tag: chunk for chunk in chunks}
    bare = _read_geometry(header, by_tag, _read_metadata(chunks, limits))
    colors = by_tag[layout.COLORS_TAG]
    levels = decode_levels(
        colors.content, colors.content_offset, bare.vertices, bare.triangles, bare.lattice
    )
    return bare.replaced(levels=levels)


def _read_geometry(header: Header, by_tag: dict[bytes, Chunk], metadata: Metadata) -> Mesh:
    """The mesh without its colours, checked."""
    positions = by_tag[layout.POSITIONS_TAG]
    vertices = decode_positions(
        positions.content,
        positions.content_offset,
        header.n_vertices,
        header.columns,
        header.rows,
    )
    lattice = ColorLattice(header.steps)
    if header.connectivity == layout.LISTED_TRIANGLES:
        source = by_tag[layout.TRIANGLES_TAG]
        triangles = decode_triangles(
            source.content, source.content_offset, header.n_triangles, header.n_vertices
        )
    else:
        source = positions
        triangles = delaunay(vertices)
    if len(triangles) != header.n_triangles:
        raise FormatError(
            "geometry",
            f"expected {header.n_triangles} triangles, got {len(triangles)}",
            source.content_offset,
        )
    mesh = Mesh(
        header.width,
        header.height,
        vertices,
        triangles,
        lattice.zero_levels(header.n_vertices),
        lattice,
        header.subdivision,
        metadata,
    )
    try:
        mesh.check()
    except ValueError as error:
        raise FormatError("geometry", str(error), source.content_offset) from None
    return mesh


def _read_metadata(chunks: list[Chunk], limits: Limits) -> Metadata:
    """ICC profile, EXIF, XMP and the ancillary chunks that are not known."""
    names = {tag: name for name, tag in layout.METADATA_TAGS.items()}
    known: dict[str, bytes] = {}
    unknown = []
    total = 0
    for chunk in chunks:
        if chunk.is_critical:
            continue
        if chunk.tag in names:
            known[names[chunk.tag]] = block = _inflate(chunk, limits)
            total += len(block)
        else:
            unknown.append((chunk.tag, chunk.content))
            total += len(chunk.content)
        limits.check_metadata(total)
    return Metadata(**known, unknown=tuple(unknown))


def _inflate(chunk: Chunk, limits: Limits) -> bytes:
    """Content of a metadata chunk, inflated to no more than the limit."""
    inflater = zlib.decompressobj()
    try:
        block = inflater.decompress(chunk.content, limits.max_metadata + 1)
    except zlib.error as error:
        raise FormatError("metadata", f"zlib: {error}", chunk.content_offset) from None
    limits.check_metadata(len(block))
    if not inflater.eof or inflater.unused_data or not block:
        raise FormatError(
            "metadata", "expected one complete zlib stream with content", chunk.content_offset
        )
    return block
