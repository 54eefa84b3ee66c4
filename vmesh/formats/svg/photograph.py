"""The photograph under a mesh, to which its regions are fitted in place of the mesh's colours.

A triangle's moments are those of the pixels whose centres it holds. The mesh's own moments count
beside them as much as `_OWN_WEIGHT` pixels: they decide where there are too few pixels for a
gradient, or none.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from vmesh.arrays import Float64Array, Int32Array, SampleArray, UInt8Array
from vmesh.color_lattice import rescale
from vmesh.formats.raster.rendering import scaled_positions
from vmesh.formats.svg.regions import Moments
from vmesh.kernels.scanline import label
from vmesh.mesh import Mesh

_OWN_WEIGHT: Final = 1.0
# In 1/256 pixel: a centre on an edge or a vertex counts in part for the triangles around it, since
# each program has its own rule. Worth 1.2 dB at 20,000 adaptive vertices, which are centres.
_NUDGES: Final = ((-1, -1), (1, -1), (-1, 1), (1, 1))
_BAND_PIXELS: Final = 1 << 20  # that are summed at a time


@dataclass(frozen=True, slots=True)
class Photograph:
    """Colours of pixels, and how much they count.

    Parameters
    ----------
    samples : ndarray
        Shape (h, w, 3), uint8.
    weights : ndarray
        Shape (h, w), uint8: 0 for pixels that do not show, to 255.
    """

    samples: UInt8Array
    weights: UInt8Array

    def moments(self, mesh: Mesh, own: Moments) -> Moments:
        """Moments of the pixels of each triangle, with its own for what they leave open."""
        # Sums are taken about the means of the mesh, so that no digits are lost.
        origins = np.concatenate([own.means, np.zeros((1, 5))])
        n, weights = len(origins), np.zeros(len(origins))
        firsts, seconds = np.zeros((n, 5)), np.zeros((n, 5, 5))
        for rows, holders, counts in self._holders(mesh):
            apart = self._positions_and_colors(rows) - origins[holders].T
            weights += np.bincount(holders, counts, n)
            for i, values in enumerate(apart):
                weighted = values * counts
                firsts[:, i] += np.bincount(holders, weighted, n)
                for j in range(i + 1):
                    seconds[:, i, j] += np.bincount(holders, weighted * apart[j], n)
                    seconds[:, j, i] = seconds[:, i, j]
        shares = firsts / np.maximum(weights, 1e-9)[:, None]
        scatters = seconds - firsts[:, :, None] * shares[:, None]
        seen = Moments(weights[:-1], own.means + shares[:-1], scatters[:-1])
        return own.scaled(_OWN_WEIGHT / own.weights).joined(seen)

    def _holders(self, mesh: Mesh) -> Iterator[tuple[slice, Int32Array, Float64Array]]:
        """Rows that are summed at a time, the triangle of each pixel, and how much it counts."""
        height, width = self.weights.shape
        positions = scaled_positions(mesh, (width, height))
        step = max(1, _BAND_PIXELS // width)
        for nudge in _NUDGES:
            owners = np.full((height, width), mesh.n_triangles, dtype=np.int32)
            label(positions + np.array(nudge), mesh.triangles, owners)
            for first in range(0, height, step):
                rows = slice(first, min(first + step, height))
                counts = self.weights[rows].ravel() / (255 * len(_NUDGES))
                yield rows, owners[rows].ravel(), counts

    def _positions_and_colors(self, rows: slice) -> Float64Array:
        """Centre and colour of each pixel of some rows, shape (5, n)."""
        y, x = np.mgrid[rows, : self.weights.shape[1]] + 0.5
        return np.stack([x, y, *np.moveaxis(self.samples[rows], 2, 0)]).reshape(5, -1)


def rgba_of(mesh: Mesh, photograph: SampleArray) -> UInt8Array:
    """A photograph in the 8 bits of a drawing, shape (h, w, 4), uint8.

    Raises
    ------
    ValueError
        If it does not have the size of the mesh's canvas, or is no picture.
    """
    array = np.asarray(photograph)
    if array.dtype not in (np.uint8, np.uint16) or not (
        array.ndim == 2 or (array.ndim == 3 and array.shape[2] in (1, 3, 4))
    ):
        raise ValueError(
            "expected a photograph of shape (h, w), (h, w, 3) or (h, w, 4), uint8 or uint16, "
            f"got shape {array.shape} of {array.dtype}"
        )
    if array.shape[:2] != (mesh.height, mesh.width):
        raise ValueError(
            f"expected a photograph of the mesh's size, {mesh.width} x {mesh.height} pixels, "
            f"got {array.shape[1]} x {array.shape[0]}"
        )
    samples = rescale(array, 8 * array.dtype.itemsize, 8).reshape(*array.shape[:2], -1)
    rgba = np.full((*array.shape[:2], 4), 255, dtype=np.uint8)
    if samples.shape[2] == 4:
        return samples
    rgba[:, :, :3] = samples
    return rgba
