"""Linear gradients as text: where they start and end, and the colours there.

A gradient is written in the unit square of its region's bounding box, in which its value is
a + b x + c y with b >= 0. It may start and end anywhere along the lines of one value, and before
and beyond the region as long as there are colours for the values there. Ends at 0 are not written::

    (0, 0)
      +-----------------+      c >= 0: from the corner (0, 0) to (x2, y2)
      | .   region      |      c < 0:  from (0, y1) to (x2, 0)
      |   .             |
      +-----.-----------+      Where the colour at such an end would not lie within 0 to 255, the
            (x2, y2)           gradient starts at the region's least value: three numbers.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from vmesh.arrays import Float64Array, Int64Array
from vmesh.formats.svg.layers import Layer
from vmesh.formats.svg.outlines import Outlines
from vmesh.formats.svg.regions import Slopes

_FARTHEST: Final = 10.0  # of an end, in boxes
_MOST_DIGITS: Final = 4
_NAMES: Final = ("x1", "y1", "x2", "y2")
_DEFAULTS: Final = (0, 0, 1, 0)


def gradient_bodies(layer: Layer, unit: int) -> tuple[Int64Array, list[str]]:
    """Regions for which a flat colour will not do, and the content of their gradient elements.

    Parameters
    ----------
    layer : Layer
        With outlines in units of 1 / `unit` pixel.

    Returns
    -------
    worth : ndarray
        Shape (k,), int64, ascending.
    bodies : list of str
        Attributes and content of each, from after the id on.
    """
    outlines = layer.outlines
    spans = _spans(layer.fits, outlines, unit)
    worth = np.flatnonzero(spans[:, 1] - spans[:, 0] >= layer.smallest_range)
    fits, spans = layer.fits.take(worth), spans[worth]
    gamut = _gamut(fits, spans)
    plane = _plane(fits, outlines.boxes[worth] / unit)
    ends = _rounded(_ends(plane, spans, gamut), plane, layer.rounding)
    reached = _kept_in(plane[:, :1] + (ends * plane[:, None, 1:]).sum(axis=2), gamut)
    colors = fits.middles[:, None] + fits.axes[:, None] * reached[:, :, None]
    texts = (hex_colors(colors[:, 0]), hex_colors(colors[:, 1]))
    bodies = [
        f'{places}><stop stop-color="{first}"/><stop offset="1" stop-color="{last}"/>'
        for places, first, last in zip(_attributes(ends), *texts, strict=True)
    ]
    return worth, bodies


def _spans(fits: Slopes, outlines: Outlines, unit: int) -> Float64Array:
    """Least and largest value on each region, shape (n, 2)."""
    owners = outlines.owners
    apart = outlines.bounds / unit - fits.centers[owners]
    values = (apart * fits.slopes[owners]).sum(axis=1)
    low = np.minimum.reduceat(values, outlines.starts)
    high = np.maximum.reduceat(values, outlines.starts)
    return np.stack([low, high], axis=1)


def _plane(fits: Slopes, boxes: Float64Array) -> Float64Array:
    """Values a + b x + c y in the unit squares of boxes, shape (n, 3)."""
    corner = ((boxes[:, :2] - fits.centers) * fits.slopes).sum(axis=1)
    return np.concatenate([corner[:, None], fits.slopes * boxes[:, 2:]], axis=1)


def _gamut(fits: Slopes, spans: Float64Array) -> Float64Array:
    """Least and largest value that a gradient may end with, shape (n, 2).

    These are the values that have colours, and those of the region even where a channel lies
    slightly beyond 0 or 255: clipping that channel alone changes less than ending the gradient
    early.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        bounds = np.sort([-fits.middles / fits.axes, (255 - fits.middles) / fits.axes], axis=0)
    low, high = np.where(fits.axes == 0, [[[-np.inf]], [[np.inf]]], bounds)
    low, high = low.max(axis=1), high.min(axis=1)
    return np.stack([np.minimum(low, spans[:, 0]), np.maximum(high, spans[:, 1])], axis=1)


def _kept_in(values: Float64Array, gamut: Float64Array) -> Float64Array:
    """Values of shape (n, 2), clipped to those that have colours."""
    return values.clip(gamut[:, :1], gamut[:, 1:])


def _ends(plane: Float64Array, spans: Float64Array, gamut: Float64Array) -> Float64Array:
    """Start and end of each gradient in the unit square, shape (n, 2, 2)."""
    a, b, c = plane.T
    low, high = spans.T
    steepness = b * b + c * c
    none = np.zeros_like(a)
    with np.errstate(divide="ignore", invalid="ignore"):
        along = plane[:, 1:] / steepness[:, None]
        start = np.where(
            (b > np.abs(c))[:, None],
            np.stack([(low - a) / b, none], axis=1),
            np.stack([none, (low - a) / c], axis=1),
        )
        general = np.stack([start, start + along * (high - low)[:, None]], axis=1)
        down = np.stack([np.zeros_like(along), along * (high - a)[:, None]], axis=1)
        reach = np.maximum((a - low) / (c * c), (high - a) / (b * b))
        up = np.stack([none, -reach * c, reach * b, none], axis=1).reshape(-1, 2, 2)
        is_up = (c < 0) & (a - reach * c * c >= gamut[:, 0]) & (a + reach * b * b <= gamut[:, 1])
        is_up &= reach * np.maximum(b, -c) < _FARTHEST
    is_down = (c >= 0) & (a >= gamut[:, 0])
    choices = (is_down[:, None, None], is_up[:, None, None])
    return np.select(choices, (down, up), general)


def _rounded(ends: Float64Array, plane: Float64Array, tolerance: float) -> Float64Array:
    """Ends with as many decimals as steep gradients need."""
    steepest = np.hypot(plane[:, 1], plane[:, 2])
    digits = np.ceil(np.log10(0.5 * steepest / tolerance)).clip(1, _MOST_DIGITS)
    factors = 10 ** digits[:, None, None]
    rounded: Float64Array = np.rint(ends * factors) / factors
    return rounded


def _attributes(ends: Float64Array) -> Iterator[str]:
    """Attributes of the ends of each gradient."""
    places = np.rint(ends * 10**_MOST_DIGITS).astype(np.int64).reshape(-1, 4).T
    columns = map(_attribute, _NAMES, _DEFAULTS, places)
    return map("".join, zip(*columns, strict=True))


def _attribute(name: str, default: int, places: Int64Array) -> list[str]:
    """One attribute of each gradient, empty where it is left out; in units of the last decimal."""
    numbers, which = np.unique(places, return_inverse=True)
    texts = [
        "" if number == default * 10**_MOST_DIGITS else f' {name}="{_decimal(number)}"'
        for number in numbers.tolist()
    ]
    return [texts[i] for i in which.tolist()]


def _decimal(place: int) -> str:
    """Shortest text of a number of units of the last decimal."""
    whole, part = divmod(abs(place), 10**_MOST_DIGITS)
    decimals = f".{part:0{_MOST_DIGITS}d}".rstrip("0").rstrip(".")
    return f"{'-' if place < 0 else ''}{whole or ('' if decimals else '0')}{decimals}"


def hex_colors(colors: Float64Array) -> list[str]:
    """SVG notation of colours of shape (n, 3), short where it can be."""
    levels = np.rint(np.clip(colors, 0, 255)).astype(np.uint8)
    digits = levels.tobytes().hex()
    steps = np.where((levels % 17 == 0).all(axis=1), 2, 1).tolist()
    return [f"#{digits[6 * i : 6 * i + 6 : step]}" for i, step in enumerate(steps)]
