"""Mesh -> bytes of a .vmesh file."""

from __future__ import annotations

import zlib
from collections.abc import Iterator

from vmesh.codec import layout
from vmesh.codec.mesh_coder import encode_mesh, find_flips
from vmesh.codec.tiles import cut
from vmesh.grid import Grid
from vmesh.mesh import Mesh, Metadata


def dumps(mesh: Mesh) -> bytes:
    """Bytes of the ``.vmesh`` file of a mesh.

    Parameters
    ----------
    mesh : Mesh
        A mesh that passes :meth:`Mesh.check`. Its vertices and triangles are written in
        canonical order; the canonical Delaunay triangles cost nothing, triangles that are some
        flips away cost the flips, others are listed. With a `tile` it is written in tiles, and the
        vertices on the lines between them are written twice.

    Raises
    ------
    ValueError
        If the mesh breaks a rule of the format, such as not covering its canvas.
    LimitError
        If its positions are arranged so that their Delaunay triangulation, which every file needs,
        takes too long: see :func:`vmesh.kernels.delaunay.delaunay`.
    """
    mesh.check()
    ordered = mesh.canonical()
    if ordered.tile is None:
        connectivity, (coded,) = _code([ordered])
        chunks = [(layout.MESH_TAG, coded)]
    else:
        grid = Grid(ordered.width, ordered.height, ordered.tile)
        pieces = cut(ordered, grid)
        connectivity, contents = _code(pieces)
        chunks = [(layout.GRID_TAG, layout.pack_varint(grid.side))]
        for piece, content in zip(pieces, contents, strict=True):
            chunks.append((layout.TILE_TAG, layout.pack_varint(piece.n_vertices) + content))
    metadata = _metadata_contents(ordered.metadata)
    return layout.pack_file(_header(ordered, connectivity), [*metadata, *chunks])


def _code(meshes: list[Mesh]) -> tuple[int, list[bytes]]:
    """Connectivity that can tell the triangles of all meshes, and the content that codes each."""
    flips = [find_flips(mesh) for mesh in meshes]
    if any(some is None for some in flips):
        connectivity = layout.LISTED_TRIANGLES
    elif any(some is not None and len(some.removed) for some in flips):
        connectivity = layout.FLIPPED_TRIANGLES
    else:
        connectivity = layout.IMPLIED_TRIANGLES
    return connectivity, [
        encode_mesh(mesh, _header(mesh, connectivity), some)
        for mesh, some in zip(meshes, flips, strict=True)
    ]


def _header(mesh: Mesh, connectivity: int) -> layout.Header:
    """Header of a mesh, or of the file of one."""
    return layout.Header(
        width=mesh.width,
        height=mesh.height,
        subdivision=mesh.subdivision,
        connectivity=connectivity,
        n_vertices=mesh.n_vertices,
        steps=mesh.lattice.steps,
        depth=mesh.lattice.depth,
    )


def metadata_size(metadata: Metadata) -> int:
    """Bytes that metadata take in a file."""
    return sum(len(layout.pack_chunk(*chunk)) for chunk in _metadata_contents(metadata))


def _metadata_contents(metadata: Metadata) -> Iterator[tuple[bytes, bytes]]:
    """Tag and content of the chunks before the mesh."""
    for name, tag in layout.METADATA_TAGS.items():
        block = getattr(metadata, name)
        if block:
            yield tag, zlib.compress(block, 9)
    for tag, content in metadata.unknown:
        layout.check_ancillary(tag)
        yield tag, content
