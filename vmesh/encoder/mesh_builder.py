"""The mesh builder: fits the colours of a draft, and rounds them to levels worth their bits."""

from __future__ import annotations

from dataclasses import dataclass

from vmesh.color_lattice import ColorLattice
from vmesh.encoder.colors import fit_colors
from vmesh.encoder.draft import SUBDIVISION, UNIT, Draft
from vmesh.encoder.image import depth_of, peak_of
from vmesh.encoder.quantization import quantize
from vmesh.encoder.rate_model import lambda_of, luma_step
from vmesh.encoder.tiles.code_order import code_order
from vmesh.grid import Grid
from vmesh.kernels.remeshing import WeightedImage
from vmesh.mesh import Mesh, Metadata


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
        samples = self.image.samples
        height, width, n_components = samples.shape
        vertices, triangles = draft.geometry()
        colors, equations = fit_colors(self.image, vertices, triangles, UNIT)
        step = self.color_step
        if step is None:
            step = luma_step(draft.error, samples.size, peak_of(samples))
        lattice = ColorLattice.uniform(n_components, step, depth_of(samples))
        # A caller that asks for no rounding wants the fitted colours as they are.
        lambda_ = 0.0 if self.color_step == 1 else lambda_of(draft)
        hierarchy = code_order(vertices, self.grid, UNIT)
        levels = quantize(equations, colors, hierarchy, lattice, lambda_)
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
