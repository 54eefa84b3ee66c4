"""Vertex colours as other programs write them -> RGBA of 8 bits.

PLY and OBJ do not say what their largest value is, and programs differ. Bytes count to 255. Other
integers do too if none is larger, else those of 16 bits count to 65,535. Fractions count to 1 or,
if they are larger, to 255. What could be either is refused.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from vmesh.arrays import Float64Array, UInt8Array
from vmesh.errors import MeshError

# Largest value -> what arithmetic may add to it or take from 0.
_SLACK: Final = {1: 0.05, 255: 0.5, 65535: 0}
# Fractions below this and above 1 may be light beyond white, or nearly black.
_LEAST_OF_255: Final = 8
_CHANNELS: Final = (
    ("red", "green", "blue", "alpha"),
    ("diffuse_red", "diffuse_green", "diffuse_blue", "diffuse_alpha"),
    ("r", "g", "b", "a"),
)


def colors_of_properties(properties: Mapping[str, npt.NDArray[Any]]) -> UInt8Array | None:
    """RGBA of vertices by the properties of a PLY file; none if there are no colours among them.

    Parameters
    ----------
    properties : mapping
        Names, and arrays with a value for each of n vertices.

    Returns
    -------
    ndarray or None
        Shape (n, 4), uint8.

    Raises
    ------
    MeshError
        If the values fit no range.
    """
    for *names, opacity in _CHANNELS:
        if all(name in properties for name in names):
            rgb = [np.ravel(properties[name]) for name in names]
            alpha = np.ravel(properties[opacity]) if opacity in properties else None
            return rgba_of(rgb, alpha)
    return None


def rgba_of(rgb: Sequence[npt.NDArray[Any]], alpha: npt.NDArray[Any] | None = None) -> UInt8Array:
    """RGBA of three arrays of n values, and of opacities with a range of their own.

    Returns
    -------
    ndarray
        Shape (n, 4), uint8.

    Raises
    ------
    MeshError
        If a value is no number, or they fit no range.
    """
    rgba = np.full((len(rgb[0]), 4), 255, dtype=np.uint8)
    rgba[:, :3] = _in_8_bits(np.column_stack(rgb))
    if alpha is not None:
        rgba[:, 3] = _in_8_bits(alpha)
    return rgba


def check_unit(values: Float64Array) -> None:
    """Raise :class:`MeshError` unless colours are numbers from 0 to 1, or beyond by a trifle."""
    low, high = _span(values)
    if not -_SLACK[1] <= low <= high <= 1 + _SLACK[1]:
        raise MeshError(f"expected colours from 0 to 1, got {low:g} to {high:g}")


def _in_8_bits(values: npt.NDArray[Any]) -> UInt8Array:
    """Values of any type and range in 8 bits."""
    if values.dtype == np.uint8:
        return values
    low, high = _span(values)
    ranges: tuple[int, ...] = (255, 65535) if values.dtype.str[1:] == "u2" else (255,)
    if values.dtype.kind == "f":
        is_clear = high >= _LEAST_OF_255 or (values == np.rint(values)).all()
        ranges = (1, 255) if is_clear else (1,)
    for largest in ranges:
        if -_SLACK[largest] <= low and high <= largest + _SLACK[largest]:
            levels = np.clip(values.astype(np.float64) * (255 / largest), 0, 255)
            return np.rint(levels).astype(np.uint8)
    raise MeshError(
        f"expected colours from 0 to 1, or to 255, or 16-bit integers, got {low:g} to {high:g}"
    )


def _span(values: npt.NDArray[Any]) -> tuple[float, float]:
    """Least and largest of some values, or 0."""
    if not np.isfinite(values).all():
        raise MeshError("a colour is not a number")
    return float(values.min(initial=0)), float(values.max(initial=0))
