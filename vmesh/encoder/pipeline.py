"""The encoder, from top to bottom: pixels -> Mesh."""

from __future__ import annotations

from itertools import chain, repeat
from typing import Final

import numpy as np
import numpy.typing as npt

from vmesh.color_lattice import ColorLattice
from vmesh.encoder.colors import fit_colors, sample_colors
from vmesh.encoder.draft import SUBDIVISION, UNIT, Draft, fewest_vertices, most_vertices
from vmesh.encoder.effort import EFFORTS
from vmesh.encoder.image import depth_of, peak_of, weighted
from vmesh.encoder.mesh_builder import MeshBuilder
from vmesh.encoder.proposals import propose
from vmesh.encoder.rate_control import meet_psnr, meet_size, refined_vertices
from vmesh.encoder.remeshing import Remesher
from vmesh.encoder.settings import (
    DEFAULT_EFFORT,
    ColorMode,
    Diffusion,
    Method,
    Sampler,
    Settings,
)
from vmesh.encoder.small_pictures import best_of_rungs, takes_rungs
from vmesh.encoder.starting_mesh import (
    dense_draft,
    sampled_draft,
    sampled_tiles,
    thinned,
    thinned_tiles,
)
from vmesh.encoder.threads import Run, workers
from vmesh.encoder.tiles.tiled_draft import REPORTS, TiledRemesher
from vmesh.grid import Grid
from vmesh.kernels.delaunay import delaunay
from vmesh.kernels.remeshing import WeightedImage
from vmesh.mesh import Mesh, Metadata
from vmesh.progress import Progress, silent

STAGES: Final = ("sampling", "thinning", "refinement", "colors", "rate control")

_THINNING_REPORTS: Final = 4  # about

_BLUE_NOISE_STEP: Final = 8


def encode(
    array: npt.ArrayLike,
    *,
    weights: npt.ArrayLike | None = None,
    method: Method = "adaptive",
    quality: int | None = None,
    target_size: int | None = None,
    target_psnr: float | None = None,
    vertices: int | None = None,
    density: float | None = None,
    effort: int = DEFAULT_EFFORT,
    gamma: float = 1.0,
    sampler: Sampler = "multiclass",
    diffusion: Diffusion = "zhou-fang",
    colors: ColorMode = "fitted",
    color_step: int | None = None,
    tile: int | None = None,
    seed: int = 0,
    threads: int | None = None,
    metadata: Metadata | None = None,
    progress: Progress | None = None,
) -> Mesh:
    """Mesh of a picture.

    Of `quality`, `target_size`, `target_psnr`, `vertices` and `density` one at most is given.
    Without any, the quality is 75 ("adaptive"), or gamma decides ("blue-noise").

    Parameters
    ----------
    array : array_like
        Shape (h, w), (h, w, 3) or (h, w, 4), uint8 or uint16: grey, RGB or RGBA, alpha not
        multiplied. The mesh has samples of as many bits.
    weights : array_like, optional
        Shape (h, w), real numbers of 0 or more, not all 0: what a squared error in each pixel
        counts, in every decision on vertices and colours. Only their proportions matter. Where
        they are 0 the mesh still follows the picture roughly. Every pixel counts alike unless
        given.
    method : {"adaptive", "blue-noise"}
        How vertices are found: sampled densely, thinned to those that matter most and moved to
        where they serve best; or sampled from the salience and left there.
    quality : int, optional
        0 to 100: the error that a bit has to save, the same for every picture ("adaptive"). In
        pictures of fewer than 4,096 pixels more quality never leaves more error, and 100 leaves
        hardly any.
    target_size : int, optional
        Bytes of the file, met from below within 2 % ("adaptive"). A picture that takes fewer
        without any error gets no more.
    target_psnr : float, optional
        Decibels over all samples, met from above within 0.1 dB ("adaptive"), whatever `weights`
        are. Where no mesh is as close, as in pictures of one colour or of a few pixels, it is the
        nearest one above that is found, and one without any error if nothing worse is smaller.
    vertices : int, optional
        Vertices wanted, met exactly, or within 2 % ("blue-noise"). At least there are those of the
        picture's, or its tiles', corners; at most one more for each pixel: another number counts as
        the nearest of these.
    density : float, optional
        Vertices wanted per pixel, above 0 and up to 1.
    effort : int
        1 to 9, 5 unless given: time for a better mesh of the same size ("adaptive"). 1 leaves the
        vertices where they were sampled.
    gamma : float
        Exponent of the salience, above 0; a smaller value gives more points.
    sampler : {"multiclass", "channels"}
        Colour planes sampled together, no two on one pixel, or each for itself.
    diffusion : {"zhou-fang", "ostromoukhov"}
        Coefficients of the error diffusion.
    colors : {"fitted", "sampled"}
        Vertex colours by least squares over all pixels, or those of the vertices' pixels
        ("blue-noise").
    color_step : int, optional
        Step of the luma lattice in sample units, 1 (no rounding) to the largest sample; the other
        components' steps follow from it. It follows from the error unless given.
    tile : int, optional
        Side in pixels, 32 to 2048, of tiles that the mesh is made of: each is worked on, and held
        in the file, as a picture of its own ("adaptive"). Its corners are vertices always. A
        picture that fits one tile has none.
    seed : int
        Start of the random thresholds.
    threads : int, optional
        Most threads at once, on which the mesh does not depend; as many as there are processors
        unless given.
    metadata : Metadata, optional
        Metadata that travel with the picture.
    progress : callable, optional
        Called with the name of each of `STAGES` as it begins, and again as it goes on.

    Returns
    -------
    Mesh
        In canonical order. The same picture, settings and seed give the same mesh.

    Raises
    ------
    ValueError, TypeError
        If the array or a setting is not as described, or if a target cannot be met.
    """
    settings = Settings(
        method=method,
        quality=quality,
        target_size=target_size,
        target_psnr=target_psnr,
        vertices=vertices,
        density=density,
        effort=effort,
        gamma=gamma,
        sampler=sampler,
        diffusion=diffusion,
        colors=colors,
        color_step=color_step,
        tile=tile,
        seed=seed,
        threads=threads,
    )
    return encode_with(array, settings, weights=weights, metadata=metadata, progress=progress)


