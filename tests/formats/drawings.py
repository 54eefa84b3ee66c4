"""How far a drawing is from our own raster: everywhere, inside of triangles, and on their edges."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.ndimage import maximum_filter, minimum_filter

import vmesh
from vmesh.arrays import UInt8Array
from vmesh.formats.picture import flatten
from vmesh.formats.raster import scaled_positions
from vmesh.kernels.scanline import label
from vmesh.mesh import Mesh

_REACH = 2  # pixels from an edge that count as on it


class Difference(NamedTuple):
    """Mean error, largest error away from edges, and mean error on edges over that elsewhere."""

    mean: float
    inside: int
    seams: float


def compare(drawn: UInt8Array, mesh: Mesh, scale: int) -> Difference:
    """How far a drawing of shape (h, w, 3) is from our raster, on white, in levels."""
    ours = flatten(vmesh.render(mesh, scale=scale))
    errors = np.abs(drawn.astype(int) - ours).max(axis=2)
    inside = _inside(mesh, scale)
    calm = float(errors[inside].mean()) if inside.any() else 0.0
    edges = float(errors[~inside].mean()) if not inside.all() else 0.0
    return Difference(float(errors.mean()), int(errors[inside].max(initial=0)), edges - calm)


def _inside(mesh: Mesh, scale: int) -> np.ndarray:
    """Pixels that lie in one triangle with all their neighbours."""
    owners = np.full((mesh.height * scale, mesh.width * scale), -1, dtype=np.int32)
    label(scaled_positions(mesh, owners.shape[::-1]), mesh.triangles, owners)
    size = 2 * _REACH + 1
    same: np.ndarray = maximum_filter(owners, size) == minimum_filter(owners, size)
    return same & (owners >= 0)
