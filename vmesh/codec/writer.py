"""Mesh -> bytes of a .vmesh file."""

from __future__ import annotations

import zlib
from collections.abc import Iterator

import numpy as np

from vmesh.codec import layout
from vmesh.codec.payloads import encode_mesh
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
        width=ordered.width,
        height=ordered.height,
        subdivision=ordered.subdivision,
        connectivity=layout.IMPLIED_TRIANGLES if implied else layout.LISTED_TRIANGLES,
        n_vertices=ordered.n_vertices,
        steps=ordered.lattice.steps,
    )
    coded = (layout.MESH_TAG, encode_mesh(ordered, header))
    return layout.pack_file(header, [*_metadata_contents(ordered.metadata), coded])


def _are_implied(mesh: Mesh) -> bool:
    """Whether the triangles of a canonical mesh follow from its vertices."""
    try:
        return np.array_equal(delaunay(mesh.vertices), mesh.triangles)
    except LimitError:
        return False


def _metadata_contents(metadata: Metadata) -> Iterator[tuple[bytes, bytes]]:
    """Tag and content of the chunks before the mesh."""
    for name, tag in layout.METADATA_TAGS.items():
        block = getattr(metadata, name)
        if block:
            yield tag, zlib.compress(block, 9)
    for tag, content in metadata.unknown:
        layout.check_ancillary(tag)
        yield tag, content
