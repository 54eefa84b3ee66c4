"""The encoder, from top to bottom: pixels -> Mesh."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from vmesh.arrays import SampleArray
from vmesh.color_lattice import ColorLattice
from vmesh.encoder.colors import fit_colors, sample_colors
from vmesh.encoder.draft import SUBDIVISION, UNIT, Draft
from vmesh.encoder.effort import EFFORTS
from vmesh.encoder.image import as_image, depth_of, peak_of, with_hidden_colors_replaced
from vmesh.encoder.mesh_builder import MeshBuilder
from vmesh.encoder.proposals import propose
from vmesh.encoder.rate_control import meet_psnr, meet_size, refined_vertices
from vmesh.encoder.remeshing import Remesher
from vmesh.encoder.settings import Settings
from vmesh.encoder.starting_mesh import sampled_draft, sampled_tiles, thinned, thinned_tiles
from vmesh.encoder.threads import Run, workers
from vmesh.encoder.tiles.tiled_draft import REPORTS, TiledRemesher
from vmesh.grid import Grid
from vmesh.kernels.delaunay import delaunay
from vmesh.mesh import Mesh, Metadata
from vmesh.progress import Progress, silent

STAGES: Final = ("sampling", "thinning", "refinement", "colors", "rate control")

_THINNING_REPORTS: Final = 4  # about

_BLUE_NOISE_STEP: Final = 8


def encode(
    array: npt.ArrayLike,
    *,
    metadata: Metadata | None = None,
    progress: Progress | None = None,
    **settings: Any,
) -> Mesh:
    """Mesh of a picture.

    Parameters
    ----------
    array : array_like
        Shape (h, w), (h, w, 3) or (h, w, 4), uint8 or uint16: grey, RGB or RGBA, alpha not
        multiplied. The mesh has samples of as many bits.
    metadata : Metadata, optional
        What travels with the picture.
    progress : callable, optional
        Called with the name of each of `STAGES` as it begins, and again as it goes on.
    **settings
        Fields of :class:`vmesh.Settings`.

    Returns
    -------
    Mesh
        In canonical order. The same picture, settings and seed give the same mesh.

    Raises
    ------
    ValueError, TypeError
        If the array or a setting is not as described, or if a target cannot be met.
    """
    chosen = Settings(**settings)
    report = progress or silent
    image = with_hidden_colors_replaced(as_image(array))
    if chosen.method == "blue-noise":
        return _encode_blue_noise(image, chosen, metadata or Metadata(), report)
    report("sampling")
    grid = _grid(image, chosen)
    builder = MeshBuilder(image, metadata or Metadata(), chosen.color_step, grid)
    with workers(chosen.threads) as run:
        if chosen.effort == 1:
            draft = _sample(image, grid, chosen, run)
        else:
            draft = _remesh(image, chosen, builder, report, run)
        report("colors")
        return _meet_goal(draft, builder, chosen, lambda: report("rate control"))


def count_steps(settings: Settings) -> int:
    """About how often an encoding with these settings reports progress."""
    if settings.method == "blue-noise" or settings.effort == 1:
        return 3
    refinement = EFFORTS[settings.effort].n_reports if settings.tile is None else REPORTS
    return 3 + _THINNING_REPORTS + refinement


def _encode_blue_noise(
    image: SampleArray, settings: Settings, metadata: Metadata, report: Progress
) -> Mesh:
    """The method of the paper: vertices stay where they are sampled."""
    height, width, n_components = image.shape
    report("sampling")
    _, samples = propose(image, settings)
    vertices = samples.vertices()
    triangles = delaunay(vertices)
    report("colors")
    if settings.colors == "fitted":
        colors, _ = fit_colors(image, vertices, triangles, UNIT)
    else:
        colors = sample_colors(image, vertices, UNIT)
    step = settings.color_step or _BLUE_NOISE_STEP * peak_of(image) // 255
    lattice = ColorLattice.uniform(n_components, step, depth_of(image))
    levels = lattice.levels_from_colors(np.rint(colors))
    return Mesh(width, height, vertices, triangles, levels, lattice, SUBDIVISION, metadata)


def _grid(image: SampleArray, settings: Settings) -> Grid | None:
    """The tiles of a picture, None where one would hold all of it."""
    height, width = image.shape[:2]
    if settings.tile is None or settings.tile >= max(width, height):
        return None
    return Grid(width, height, settings.tile)


def _sample(image: SampleArray, grid: Grid | None, settings: Settings, run: Run) -> Draft:
    """Vertices where they are sampled."""
    if grid is None:
        return sampled_draft(image, settings)
    return sampled_tiles(image, grid, settings, run)


def _remesh(
    image: SampleArray, settings: Settings, builder: MeshBuilder, report: Progress, run: Run
) -> Draft:
    """The vertices of a dense sample that matter most, moved to better places."""
    height, width = image.shape[:2]
    draft: Remesher | TiledRemesher
    if builder.grid is None:
        draft = thinned(image, settings, lambda: report("thinning"), run)
    else:
        draft = thinned_tiles(image, builder.grid, settings, lambda: report("thinning"), run)
    wanted = settings.n_vertices(width, height)
    n_vertices = wanted or draft.n_vertices
    if settings.target_size is not None:
        n_vertices = refined_vertices(builder.build(draft), settings.target_size)
    draft.refine(min(n_vertices, width * height), lambda: report("refinement"))
    if wanted is not None and draft.n_vertices != min(wanted, width * height):
        draft.resize(min(wanted, width * height))
    return draft


def _meet_goal(
    draft: Draft, builder: MeshBuilder, settings: Settings, report: Callable[[], None]
) -> Mesh:
    """Mesh of a draft, resized where the settings ask for a size or a PSNR."""
    if settings.target_size is not None:
        return meet_size(draft, builder, settings.target_size, report)
    if settings.target_psnr is not None:
        return meet_psnr(draft, builder, settings.target_psnr, report)
    return builder.build(draft)
