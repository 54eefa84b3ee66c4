"""Mesh -> the data of PDF shadings of type 4: strips of vertices, 16-bit coordinates.

A record is a flag (8 bits), x and y (16 bits each) and a sample of 8 bits for each component. Other
widths are allowed by the standard, but not drawn by all programs. Coordinates are the mesh's own
lattice units, so nothing is rounded; `Decode` turns them into pixels.

A canvas of more than 65,535 units is drawn by several shadings. Squares of 2**15 units, and of
twice, four times ... that side for larger triangles, each draw the triangles whose bounding box has
its top left corner in them, on a grid that is as much coarser as the square is larger::

    |<- 2**15 ->|            a triangle that is no longer than the square's side and starts in
    +-----------+- - - - +   it ends less than 2**16 units from the square's corner
    |       .___|_____.
    |        \\  |    .      |
    +---------\\-+- -.- - - +

References
----------
ISO 32000-2, 8.7.4.5.5: free-form Gouraud-shaded triangle meshes.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from vmesh.arrays import Float64Array, Int32Array, Int64Array, UInt8Array
from vmesh.kernels.half_edges import find_twins
from vmesh.kernels.strips import find_strips
from vmesh.mesh import Mesh

MAX_COORDINATE: Final = 0xFFFF
_SQUARE: Final = 1 << 15
# Pixels by which everything is moved. pdfium leaves out each row of pixels at whose top a triangle
# has a corner, so vertices must not lie on rows of the device at any common resolution. The move is
# to the right and up, since pdfium and mupdf look at a pixel's top left corner where they should
# look at its centre: downwards they come 1 to 4 dB further from the true picture.
_SHIFT: Final = (0.0031, -0.0037)


@dataclass(frozen=True, slots=True)
class Shading:
    """The data of a shading of type 4.

    Parameters
    ----------
    records : bytes
        A record of 5 + c bytes for each vertex of the strips.
    bounds : tuple of float
        Pixels that the coordinates 0 and 65,535 stand for: x, x, y, y.
    """

    records: bytes
    bounds: tuple[float, float, float, float]


def make_shadings(mesh: Mesh, colors: UInt8Array) -> Iterator[Shading]:
    """The shadings that draw a mesh, one for most, with colours of shape (n, c)."""
    for square, triangles in _squares(mesh):
        origin, step = np.array(square[1:]) * (_SQUARE * square[0]), square[0]
        flags, vertices = find_strips(triangles, find_twins(triangles, mesh.n_vertices))
        grid = (mesh.vertices[vertices] - origin + step // 2) // step
        yield Shading(_pack(flags, grid, colors[vertices]), _bounds(origin, step, mesh.unit))


def _squares(mesh: Mesh) -> Iterator[tuple[tuple[int, int, int], Int32Array]]:
    """The squares' steps, columns and rows, and the triangles that they draw."""
    triangles = np.ascontiguousarray(mesh.triangles)
    if max(mesh.width, mesh.height) * mesh.unit <= MAX_COORDINATE:
        yield (1, 0, 0), triangles
        return
    corners = mesh.vertices[triangles].astype(np.int64)
    first = corners.min(axis=1)
    extent = (corners.max(axis=1) - first).max(axis=1)
    steps = np.int64(1) << np.maximum(0, np.ceil(np.log2(extent / _SQUARE))).astype(np.int64)
    places = first // (_SQUARE * steps[:, None])
    squares, owners = np.unique(np.column_stack([steps, places]), axis=0, return_inverse=True)
    for i, (step, column, row) in enumerate(squares.tolist()):
        yield (step, column, row), np.ascontiguousarray(triangles[owners.ravel() == i])


def _bounds(
    origin: Float64Array | Int64Array, step: int, unit: int
) -> tuple[float, float, float, float]:
    """Pixels of a square's first and last coordinate."""
    x, y = (origin / unit + _SHIFT).tolist()
    extent = MAX_COORDINATE * step / unit
    return x, x + extent, y, y + extent


def _pack(flags: UInt8Array, grid: Int32Array | Int64Array, colors: UInt8Array) -> bytes:
    """Records of flags of shape (k,), coordinates of shape (k, 2) and colours of shape (k, c)."""
    coordinates = grid.astype(">u2").view(np.uint8).reshape(-1, 4)
    return np.column_stack([flags, coordinates, colors]).tobytes()
