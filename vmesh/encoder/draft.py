"""The draft: a mesh of a picture whose number of vertices can still be changed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final, Protocol

import numpy as np

from vmesh.arrays import Int32Array
from vmesh.encoder.colors import fit_colors
from vmesh.encoder.image import peak_of
from vmesh.encoder.sampling import Samples
from vmesh.kernels.delaunay import delaunay
from vmesh.kernels.remeshing import WeightedImage

SUBDIVISION: Final = 1  # pixel centres lie on the lattice of half pixels
UNIT: Final = 1 << SUBDIVISION  # lattice units in a pixel


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
        self.resize(n)

    def resize(self, n_vertices: int) -> None:
        """Sample about this many vertices."""
        self._vertices = self._propose(n_vertices).vertices()
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
