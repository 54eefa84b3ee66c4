"""Mesh -> bytes of a .vmesh file."""

from __future__ import annotations

import zlib
from collections.abc import Iterator

from vmesh.codec import layout
from vmesh.codec.payloads import Flips, encode_mesh, find_flips
from vmesh.mesh import Mesh, Metadata


def dumps(mesh: Mesh) -> bytes:
    """Bytes of the ``.vmesh`` file of a mesh.

    Parameters
    ----------
    mesh : Mesh
        A mesh that passes :meth:`Mesh.check`. Its vertices and triangles are written in
        canonical order; the canonical Delaunay triangles cost nothing, triangles that are some
        flips away cost the flips, others are listed.

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
    connectivity, flips = _find_connectivity(ordered)
    header = layout.Header(
        width=ordered.width,
        height=ordered.height,
        subdivision=ordered.subdivision,
        connectivity=connectivity,
        n_vertices=ordered.n_vertices,
        steps=ordered.lattice.steps,
        depth=ordered.lattice.depth,
    )
    coded = (layout.MESH_TAG, encode_mesh(ordered, header, flips))
    return layout.pack_file(header, [*_metadata_contents(ordered.metadata), coded])


def _find_connectivity(mesh: Mesh) -> tuple[int, Flips | None]:
    """How the triangles of a canonical mesh are best told, and the flips if by flips."""
    flips = find_flips(mesh)
    if flips is None:
        return layout.LISTED_TRIANGLES, None
    if not len(flips.removed):
        return layout.IMPLIED_TRIANGLES, None
    return layout.FLIPPED_TRIANGLES, flips


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
