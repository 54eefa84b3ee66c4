"""The order in which colours are coded: coarse to fine, by a Kirkpatrick hierarchy.

The finest vertices are an independent set of the Delaunay triangulation: each is surrounded by
vertices that are coded before it, its parents. They are taken out of the triangulation, then the
next set is, until the corners are left::

    o   .   o        . taken first, coded last; parents are the neighbours in that triangulation
      o   o          o left: without them, thinned again, coded before
    .   o   .

Both sides know the positions before they code a colour, so the order costs nothing.

References
----------
D. Kirkpatrick, "Optimal search in planar subdivisions", SIAM Journal on Computing 12(1), 1983.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from vmesh.arrays import BoolArray, Int32Array, Int64Array
from vmesh.kernels.half_edges import find_twins
from vmesh.kernels.hierarchy import remove_independent_sets

MAX_TRIANGLES: Final = 8
"""A vertex of more triangles than this is not taken: it has to wait until it has fewer."""


class Hierarchy(NamedTuple):
    """An order of vertices and the parents of each.

    Attributes
    ----------
    order : ndarray
        Shape (n,), int32: vertices, the first one coded first.
    starts : ndarray
        Shape (n + 1,), int64: where the parents of each place in the order start.
    parents : ndarray
        Shape (starts[n],), int32: vertices.
    """

    order: Int32Array
    starts: Int64Array
    parents: Int32Array


def find_corners(vertices: Int32Array, far: npt.ArrayLike) -> BoolArray:
    """True for each vertex that is a corner of the rectangle from (0, 0) to `far`, shape (n,)."""
    result: BoolArray = ((vertices == 0) | (vertices == np.asarray(far))).all(axis=1)
    return result


def build_hierarchy(vertices: Int32Array, triangles: Int32Array) -> Hierarchy:
    """Order in which the colours of a mesh are coded.

    Parameters
    ----------
    vertices : ndarray
        Shape (n, 2), int32, in raster order, the corners of their bounding box among them.
    triangles : ndarray
        Shape (m, 3), int32: their canonical Delaunay triangles.
    """
    is_corner = find_corners(vertices, vertices.max(axis=0))
    # Without them layers would be taken out until nothing is left to hold the rest.
    if np.count_nonzero(is_corner) != 4:
        raise ValueError("expected the corners of the bounding box among the vertices")
    taken, neighbours, counts, ends = remove_independent_sets(
        vertices.astype(np.int64),
        triangles.ravel().astype(np.int64),
        find_twins(triangles, len(vertices)),
        is_corner,
        MAX_TRIANGLES,
    )
    # The corners, each with the one before as its parent, then the layers, the last one first.
    corners = np.flatnonzero(is_corner).astype(np.int32)
    layers = np.split(np.arange(len(taken)), ends[:-1])
    backwards = np.concatenate(layers[::-1])
    counts = counts[backwards]
    is_parent = np.arange(neighbours.shape[1]) < counts[:, None]
    starts = np.cumsum(np.concatenate([[0, 0, 1, 1, 1], counts]))
    return Hierarchy(
        np.concatenate([corners, taken[backwards]]),
        starts,
        np.concatenate([corners[:-1], neighbours[backwards][is_parent]]),
    )
