"""How far a drawing is from our own raster: everywhere, inside of triangles, and on their edges."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from PIL import Image, ImageDraw
from scipy.ndimage import maximum_filter, minimum_filter

import vmesh
from vmesh.arrays import BoolArray, UInt8Array
from vmesh.formats.picture.conversion import flatten
from vmesh.mesh import Mesh

_REACH = 2  # pixels from an edge that count as on it


class Difference(NamedTuple):
    """Mean error, largest error away from edges, and mean error on edges over that elsewhere.

    Programs look at a pixel's centre, at its corner or anywhere between: away from edges an error
    is the distance to what the mesh shows within half a pixel around the centre.
    """

    mean: float
    inside: float
    seams: float


def compare(drawn: UInt8Array, mesh: Mesh, scale: int) -> Difference:
    """How far a drawing of shape (h, w, 3) is from our raster, on white, in levels."""
    ours = flatten(vmesh.render(mesh, scale=scale))
    errors = np.abs(drawn.astype(float) - ours).max(axis=2)
    inside = _inside(mesh, scale)
    low, high = (
        (side(ours, (3, 3, 1)) + 1.0 * ours) / 2 for side in (minimum_filter, maximum_filter)
    )
    beyond = np.maximum(np.maximum(low - drawn, drawn - high), 0).max(axis=2)
    calm = float(errors[inside].mean()) if inside.any() else 0.0
    edges = float(errors[~inside].mean()) if not inside.all() else 0.0
    return Difference(float(errors.mean()), float(beyond[inside].max(initial=0)), edges - calm)


def _inside(mesh: Mesh, scale: int) -> BoolArray:
    """Pixels that no edge of a triangle comes near."""
    near = Image.new("1", (mesh.width * scale, mesh.height * scale))
    draw = ImageDraw.Draw(near)
    corners = mesh.points[mesh.triangles] * scale
    for triangle in corners.reshape(-1, 6).tolist():
        draw.line([*triangle, *triangle[:2]], fill=1, width=2 * _REACH + 1)
    return ~np.asarray(near)
