"""Canonical order: vertices by row and column, triangles by their vertices."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from vmesh.arrays import Int32Array, Int64Array


def raster_keys(vertices: Int32Array | Int64Array) -> Int64Array:
    """Integers that sort positions of shape (n, 2) in raster order, one for each; (n,), int64."""
    wide = vertices.astype(np.int64)
    keys: Int64Array = (wide[:, 1] << 32) | wide[:, 0]
    return keys


def sorted_triangles(triangles: npt.NDArray[np.integer]) -> Int32Array:
    """Triangles in canonical order: lowest vertex first, then lexicographic; shape (m, 3)."""
    first, second, third = triangles.T
    lowest = np.minimum(first, np.minimum(second, third))
    rotated = np.where((lowest == second)[:, None], triangles[:, [1, 2, 0]], triangles)
    rotated = np.where((lowest == third)[:, None], triangles[:, [2, 0, 1]], rotated)
    # In a manifold mesh no two triangles share a directed edge: two indices decide the order.
    first_edges = (rotated[:, 0].astype(np.int64) << 32) | rotated[:, 1]
    result: Int32Array = rotated[np.argsort(first_edges)].astype(np.int32)
    return result
