"""Affine maps of a canvas, and the box of whole pixels that the moved canvas is put into."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from vmesh.arrays import Float64Array
from vmesh.limits import MAX_SIDE

Matrix = Sequence[float]
"""An affine map ``(a, b, c, d, e, f)`` in SVG's order: x' = a x + c y + e, y' = b x + d y + f."""

_LARGEST_ENTRY: Final = 1e9


@dataclass(frozen=True, slots=True)
class Placement:
    """An affine map of a canvas into the whole-pixel box around it.

    Parameters
    ----------
    width, height : int
        Size of the box in pixels.
    linear : ndarray
        Shape (2, 2), float64.
    offset : ndarray
        Shape (2,), float64, in pixels.
    fills : bool
        Whether the moved canvas fills the box.
    """

    width: int
    height: int
    linear: Float64Array
    offset: Float64Array
    fills: bool

    @classmethod
    def of(cls, width: int, height: int, matrix: Matrix) -> Placement:
        """Placement by a matrix of a canvas of `width` x `height` pixels.

        A map that keeps the canvas upright is stretched by less than half a pixel so that it
        fills its box.
        """
        values = np.asarray(matrix, dtype=np.float64)
        if values.shape != (6,) or not (np.abs(values) <= _LARGEST_ENTRY).all():
            raise ValueError(
                f"expected a matrix of six finite numbers up to {_LARGEST_ENTRY:g}, got {matrix!r}"
            )
        linear = values[:4].reshape(2, 2).T
        if abs(np.linalg.det(linear)) < 1e-12:
            raise ValueError("the matrix is singular: it would flatten the mesh")
        canvas = np.array([[0, 0], [width, 0], [0, height], [width, height]]) @ linear.T
        low, extent = canvas.min(axis=0), np.ptp(canvas, axis=0)
        fills = not linear[[0, 1], [1, 0]].any() or not linear[[0, 1], [0, 1]].any()
        size = np.maximum(np.rint(extent) if fills else np.ceil(extent - 1e-9), 1)
        if size.max() > MAX_SIDE:
            raise ValueError(f"the moved canvas is wider or higher than {MAX_SIDE} pixels")
        stretch = size / extent if fills else np.ones(2)
        return cls(
            int(size[0]), int(size[1]), linear * stretch[:, None], -low * stretch, bool(fills)
        )

    @property
    def keeps_turn(self) -> bool:
        """Orientation of triangles: true if it stays, false if the map reflects them."""
        return bool(np.linalg.det(self.linear) > 0)

    def move(self, points: Float64Array) -> Float64Array:
        """Points of shape (n, 2) in the box, in pixels."""
        moved: Float64Array = points @ self.linear.T + self.offset
        return moved
