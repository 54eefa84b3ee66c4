"""Mesh -> bytes of a .vmesh file."""

from __future__ import annotations

import zlib
from collections.abc import Iterator

import numpy as np

from vmesh.codec import layout
from vmesh.codec.payloads import encode_levels, encode_positions, encode_triangles
from vmesh.errors import LimitError
from vmesh.kernels.delaunay import delaunay
from vmesh.mesh import Mesh, Metadata


def dumps(mesh: Mesh) -> bytes:
    """Bytes of the ``.vmesh`` file of a mesh.

    Parameters
    ----------
    mesh : Mesh
        A mesh that passes :meth:`Mesh.check`. Its vertices and triangles are written in
        canonical order; triangles that are the canonical Delaunay triangles cost nothing.

    Raises
    ------
    ValueError
        If the mesh breaks a rule of the format, such as not covering its canvas.
    """
    mesh.check()
    ordered = mesh.canonical()
    implied = _are_implied(ordered)
    header = layout.Header(
        major=layout.MAJOR_VERSION,
        minor=layout.MINOR_VERSION,
        width=ordered.width,
        height=ordered.height,
        subdivision=ordered.subdivision,
        n_components=ordered.n_components,
        n_vertices=ordered.n_vertices,
        n_triangles=ordered.n_triangles,
        connectivity=layout.IMPLIED_TRIANGLES if implied else layout.LISTED_TRIANGLES,
        steps=ordered.lattice.steps,
    )
    return layout.pack_file(_contents(ordered, header))


def _are_implied(mesh: Mesh) -> bool:
    """Whether the triangles of a canonical mesh follow from its vertices."""
    try:
        return np.array_equal(delaunay(mesh.vertices), mesh.triangles)
    except LimitError:
        return False


def _contents(mesh: Mesh, header: layout.Header) -> Iterator[tuple[bytes, bytes]]:
    """Tag and content of every chunk of a canonical mesh, in order."""
    yield layout.HEADER_TAG, header.pack()
    yield from _metadata_contents(mesh.metadata)
    yield layout.POSITIONS_TAG, encode_positions(mesh.vertices, header.columns, header.rows)
    if header.connectivity == layout.LISTED_TRIANGLES:
        yield layout.TRIANGLES_TAG, encode_triangles(mesh.triangles, mesh.n_vertices)
    levels = encode_levels(mesh.levels, mesh.vertices, mesh.triangles, mesh.lattice)
    yield layout.COLORS_TAG, levels
    yield layout.END_TAG, b""


def _metadata_contents(metadata: Metadata) -> Iterator[tuple[bytes, bytes]]:
    for name, tag in layout.METADATA_TAGS.items():
        block = getattr(metadata, name)
        if block:
            yield tag, zlib.compress(block, 9)
    for tag, content in metadata.unknown:
        layout.check_ancillary(tag)
        yield tag, content
