"""The canonical text of a mesh: the same for every decoder that reads a file right."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from vmesh.codec.layout import VERSION
from vmesh.mesh import Mesh


def mesh_text(mesh: Mesh) -> str:
    """The canonical text of a mesh (``spec/conformance/README.md``), in ASCII.

    Parameters
    ----------
    mesh : Mesh
        In canonical order, as :func:`vmesh.loads` returns it.
    """
    return "".join(f"{line}\n" for line in _lines(mesh))


def _lines(mesh: Mesh) -> Iterator[str]:
    yield f"vmesh {VERSION[0]}.{VERSION[1]}"
    yield f"canvas {mesh.width} {mesh.height}"
    yield f"subdivision {mesh.subdivision}"
    yield f"depth {mesh.lattice.depth}"
    yield " ".join(["steps", *map(str, mesh.lattice.steps)])
    yield f"vertices {mesh.n_vertices}"
    for numbers in np.concatenate([mesh.vertices, mesh.levels], axis=1).tolist():
        yield " ".join(map(str, numbers))
    yield f"triangles {mesh.n_triangles}"
    for numbers in mesh.triangles.tolist():
        yield " ".join(map(str, numbers))
