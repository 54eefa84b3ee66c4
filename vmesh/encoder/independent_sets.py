"""Independent sets of a mesh: vertices in groups that several threads may move at the same time.

A mesh is cut into bands of rows. Vertices whose neighbours are all in their own band come first,
every band at the same time; then those along the cuts, every cut at the same time; and last what is
left. The bands do not depend on the number of threads, so neither does the mesh.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from vmesh.arrays import BoolArray, Int64Array

BAND: Final = 128
"""Rows of half pixels in a band; not to be changed with the number of threads."""


def independent_sets(
    points: Int64Array, triangles: Int64Array, band: int = BAND
) -> list[list[Int64Array]]:
    """Groups of vertices, set by set: the groups of a set can be moved at the same time.

    Parameters
    ----------
    points : ndarray
        Shape (n, 2), int64, in half pixels.
    triangles : ndarray
        Shape (m, 3), int64.
    band : int
        Rows of half pixels in a band.

    Returns
    -------
    list of lists of ndarray
        Each vertex is in one group. No edge joins two groups of a set.
    """
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    left = np.ones(len(points), dtype=np.bool_)
    result = []
    for offset in (0, band // 2):
        bands = (points[:, 1] + offset) // band
        taken = left & ~_touches_another(bands, edges[left[edges].all(axis=1)])
        result.append(_groups(taken, bands))
        left &= ~taken
    result.append(_groups(left, np.zeros_like(bands)))
    return result


def _touches_another(bands: Int64Array, edges: Int64Array) -> BoolArray:
    """True for each vertex that an edge joins to another band, shape (n,)."""
    touches = np.zeros(len(bands), dtype=np.bool_)
    touches[edges[bands[edges[:, 0]] != bands[edges[:, 1]]]] = True
    return touches


def _groups(taken: BoolArray, bands: Int64Array) -> list[Int64Array]:
    """Vertices that are taken, by band."""
    vertices = np.flatnonzero(taken)
    vertices = vertices[np.argsort(bands[vertices], kind="stable")]
    return np.split(vertices, np.flatnonzero(np.diff(bands[vertices])) + 1) if len(vertices) else []
