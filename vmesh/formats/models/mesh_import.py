"""Mesh files of other programs, and the canonical text -> Mesh."""

from __future__ import annotations

import os
from pathlib import Path

from vmesh.codec.text import mesh_from_text
from vmesh.errors import MeshError
from vmesh.formats.models.mesh_files import read_surface
from vmesh.formats.models.plane import mesh_of
from vmesh.formats.registry import MESH_SUFFIXES
from vmesh.limits import DEFAULT_LIMITS, Limits
from vmesh.mesh import Mesh


def import_mesh(
    path: str | os.PathLike[str],
    *,
    scale: float | None = None,
    width: int | None = None,
    height: int | None = None,
    step: int = 1,
    limits: Limits = DEFAULT_LIMITS,
) -> Mesh:
    """Mesh of a PLY, OBJ or glTF file (``.glb``), or of a canonical text (``.txt``).

    The triangles have to be flat, with a colour at every vertex, and to cover the box around them,
    which becomes the canvas: x points right, y up, and z is the same everywhere. A unit is a pixel
    unless a scale or a size says otherwise; so of what :func:`vmesh.export` wrote the points,
    triangles and colours of 8 bits come back as they were. The text holds all but the metadata.

    Parameters
    ----------
    path : path
    scale : float, optional
        Pixels in a unit of the file.
    width, height : int, optional
        Size of the canvas; one of them alone keeps the proportions. Not together with `scale`.
    step : int
        Rounding of the colours, 1 for none; with 8 the file is about a third smaller.
    limits : Limits
        What the file may ask for.

    Returns
    -------
    Mesh
        In canonical order and fit for a ``.vmesh`` file; grey or RGB if that holds all colours.
        Vertices lie on the coarsest lattice that has them all, or on the finest there is.

    Raises
    ------
    MeshError
        If the file cannot be read, or has no vertex colours.
    ValueError
        If the mesh is not flat, or none that covers a canvas, as :meth:`Mesh.check` says.
    LimitError
        If it has more than `limits` allow.
    VmeshError
        If trimesh is not installed, which the text does not need.
    OSError
        If the file cannot be read.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in MESH_SUFFIXES:
        raise ValueError(
            f"expected a name that ends in {', '.join(MESH_SUFFIXES)}, got {os.fspath(path)}"
        )
    data = Path(path).read_bytes()
    if suffix != ".txt":
        surface = read_surface(data, suffix[1:], limits=limits)
        return mesh_of(surface, scale=scale, width=width, height=height, step=step, limits=limits)
    if step != 1 or any(value is not None for value in (scale, width, height)):
        raise ValueError("a text has its canvas and colour steps: expected no others")
    try:
        return mesh_from_text(data.decode("ascii"), limits=limits)
    except UnicodeDecodeError:
        raise MeshError("expected the canonical text of a mesh, in ASCII") from None
