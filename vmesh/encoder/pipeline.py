"""The encoder, from top to bottom: pixels -> Mesh."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from vmesh.arrays import SampleArray, UInt16Array
from vmesh.color_lattice import ColorLattice
from vmesh.encoder.colors import fit_colors, sample_colors
from vmesh.encoder.drafts import SUBDIVISION, UNIT, Draft, Finisher, SampledDraft, price_of
from vmesh.encoder.image import (
    as_image,
    depth_of,
    peak_of,
    visible_planes,
    with_hidden_colors_replaced,
)
from vmesh.encoder.rate_control import (
    guess_vertices,
    meet_psnr,
    meet_size,
    price_of_quality,
    refined_vertices,
)
from vmesh.encoder.remeshing import Effort, Remesher
from vmesh.encoder.salience import compute_salience
from vmesh.encoder.sampling import Samples, sample
from vmesh.encoder.settings import DEFAULT_QUALITY, Settings
from vmesh.encoder.waves import Run, workers
from vmesh.kernels.delaunay import delaunay
from vmesh.mesh import Mesh, Metadata
from vmesh.progress import Progress, silent

STAGES: Final = ("sampling", "thinning", "refinement", "colors", "rate control")

# What each effort from 2 on buys.
_EFFORTS: Final = {
    2: Effort(density=0.04, max_rounds=1, least_gain=0.0, share_decay=1.0),
    3: Effort(density=0.05, max_rounds=2, least_gain=0.0, share_decay=0.7),
    4: Effort(density=0.06, max_rounds=3, least_gain=0.0, share_decay=0.8),
    5: Effort(density=0.045, max_rounds=16, least_gain=0.06, share_decay=0.85),
    6: Effort(density=0.10, max_rounds=20, least_gain=0.04, share_decay=0.9),
    7: Effort(density=0.15, max_rounds=30, least_gain=0.015, share_decay=0.93),
    8: Effort(density=0.25, max_rounds=32, least_gain=0.004, share_decay=0.96),
    9: Effort(density=0.25, max_rounds=64, least_gain=0.0, share_decay=0.98),
}
# Thinning starts from at least so many times the vertices wanted.
_LEAST_CHOICE: Final = 3
# A vertex stays while its removal costs more than this many bits: what it takes, and what it will
# gain in its final place.
_VERTEX_BITS: Final = 20.0
# The error before refinement, for that after it.
_REFINEMENT_GAIN: Final = 1.6

# About so many steps, for the display of progress.
_THINNING_STEPS: Final = 4
_REFINEMENT_STEPS: Final = {2: 2, 3: 3, 4: 4, 5: 5, 6: 7, 7: 10, 8: 20, 9: 50}

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
    finisher = Finisher(image, metadata or Metadata(), chosen.color_step)
    with workers(chosen.threads) as run:
        if chosen.effort == 1:
            draft = _sampled_draft(image, chosen)
        else:
            draft = _remesh(image, chosen, finisher, report, run)
        report("colors")
        return _meet_goal(draft, finisher, chosen, lambda: report("rate control"))


def count_steps(settings: Settings) -> int:
    """About how often an encoding with these settings reports progress."""
    if settings.method == "blue-noise" or settings.effort == 1:
        return 3
    return 3 + _THINNING_STEPS + _REFINEMENT_STEPS[settings.effort]


def propose(image: SampleArray, settings: Settings) -> tuple[UInt16Array, Samples]:
    """Salience of a picture and the points sampled from it, before any thinning.

    Parameters
    ----------
    image : ndarray
        Shape (h, w, c), uint8 or uint16.
    settings : Settings
        With a number of vertices or a density; otherwise gamma decides on the number of points.

    Returns
    -------
    salience : ndarray
        Shape (c, h, w), uint16, as :func:`compute_salience` gives it.
    samples : Samples
    """
    height, width = image.shape[:2]
    salience = compute_salience(visible_planes(image), settings.gamma)
    samples = sample(
        salience,
        n_points=settings.n_vertices(width, height),
        sampler=settings.sampler,
        diffusion=settings.diffusion,
        seed=settings.seed,
    )
    return salience, samples


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


def _sampled_draft(image: SampleArray, settings: Settings) -> Draft:
    """Vertices where they are sampled, as many as the settings ask for."""
    height, width = image.shape[:2]

    def take(n_vertices: int) -> Samples:
        _, samples = propose(image, _with_vertices(settings, n_vertices))
        return samples

    wanted = _wanted_vertices(settings, width, height)
    draft = SampledDraft(image, take, wanted or max(4, width * height // 100))
    if wanted is None and settings.target_psnr is None:
        price = price_of_quality(_quality(settings), peak_of(image))
        for _ in range(2):
            # The price falls with about the 1.6th power of the number of vertices.
            factor = (price_of(draft) / price) ** (1 / 1.6)
            draft.resize(max(4, min(round(draft.n_vertices * factor), width * height)))
    return draft


def _remesh(
    image: SampleArray, settings: Settings, finisher: Finisher, report: Progress, run: Run
) -> Draft:
    """The vertices of a dense sample that matter most, moved to better places."""
    height, width = image.shape[:2]
    effort = _EFFORTS[settings.effort]
    wanted = _wanted_vertices(settings, width, height)
    start = max(4, round(effort.density * width * height))
    if wanted is not None:
        start = max(start, _LEAST_CHOICE * wanted)
    while True:
        start = max(4, min(start, width * height))
        _, samples = propose(image, _with_vertices(settings, start))
        draft = Remesher(image, samples.vertices(), effort, run)
        n_start = draft.n_vertices
        _thin(draft, settings, wanted, lambda: report("thinning"))
        if _LEAST_CHOICE * draft.n_vertices <= n_start or start >= width * height:
            break
        # There was too little to choose from.
        start = 2 * _LEAST_CHOICE * draft.n_vertices
    n_vertices = draft.n_vertices
    if settings.target_size is not None:
        n_vertices = refined_vertices(finisher.finish(draft), settings.target_size)
    draft.refine(min(n_vertices, width * height), lambda: report("refinement"))
    return draft


def _thin(
    draft: Remesher, settings: Settings, wanted: int | None, report: Callable[[], None]
) -> None:
    """Remove vertices down to the number wanted, or as many as the price or the error allows."""
    if wanted is not None:
        draft.thin(wanted, report)
    elif settings.target_psnr is not None:
        allowed = draft.n_samples * draft.peak**2 / 10.0 ** (settings.target_psnr / 10.0)
        draft.thin(4, report, max_error=_REFINEMENT_GAIN * allowed)
    else:
        price = price_of_quality(_quality(settings), draft.peak)
        draft.thin(4, report, max_cost=_VERTEX_BITS * price)


def _meet_goal(
    draft: Draft, finisher: Finisher, settings: Settings, report: Callable[[], None]
) -> Mesh:
    """Mesh of a draft, resized where the settings ask for a size or a PSNR."""
    if settings.target_size is not None:
        return meet_size(draft, finisher, settings.target_size, report)
    if settings.target_psnr is not None:
        return meet_psnr(draft, finisher, settings.target_psnr, report)
    return finisher.finish(draft)


def _wanted_vertices(settings: Settings, width: int, height: int) -> int | None:
    """Number of vertices that the settings ask for, or that a file of their size may hold."""
    if settings.target_size is not None:
        return max(4, min(guess_vertices(settings.target_size), width * height))
    return settings.n_vertices(width, height)


def _quality(settings: Settings) -> int:
    return DEFAULT_QUALITY if settings.quality is None else settings.quality


def _with_vertices(settings: Settings, n_vertices: int) -> Settings:
    """The settings with a number of vertices as the goal."""
    return replace(
        settings,
        quality=None,
        target_size=None,
        target_psnr=None,
        density=None,
        vertices=n_vertices,
    )
