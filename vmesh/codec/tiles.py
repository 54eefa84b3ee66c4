"""A mesh and the pieces of it that lie in the tiles of a grid (spec, section 10.2).

Each piece is a mesh on a canvas of its own, the tile. Neighbours have the same vertices, of the
same colours, on the side that they share, so that pieces that were decoded one by one fit.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vmesh.arrays import BoolArray, Int32Array, Int64Array
from vmesh.codec.container import Container
from vmesh.color_lattice import ColorLattice
from vmesh.errors import FormatError
from vmesh.grid import Grid, Tile
from vmesh.kernels.delaunay import delaunay
from vmesh.mesh import Mesh
from vmesh.mesh.canonical_order import raster_keys, sorted_triangles


def cut(mesh: Mesh, grid: Grid) -> list[Mesh]:
    """The pieces of a mesh in canonical order, of which no triangle crosses a line of the grid.

    They are in the order of the tiles, each in canonical order.
    """
    side = grid.side * mesh.unit
    places = mesh.vertices[mesh.triangles].min(axis=1) // side
    number = places[:, 1] * grid.columns + places[:, 0]
    order = np.argsort(number, kind="stable")
    bounds = np.searchsorted(number[order], np.arange(1, grid.n_tiles))
    shares = np.split(mesh.triangles[order], bounds)
    return [_piece(mesh, *pair) for pair in zip(grid.tiles(), shares, strict=True)]


def _piece(mesh: Mesh, tile: Tile, triangles: Int32Array) -> Mesh:
    """The mesh of some triangles on the canvas of a tile."""
    used = np.unique(triangles)
    corner = np.array([tile.x, tile.y]) * mesh.unit
    return Mesh(
        tile.width,
        tile.height,
        mesh.vertices[used] - corner,
        np.searchsorted(used, triangles).astype(np.int32),
        mesh.levels[used],
        mesh.lattice,
        mesh.subdivision,
    )


def join(container: Container, grid: Grid, pieces: Sequence[Mesh | None]) -> Mesh:
    """The mesh of the pieces in the tiles of a grid; tiles without one stay empty.

    Raises
    ------
    FormatError
        With the code ``tiles``, if two neighbours have other vertices, or vertices of other
        colours, on the side that they share.
    """
    header = container.header
    unit = 1 << header.subdivision
    found = [(number, piece) for number, piece in enumerate(pieces) if piece is not None]
    corners = np.array([tile[:2] for tile in grid.tiles()], dtype=np.int32) * unit
    vertices = np.concatenate([piece.vertices + corners[number] for number, piece in found])
    levels = np.concatenate([piece.levels for _, piece in found])
    owners = np.repeat([number for number, _ in found], [piece.n_vertices for _, piece in found])
    _, first, places, counts = np.unique(
        raster_keys(vertices), return_index=True, return_inverse=True, return_counts=True
    )
    there = np.array([piece is not None for piece in pieces]).reshape(grid.rows, grid.columns)
    expected = _n_tiles_at(vertices[first], grid.side * unit, there)
    _check_fit(container, "vertices", owners[(counts != expected)[places]])
    _check_fit(container, "colours", owners[(levels != levels[first][places]).any(axis=1)])
    starts = np.cumsum([0, *(piece.n_vertices for _, piece in found)])
    triangles = [
        places[start + piece.triangles] for start, (_, piece) in zip(starts, found, strict=False)
    ]
    return Mesh(
        header.width,
        header.height,
        vertices[first],
        sorted_triangles(np.concatenate(triangles)),
        levels[first],
        ColorLattice(header.steps, header.depth),
        header.subdivision,
        tile=grid.side,
    )


def _check_fit(container: Container, what: str, tiles: Int64Array) -> None:
    """Complain of tiles that differ from a neighbour."""
    if tiles.size:
        coded = container.coded[tiles[0]]
        text = f"tile {tiles[0]} and a neighbour have other {what} on the side that they share"
        raise FormatError("tiles", text, coded.chunk.offset if coded else 0)


def _n_tiles_at(vertices: Int32Array, side: int, there: BoolArray) -> Int64Array:
    """Numbers of tiles, of those that are there, that each vertex is in or on the border of; (n,).

    `there` has the shape (rows, columns) of the grid, `side` is in lattice units.
    """
    padded = np.pad(there, 1).astype(np.int64)  # by none, for what lies beyond the canvas
    column, row = (vertices // side + 1).T
    before_x, before_y = ((vertices - 1) // side + 1).T
    on_x, on_y = column != before_x, row != before_y
    count: Int64Array = padded[row, column]
    count += on_x * padded[row, before_x] + on_y * padded[before_y, column]
    count += (on_x & on_y) * padded[before_y, before_x]
    return count


def fill(mesh: Mesh, tile: Tile) -> Mesh:
    """A piece for a tile without one, of its corners and what its neighbours have on its sides.

    Parameters
    ----------
    mesh : Mesh
        The pieces that are there, joined. Corners that none of them has get their mean colour.
    tile : Tile
    """
    far = np.array([tile.width, tile.height]) * mesh.unit
    top = tile.y * mesh.unit
    first, last = np.searchsorted(mesh.vertices[:, 1], [top, top + far[1] + 1])
    local = mesh.vertices[first:last] - np.array([tile.x, tile.y]) * mesh.unit
    around = ((local >= 0) & (local <= far)).all(axis=1)
    corners = np.array([[0, 0], [far[0], 0], [0, far[1]], far])
    mean = np.rint(mesh.levels.mean(axis=0)).astype(np.int32)
    vertices = np.concatenate([local[around], corners]).astype(np.int32)
    levels = np.concatenate([mesh.levels[first:last][around], np.tile(mean, (4, 1))])
    _, chosen = np.unique(raster_keys(vertices), return_index=True)
    points = vertices[chosen]
    return Mesh(
        tile.width,
        tile.height,
        points,
        delaunay(points),
        levels[chosen],
        mesh.lattice,
        mesh.subdivision,
    )
