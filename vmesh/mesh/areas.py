"""Signed areas of triangles, exact in lattice units."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from vmesh.arrays import Int32Array, Int64Array


def doubled_areas(vertices: Int32Array, triangles: npt.NDArray[np.integer]) -> Int64Array:
    """Twice the signed area of every triangle, (m, 3), of vertices, (n, 2); shape (m,), int64."""
    corners = vertices.astype(np.int64)[triangles]
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    areas: Int64Array = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    return areas
