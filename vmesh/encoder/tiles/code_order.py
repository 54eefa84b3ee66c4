"""The order in which a file holds the colours of a mesh, tile by tile where there are any."""

from __future__ import annotations

from itertools import product

import numpy as np

from vmesh.arrays import Int32Array, Int64Array
from vmesh.codec.hierarchy import Hierarchy, build_hierarchy
from vmesh.grid import Grid
from vmesh.kernels.delaunay import delaunay


def code_order(vertices: Int32Array, grid: Grid | None, unit: int) -> Hierarchy:
    """Order of the colours, and the vertices that each is predicted from.

    Each tile is a mesh of its own. A vertex on its sides belongs to the first tile that holds it;
    its parents there come before it.

    Parameters
    ----------
    vertices : ndarray
        Shape (n, 2), int32, in raster order, the corners of the tiles among them.
    grid : Grid or None
        The tiles; None where the file holds the mesh as one.
    unit : int
        Lattice units in a pixel.
    """
    if grid is None:
        return build_hierarchy(vertices, delaunay(vertices))
    is_known = np.zeros(len(vertices), dtype=np.bool_)
    orders, counts, parents = [], [], []
    for members in _members(vertices, grid, unit):
        own = vertices[members] - vertices[members[0]]
        hierarchy = build_hierarchy(own, delaunay(own))
        order, n_parents = members[hierarchy.order], np.diff(hierarchy.starts)
        is_new = ~is_known[order]
        is_known[order] = True
        orders.append(order[is_new])
        counts.append(n_parents[is_new])
        parents.append(members[hierarchy.parents[np.repeat(is_new, n_parents)]])
    return Hierarchy(
        np.concatenate(orders).astype(np.int32),
        np.cumsum(np.concatenate([[0], *counts])),
        np.concatenate(parents).astype(np.int32),
    )


def _members(vertices: Int32Array, grid: Grid, unit: int) -> list[Int64Array]:
    """Vertices in each tile or on its sides, in raster order, by tile."""
    side = grid.side * unit
    columns, rows = vertices.T.astype(np.int64) // side
    on_line = vertices.T % side == 0
    tiles, members = [], []
    # A vertex on a line belongs to the tile before it too.
    for left, up in product((0, 1), repeat=2):
        x, y = columns - left, rows - up
        inside = (x >= 0) & (x < grid.columns) & (y >= 0) & (y < grid.rows)
        found = np.flatnonzero(inside & (on_line[0] | (left == 0)) & (on_line[1] | (up == 0)))
        tiles.append(y[found] * grid.columns + x[found])
        members.append(found)
    owner, member = np.concatenate(tiles), np.concatenate(members)
    order = np.lexsort((member, owner))
    return np.split(member[order], np.flatnonzero(np.diff(owner[order])) + 1)
