"""Layers of a drawing: regions that are painted over one another, and their paint.

A layer paints regions, each with one gradient or flat colour. Where one gradient will not do, the
first layer shows the red of a triangle and two more, which are *screened* onto it, its green and
its blue: a single channel is exact, and the screen of colours that have no channel in common is
their sum.

References
----------
W3C, "Compositing and Blending Level 1": the blend mode screen. G. M. Morton, "A computer oriented
geodetic data base and a new technique in file sequencing", IBM, 1966: the Z-curve.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from vmesh.arrays import Float64Array, Int64Array
from vmesh.formats.svg.outlines import Outlines, outlines_of
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
    """Layers of a mesh in the order of painting; the second and third are screened.

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
    layers = [Layer(outlines, Slopes.fitted(moments.of_channel(0, split)), smallest, rounding)]
    if split.any():
        if not split.all():
            numbers = np.where(split, np.cumsum(split) - 1, -1)
            outlines = outlines_of(mesh, numbers[regions], trapped=trapped)
        parts = moments.take(np.flatnonzero(split))
        for channel in (1, 2):
            fits = Slopes.fitted(parts.of_channel(channel, np.ones(len(parts.weights), dtype=bool)))
            layers.append(Layer(outlines, fits, smallest, rounding))
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
