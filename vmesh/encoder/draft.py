"""The draft: a mesh of a picture whose number of vertices can still be changed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final, Protocol

import numpy as np

from vmesh.arrays import Int32Array, Int64Array
from vmesh.encoder.colors import fit_colors
from vmesh.encoder.image import peak_of
from vmesh.encoder.sampling import Samples
from vmesh.grid import Grid
from vmesh.kernels.delaunay import delaunay
from vmesh.kernels.remeshing import WeightedImage
from vmesh.mesh.canonical_order import raster_keys

SUBDIVISION: Final = 1  # pixel centres lie on the lattice of half pixels
UNIT: Final = 1 << SUBDIVISION  # lattice units in a pixel

_SMALL_CHANGE: Final = 0.01  # of the number of vertices: nothing is sampled anew for it


class Draft(Protocol):
    """A mesh of a picture that is not final."""

    @property
    def n_vertices(self) -> int:
        """Number of vertices."""

    @property
    def error(self) -> float:
        """Squared error with fitted colours that are not rounded, summed over all samples."""

    def resize(self, n_vertices: int) -> None:
        """Change the number of vertices, as far as the picture allows."""

    def geometry(self) -> tuple[Int32Array, Int32Array]:
        """Vertices, (n, 2), and triangles, (m, 3), int32, in canonical order."""


class ThinnedDraft(Draft, Protocol):
    """A draft whose vertices can be removed up to a cost."""

    def thin(
        self, n_vertices: int, report: Callable[[], None], *, max_cost: float = np.inf
    ) -> None:
        """Remove the least useful vertices, down to a number or up to a squared error for each."""

    def thin_exactly(self, n_vertices: int) -> None:
        """Remove vertices until there are so many."""


def fewest_vertices(grid: Grid | None) -> int:
    """Number of the corners of a picture, or of its tiles."""
    return 4 if grid is None else (grid.columns + 1) * (grid.rows + 1)


def most_vertices(width: int, height: int, grid: Grid | None = None) -> int:
    """Number of vertices beyond which none can bring a mesh closer to a picture of this size."""
    return width * height + fewest_vertices(grid)


def dense_vertices(width: int, height: int) -> Int32Array:
    """Vertices at the centres of all pixels and the corners of the canvas, in raster order.

    A mesh of them holds every picture of this size without any error. The shape is (n, 2), int32,
    in half pixels.
    """
    y, x = np.mgrid[:height, :width]
    centres = np.stack([2 * x.ravel() + 1, 2 * y.ravel() + 1], axis=1)
    right, bottom = 2 * width, 2 * height
    above, below = [[0, 0], [right, 0]], [[0, bottom], [right, bottom]]
    return np.concatenate([above, centres, below]).astype(np.int32)


class SampledDraft:
    """A draft of vertices where they were sampled, and their Delaunay triangles.

    Parameters
    ----------
    image : WeightedImage
    propose : callable
        Samples of about a number of vertices.
    """

    def __init__(self, image: WeightedImage, propose: Callable[[int], Samples], n: int) -> None:
        self._image = image
        self._propose = propose
        self._vertices = dense_vertices(0, 0)
        self.n_vertices = 0
        self.resize(n)

    def resize(self, n_vertices: int) -> None:
        """Sample this many vertices, as far as the picture allows."""
        height, width = self._image.weights.shape
        n_vertices = min(max(n_vertices, 4), most_vertices(width, height))
        if n_vertices >= width * height:
            sampled = dense_vertices(width, height)
        elif abs(n_vertices - self.n_vertices) > _SMALL_CHANGE * self.n_vertices:
            sampled = self._propose(n_vertices).vertices()
        else:
            sampled = self._vertices
        self._vertices = _exactly(sampled, n_vertices, width, height)
        self._triangles = delaunay(self._vertices)
        self.n_vertices = len(self._vertices)
        colors, equations = fit_colors(self._image, self._vertices, self._triangles, UNIT)
        # At the solution of A'A c = A'y the squared error is y'y - c'A'y.
        # Not by a dot product, whose order of summing is that of a BLAS and its threads.
        fitted = sum(float((e.moments * colors[:, z]).sum()) for z, e in enumerate(equations))
        samples, weights = self._image
        squares = np.square(samples, dtype=np.float64)
        if samples.shape[2] == 4:
            squares[:, :, :3] *= samples[:, :, 3:] / peak_of(samples)
        squares *= weights[:, :, None]
        self.error = max(0.0, float(squares.sum()) - fitted)

    def geometry(self) -> tuple[Int32Array, Int32Array]:
        """Vertices, (n, 2), and triangles, (m, 3), int32, in canonical order."""
        return self._vertices, self._triangles


def _exactly(vertices: Int32Array, n_vertices: int, width: int, height: int) -> Int32Array:
    """Vertices of which some were left out, or others added, so that there are so many.

    They are taken from all over the picture; the corners of the canvas stay.
    """
    excess = len(vertices) - n_vertices
    if excess > 0:
        is_corner = ((vertices == 0) | (vertices == [2 * width, 2 * height])).all(axis=1)
        left_out = np.flatnonzero(~is_corner)[_spread(len(vertices) - 4, excess)]
        return np.delete(vertices, left_out, axis=0)
    if excess < 0:
        dense = dense_vertices(width, height)
        unused = dense[~np.isin(raster_keys(dense), raster_keys(vertices))]
        vertices = np.concatenate([vertices, unused[_spread(len(unused), -excess)]])
        vertices = vertices[np.argsort(raster_keys(vertices))]
    return vertices


def _spread(n_items: int, n: int) -> Int64Array:
    """Places of so many of some items, spread evenly over them."""
    places: Int64Array = (2 * np.arange(n) + 1) * n_items // (2 * n)
    return places
