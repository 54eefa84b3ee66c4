"""The mesh builder: fits the colours of a draft, and rounds them to levels worth their bits."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np

from vmesh.arrays import Float64Array, Int32Array
from vmesh.codec.hierarchy import Hierarchy
from vmesh.color_lattice import ColorLattice
from vmesh.encoder.colors import NormalEquations, fit_colors
from vmesh.encoder.draft import SUBDIVISION, UNIT, Draft
from vmesh.encoder.image import depth_of, peak_of
from vmesh.encoder.quantization import quantize
from vmesh.encoder.rate_model import exact_luma_step, lambda_of, luma_step
from vmesh.encoder.tiles.code_order import code_order
from vmesh.grid import Grid
from vmesh.kernels.remeshing import WeightedImage
from vmesh.mesh import Mesh, Metadata

_FINE: Final = 100  # a luma step at which the ratios of all steps can be read off


class Fit(NamedTuple):
    """A draft with fitted colours that are not rounded yet."""

    vertices: Int32Array
    triangles: Int32Array
    colors: Float64Array
    equations: list[NormalEquations]
    hierarchy: Hierarchy
    error: float


@dataclass(frozen=True, slots=True)
class MeshBuilder:
    """Builder of meshes from drafts.

    Parameters
    ----------
    image : WeightedImage
    metadata : Metadata
    color_step : int or None
        Step of the luma lattice; None lets the error decide.
    grid : Grid, optional
        The tiles that files of the meshes are made of.
    """

    image: WeightedImage
    metadata: Metadata
    color_step: int | None
    grid: Grid | None = None

    def build(self, draft: Draft) -> Mesh:
        """Mesh of a draft: colours fitted and rounded to levels that are worth their bits."""
        fit = self.fit(draft)
        step = luma_step(fit.error, self.image.samples.size, peak_of(self.image.samples))
        return self._rounded(fit, self._lattice(self.color_step or step), lambda_of(draft))

    def fit(self, draft: Draft) -> Fit:
        """A draft's geometry and fitted colours, and the order of a file."""
        vertices, triangles = draft.geometry()
        colors, equations = fit_colors(self.image, vertices, triangles, UNIT)
        hierarchy = code_order(vertices, self.grid, UNIT)
        return Fit(vertices, triangles, colors, equations, hierarchy, draft.error)

    def rounded(self, fit: Fit, error: float, lambda_: float) -> Mesh:
        """Mesh in colours as coarse as suits a squared error and what a bit is worth.

        Neither need be that of the draft, and the components' steps grow one by one with the error.
        """
        samples = self.image.samples
        if self.color_step is not None:
            return self._rounded(fit, self._lattice(self.color_step), lambda_)
        exact = exact_luma_step(error, samples.size)
        ratios = self._lattice(_FINE).steps
        steps = (min(max(round(exact * ratio / _FINE), 1), peak_of(samples)) for ratio in ratios)
        return self._rounded(fit, ColorLattice(tuple(steps), depth_of(samples)), lambda_)

    def _rounded(self, fit: Fit, lattice: ColorLattice, lambda_: float) -> Mesh:
        # A caller that asks for no rounding wants the fitted colours as they are.
        if self.color_step == 1:
            lambda_ = 0.0
        levels = quantize(fit.equations, fit.colors, fit.hierarchy, lattice, lambda_)
        return self._mesh(fit, lattice, levels)

    def finest(self, fit: Fit) -> Mesh:
        """Mesh whose colours are the nearest to the fitted ones, in the finest steps."""
        lattice = self._lattice(self.color_step or 1)
        return self._mesh(fit, lattice, lattice.levels_from_colors(np.rint(fit.colors)))

    def _lattice(self, step: int) -> ColorLattice:
        samples = self.image.samples
        return ColorLattice.uniform(samples.shape[2], step, depth_of(samples))

    def _mesh(self, fit: Fit, lattice: ColorLattice, levels: Int32Array) -> Mesh:
        height, width = self.image.weights.shape
        return Mesh(
            width,
            height,
            fit.vertices,
            fit.triangles,
            levels,
            lattice,
            SUBDIVISION,
            self.metadata,
            self.grid.side if self.grid else None,
        )
