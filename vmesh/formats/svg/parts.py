"""Parts of a picture that are painted one over the other, of which the lighter shows.

Three linear gradients show a triangle as it is, each one channel: the lighter of colours that have
no channel in common is their sum. The last of the three is more than its own channel, so that it
is about the picture where a program knows no blend modes and shows nothing else. It has the other
channels too, as far as they go with the direction of its own, and nowhere lighter than they are::

    first     second    third
    R         0         R' <= R
    0         0         G                the lighter of all:  R, G, B
    0         B         B' <= B

References
----------
W3C, "Compositing and Blending Level 1": the blend mode lighten.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from vmesh.arrays import Float64Array
from vmesh.formats.svg.regions import Moments, Slopes

# The channels that are painted first and second where the third is red, green, blue.
_EARLIER: Final = np.array([(1, 2), (0, 2), (0, 1)])


def paints_in_parts(moments: Moments, corners: Float64Array) -> list[Slopes]:
    """The three gradients of each triangle, in the order of painting.

    Parameters
    ----------
    moments : Moments
        Moments of n triangles.
    corners : ndarray
        Shape (n, 3, 2), float64: their corners in pixels.
    """
    covers = [_cover(moments, corners, channel) for channel in range(3)]
    # Each triangle ends with the channel whose cover is the closest to all three.
    chosen = np.argmin([errors for _, errors in covers], axis=0)
    earlier = [Slopes.fitted(moments.of_channels(each)) for each in _EARLIER[chosen].T]
    return [*earlier, Slopes.chosen([cover for cover, _ in covers], chosen)]


def _cover(moments: Moments, corners: Float64Array, channel: int) -> tuple[Slopes, Float64Array]:
    """Gradients that show one channel and of the others what they can, and their squared errors.

    Along the direction of that channel another has the slope that fits it best, and is darker by
    the most that it would be too light at a corner. Where it would be darker than black it is black
    at the end, and as steep from there as it may be.
    """
    maps, scatters = moments.maps(), moments.scatters[:, :2, :2]
    apart = corners - moments.means[:, None, :2]
    shown = apart @ maps + moments.means[:, None, 2:]  # at the corners
    along = _unit(maps[:, :, channel])
    spread = np.einsum("ni,nij,nj->n", along, scatters, along)
    crossed = np.einsum("ni,nij,njk->nk", along, scatters, maps)
    rates = crossed / np.where(spread > 0, spread, 1)[:, None]
    places = apart @ along[:, :, None]
    steps = places * rates[:, None]
    middles = (shown - steps).min(axis=1)
    lowest = steps.min(axis=1)
    is_black = middles + lowest < 0
    is_black[:, channel] = False
    heights = steps - lowest[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        shares = np.where(heights > 0, shown / heights, 1).min(axis=1).clip(0, 1)
    rates *= np.where(is_black, shares, 1)
    middles = np.where(is_black, -shares * lowest, middles)
    left = maps - along[:, :, None] * rates[:, None]
    errors = np.einsum("nik,nij,njk->n", left, scatters, left)
    errors += moments.weights * np.square(moments.means[:, 2:] - middles).sum(axis=1)
    axes = _unit(rates)
    slopes = along * (rates * axes).sum(axis=1, keepdims=True)
    return Slopes(moments.means[:, :2], middles, axes, slopes).turned(), errors


def _unit(vectors: Float64Array) -> Float64Array:
    """Vectors of shape (n, k) with a length of 1, or 0 as they were."""
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    unit: Float64Array = vectors / np.where(lengths > 0, lengths, 1)
    return unit
