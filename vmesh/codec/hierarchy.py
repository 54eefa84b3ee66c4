"""The order in which colours are coded: from a few far vertices to all, each between its parents.

The finest vertices are an independent set of the Delaunay triangulation: each is surrounded by
vertices that are coded before it, its parents. Without them the rest is triangulated anew, and the
next set is taken, until a few are left::

    o   .   o        . taken first, coded last; parents are the neighbours in that triangulation
      o   o          o left: triangulated anew, thinned again, coded before
    .   o   .

Both sides know the positions before they code a colour, so the order costs nothing.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from vmesh.arrays import Int32Array, Int64Array
from vmesh.kernels.delaunay import delaunay
from vmesh.kernels.half_edges import independent_set

MAX_TRIANGLES: Final = 8
"""A vertex of more triangles than this is not taken: it has to wait until there are fewer."""


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


def build_hierarchy(vertices: Int32Array, triangles: Int32Array) -> Hierarchy:
    """Order in which the colours of a mesh are coded.

    Parameters
    ----------
    vertices : ndarray
        Shape (n, 2), int32, in raster order, the corners of their bounding box among them.
    triangles : ndarray
        Shape (m, 3), int32: their canonical Delaunay triangles.

    Raises
    ------
    LimitError
        As :func:`delaunay`.
    """
    far = vertices.max(axis=0)
    is_corner = ((vertices == 0) | (vertices == far)).all(axis=1)
    left = np.arange(len(vertices), dtype=np.int32)
    orders: list[Int32Array] = []
    counts: list[Int64Array] = []
    parents: list[Int32Array] = []
    while True:
        taken, starts, neighbours = independent_set(triangles, is_corner[left], MAX_TRIANGLES)
        if not len(taken):
            break
        orders.append(left[taken])
        counts.append(np.diff(starts))
        parents.append(left[neighbours])
        left = np.delete(left, taken)
        triangles = delaunay(vertices[left])
    # Those that are never taken, the corners among them, have the one before as their parent.
    orders.append(left)
    counts.append(np.minimum(np.arange(len(left)), 1))
    parents.append(left[:-1])
    starts = np.concatenate([[0], np.cumsum(np.concatenate(counts[::-1]))])
    return Hierarchy(np.concatenate(orders[::-1]), starts, np.concatenate(parents[::-1]))
