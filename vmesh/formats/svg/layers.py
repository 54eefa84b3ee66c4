"""Layers of a drawing: regions that are painted over one another, and their paint.

A layer paints regions, each with one gradient or flat colour. Where one gradient will not do, the
first layer shows a part of a triangle's colours, and two more layers its other parts (`parts.py`).

References
----------
G. M. Morton, "A computer oriented geodetic data base and a new technique in file sequencing", IBM,
1966: the Z-curve.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from vmesh.arrays import Float64Array, Int64Array
from vmesh.formats.svg.outlines import Outlines, outlines_of
from vmesh.formats.svg.parts import paints_in_parts
from vmesh.formats.svg.regions import Moments, Slopes, merge
from vmesh.formats.svg.style import Style
from vmesh.mesh import Mesh

_SMALLEST_RANGE: Final = 0.5  # levels: less than that a flat colour shows as well
_ROUNDING: Final = 0.5  # levels that rounded ends of gradients may add, and where they are exact
_EXACT_ROUNDING: Final = 0.1
_FLAT_SHARE: Final = 0.25  # of the tolerance, for flat colours
_RESERVE: Final = 1.0  # levels of the tolerance that are left to the rounding of colours and ends
_CURVE_BITS: Final = 17  # of a place in half pixels


@dataclass(frozen=True, slots=True)
class Layer:
    """Regions and their paint.

    Parameters
    ----------
    outlines : Outlines
        Outlines of the regions.
    fits : Slopes
        The gradients that fit them best.
    smallest_range : float
        Levels between the ends of a gradient; below it a flat colour will do.
    rounding : float
        Levels by which rounded ends may change a colour.
    """

    outlines: Outlines
    fits: Slopes
    smallest_range: float
    rounding: float


def layers_of(mesh: Mesh, moments: Moments, style: Style) -> list[Layer]:
    """Layers of a mesh in the order of painting; of the second and third what is lighter shows.

    `moments` are those of the colours of its triangles.
    """
    split = np.zeros(mesh.n_triangles, dtype=bool)
    smallest, rounding = _SMALLEST_RANGE, _ROUNDING
    regions = np.arange(mesh.n_triangles)
    if style.mode == "flat":
        smallest = np.inf
    elif style.mode == "gradient":
        regions, moments = merge(mesh, moments, style.merge)
        split = np.zeros(len(moments.weights), dtype=bool)
    elif style.mode == "exact":
        split[:] = mesh.n_components > 1
        rounding = _EXACT_ROUNDING
    else:
        # A flat colour errs by what a gradient shows and by what the gradient leaves.
        smallest = max(smallest, _FLAT_SHARE * style.tolerance)
        split = _farthest(mesh, moments) > style.tolerance - smallest - _RESERVE
    order = _morton_order(moments.means[:, :2])
    # Pixels on an edge go to what is painted last. Split triangles come after all others, so that
    # they win these pixels on the first layer as they do on the layers that they alone are on.
    order = order[np.argsort(split[order], kind="stable")]
    regions, moments, split = np.argsort(order)[regions], moments.take(order), split[order]
    trapped = style.seams == "trapping"
    outlines = outlines_of(mesh, regions, trapped=trapped)
    if not split.any():
        return [Layer(outlines, Slopes.fitted(moments), smallest, rounding)]
    n_whole = np.count_nonzero(~split)
    # What is split are triangles, never merged, which are painted in this order.
    corners = mesh.points[mesh.triangles[order[n_whole:]]]
    parts = paints_in_parts(moments.take(np.arange(n_whole, len(split))), corners)
    whole = Slopes.fitted(moments.take(np.arange(n_whole)))
    layers = [Layer(outlines, whole.followed_by(parts[0]), smallest, rounding)]
    if n_whole:
        outlines = outlines_of(mesh, np.maximum(regions - n_whole, -1), trapped=trapped)
    layers += [Layer(outlines, part, smallest, rounding) for part in parts[1:]]
    return layers


def _farthest(mesh: Mesh, moments: Moments) -> Float64Array:
    """Largest error in any channel that each triangle's gradient leaves, shape (m,), in levels."""
    fits = Slopes.fitted(moments)
    maps = moments.maps()
    apart = mesh.points[mesh.triangles] - fits.centers[:, None]
    rank_one = fits.slopes[:, :, None] * fits.axes[:, None]
    errors: Float64Array = np.abs(apart @ (maps - rank_one)).max(axis=(1, 2))
    return errors


def _morton_order(points: Float64Array) -> Int64Array:
    """Order of points along a Z-curve, by half pixels: what is near in it compresses well."""
    x, y = np.rint(2 * points.T).astype(np.int64)
    keys = np.zeros_like(x)
    for bit in range(_CURVE_BITS):
        keys |= ((x >> bit & 1) << 2 * bit) | ((y >> bit & 1) << 2 * bit + 1)
    return np.argsort(keys, kind="stable")