def encode_with(
    array: npt.ArrayLike,
    chosen: Settings,
    *,
    weights: npt.ArrayLike | None = None,
    metadata: Metadata | None = None,
    progress: Progress | None = None,
) -> Mesh:
    """Mesh of a picture by settings that are made already; the rest is as for :func:`encode`."""
    report = progress or silent
    image = weighted(array, weights)
    if chosen.method == "blue-noise":
        return _encode_blue_noise(image, chosen, metadata or Metadata(), report)
    report("sampling")
    grid = _grid(image, chosen)
    builder = MeshBuilder(image, metadata or Metadata(), chosen.color_step, grid)
    with workers(chosen.threads) as run:
        if takes_rungs(image, chosen):
            reports = chain([report], repeat(silent))  # once is enough
            mesh = best_of_rungs(
                builder, chosen, lambda rung: _draft(rung, builder, next(reports), run), run
            )
            report("colors")
            return mesh
        draft = _draft(chosen, builder, report, run)
        report("colors")
        return _meet_goal(draft, builder, chosen, report, run)


def _draft(settings: Settings, builder: MeshBuilder, report: Progress, run: Run) -> Draft:
    """Draft with as many vertices as the settings ask for, or about as many as their goal takes."""
    height, width = builder.image.weights.shape
    draft: Draft
    if settings.effort == 1:
        draft = _sample(builder.image, builder.grid, settings, run)
    else:
        draft = _remesh(builder.image, settings, builder, report, run)
    wanted = settings.n_vertices(width, height)
    if wanted is None:
        return draft
    fewest, most = fewest_vertices(builder.grid), most_vertices(width, height, builder.grid)
    wanted = min(max(wanted, fewest), most)
    if draft.n_vertices != wanted:
        draft.resize(wanted)
    if draft.n_vertices != wanted:
        dense = dense_draft(builder.image, builder.grid, settings, run)
        dense.thin_exactly(wanted)
        draft = dense
    return draft


def count_steps(settings: Settings) -> int:
    """Approximate number of progress reports of an encoding with these settings."""
    if settings.method == "blue-noise" or settings.effort == 1:
        return 3
    refinement = EFFORTS[settings.effort].n_reports if settings.tile is None else REPORTS
    return 3 + _THINNING_REPORTS + refinement


def _encode_blue_noise(
    image: WeightedImage, settings: Settings, metadata: Metadata, report: Progress
) -> Mesh:
    """Mesh by the method of Zhao, Feng and Zhou (2013): vertices stay where they are sampled."""
    height, width, n_components = image.samples.shape
    report("sampling")
    _, sampled = propose(image, settings)
    vertices = sampled.vertices()
    triangles = delaunay(vertices)
    report("colors")
    if settings.colors == "fitted":
        colors, _ = fit_colors(image, vertices, triangles, UNIT)
    else:
        colors = sample_colors(image.samples, vertices, UNIT)
    step = settings.color_step or _BLUE_NOISE_STEP * peak_of(image.samples) // 255
    lattice = ColorLattice.uniform(n_components, step, depth_of(image.samples))
    levels = lattice.levels_from_colors(np.rint(colors))
    return Mesh(width, height, vertices, triangles, levels, lattice, SUBDIVISION, metadata)


def _grid(image: WeightedImage, settings: Settings) -> Grid | None:
    """The tiles of a picture, None where one would hold all of it."""
    height, width = image.weights.shape
    if settings.tile is None or settings.tile >= max(width, height):
        return None
    return Grid(width, height, settings.tile)


def _sample(image: WeightedImage, grid: Grid | None, settings: Settings, run: Run) -> Draft:
    """Draft of vertices where they are sampled."""
    if grid is None:
        return sampled_draft(image, settings)
    return sampled_tiles(image, grid, settings, run)


def _remesh(
    image: WeightedImage, settings: Settings, builder: MeshBuilder, report: Progress, run: Run
) -> Draft:
    """Draft of the vertices that matter most in a dense sample, moved to better places."""
    height, width = image.weights.shape
    draft: Remesher | TiledRemesher
    if builder.grid is None:
        draft = thinned(image, settings, lambda: report("thinning"), run)
    else:
        draft = thinned_tiles(image, builder.grid, settings, lambda: report("thinning"), run)
    wanted = settings.n_vertices(width, height)
    n_vertices = wanted or draft.n_vertices
    if settings.target_size is not None:
        n_vertices = refined_vertices(builder.build(draft), settings.target_size)
    most = most_vertices(width, height, builder.grid)
    draft.refine(min(n_vertices, most), lambda: report("refinement"))
    return draft


def _meet_goal(
    draft: Draft, builder: MeshBuilder, settings: Settings, report: Progress, run: Run
) -> Mesh:
    """Mesh of a draft, resized where the settings ask for a size or a PSNR."""

    def dense() -> Remesher | TiledRemesher:
        return dense_draft(builder.image, builder.grid, settings, run)

    def step() -> None:
        report("rate control")

    if settings.target_size is not None:
        return meet_size(draft, dense, builder, settings.target_size, step)
    if settings.target_psnr is not None:
        return meet_psnr(draft, dense, builder, settings.target_psnr, step)
    return builder.build(draft)
