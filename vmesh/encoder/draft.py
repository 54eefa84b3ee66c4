"""Drafts: meshes of a picture whose number of vertices can still be changed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import sqrt
from typing import Final, Protocol

import numpy as np

from vmesh.arrays import Int32Array, SampleArray
from vmesh.color_lattice import ColorLattice
from vmesh.encoder.colors import fit_colors
from vmesh.encoder.image import depth_of, peak_of
from vmesh.encoder.quantization import quantize
from vmesh.encoder.sampling import Samples
from vmesh.encoder.tiles.code_order import code_order
from vmesh.grid import Grid
from vmesh.kernels.delaunay import delaunay
from vmesh.mesh import Mesh, Metadata

SUBDIVISION: Final = 1  # pixel centres lie on the lattice of half pixels
UNIT: Final = 1 << SUBDIVISION  # lattice units in a pixel

# The luma step for a root mean square error of 1. Measured on four photographs at three densities
# each: 0.8, 1.0, 1.3 and 1.7 times as much change the PSNR at equal bytes by -0.03, 0, -0.04 and
# -0.19 dB.
_STEP: Final = 1.08
# The error falls with about the 0.85th power of the vertices, and a vertex takes about 19 bits:
# what a bit is worth in squared error, for an error and a number of vertices.
_PRICE: Final = 0.045
SAMPLED_POWER: Final = 1.6
"""The price of a bit falls with about this power of the number of sampled vertices."""


class Draft(Protocol):
    """A mesh of a picture that is not final yet."""

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


def price_of(draft: Draft) -> float:
    """Squared error that a bit is worth at a draft's number of vertices."""
    return _PRICE * draft.error / draft.n_vertices


class SampledDraft:
    """Vertices as they were sampled, and their Delaunay triangles.

    Parameters
    ----------
    image : ndarray
        Shape (h, w, c), uint8 or uint16.
    propose : callable
        Samples of about a number of vertices.
    """

    def __init__(self, image: SampleArray, propose: Callable[[int], Samples], n: int) -> None:
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
        fitted = sum(float(e.moments @ colors[:, z]) for z, e in enumerate(equations))
        squares = np.square(self._image, dtype=np.float64)
        if self._image.shape[2] == 4:
            squares[:, :, :3] *= self._image[:, :, 3:] / peak_of(self._image)
        self.error = max(0.0, float(squares.sum()) - fitted)

    def geometry(self) -> tuple[Int32Array, Int32Array]:
        """Vertices, (n, 2), and triangles, (m, 3), int32, in canonical order."""
        return self._vertices, self._triangles


@dataclass(frozen=True, slots=True)
class Finisher:
    """Makes meshes of drafts.

    Parameters
    ----------
    image : ndarray
        Shape (h, w, c), uint8 or uint16.
    metadata : Metadata
    color_step : int or None
        Step of the luma lattice; None lets the error decide.
    grid : Grid, optional
        The tiles that files of the meshes are made of.
    """

    image: SampleArray
    metadata: Metadata
    color_step: int | None
    grid: Grid | None = None

    def finish(self, draft: Draft) -> Mesh:
        """Mesh of a draft: colours fitted and rounded to levels that are worth their bits."""
        height, width, n_components = self.image.shape
        vertices, triangles = draft.geometry()
        colors, equations = fit_colors(self.image, vertices, triangles, UNIT)
        step = self.color_step
        if step is None:
            step = round(_STEP * sqrt(draft.error / self.image.size))
            step = min(max(step, 1), peak_of(self.image))
        lattice = ColorLattice.uniform(n_components, step, depth_of(self.image))
        # Who asks for no rounding wants the fitted colours as they are.
        price = 0.0 if self.color_step == 1 else price_of(draft)
        hierarchy = code_order(vertices, self.grid, UNIT)
        levels = quantize(equations, colors, hierarchy, lattice, price)
        return Mesh(
            width,
            height,
            vertices,
            triangles,
            levels,
            lattice,
            SUBDIVISION,
            self.metadata,
            self.grid.side if self.grid else None,
        )
