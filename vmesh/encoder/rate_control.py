"""Rate control: the mesh that meets a size or an error.

One lambda decides which vertices are worth their bits, which flips, and which levels
(``rate_model``). Fewer vertices go with a larger lambda, so the number of vertices is what is
searched for first. A small picture may have no number that meets the goal: then its colours are
made coarser or finer than the error asks for, and at last, in a picture of a few pixels, single
levels are changed::

    vertices         size, PSNR in steps of a vertex
    coarseness       of the colours, continuous: steps and lambda
    every pixel      a vertex, where no other mesh comes close enough
    single levels    where each of them is more than the tolerance
"""

from __future__ import annotations

from collections.abc import Callable
from math import log2, log10
from typing import Final, NamedTuple

import numpy as np

from vmesh.arrays import Float64Array, Int32Array, SampleArray
from vmesh.codec.writer import dumps, metadata_size
from vmesh.encoder.draft import Draft, ThinnedDraft, fewest_vertices
from vmesh.encoder.image import is_small, peak_of
from vmesh.encoder.mesh_builder import MeshBuilder
from vmesh.encoder.rate_model import rescaled_vertices, size_after_refinement
from vmesh.encoder.tuning import Judge, spend, tune, tune_around
from vmesh.kernels.remeshing import WeightedImage
from vmesh.kernels.scanline import SUBPIXEL, draw
from vmesh.mesh import Mesh

_MAX_ATTEMPTS: Final = 30
_SIZE_TOLERANCE: Final = 0.02
_PSNR_TOLERANCE: Final = 0.1
_STEP_DECAY: Final = 0.8
# Decibels that twice as many vertices gain: a first guess, and bounds on what is measured.
_GAIN: Final = 2.4
_LEAST_GAIN: Final = 1.5
_MOST_GAIN: Final = 8.0

# What a vertex may cost, of the error allowed for its pixel, to be removed where all pixels have
# one: the error stays below that which is allowed.
_SHARES: Final = (0.5, 0.1, 0.0)
# A mesh without any error is taken before one that is worse and takes so many times its bytes.
_HARDLY_LARGER: Final = 1.02
# Attempts that go where the last one points.
_FREE_ATTEMPTS: Final = 10


class Candidate(NamedTuple):
    """A mesh, and what its file takes and shows."""

    mesh: Mesh
    size: int
    psnr: float


def refined_vertices(mesh: Mesh, target_size: int) -> int:
    """Number of vertices for a file of a size, judging by a mesh before it is refined."""
    size = size_after_refinement(len(dumps(mesh)))
    return max(4, _vertices_below(mesh, size, target_size))


def _vertices_below(mesh: Mesh, size: int, target_size: int) -> int:
    """Number of vertices for a size a little below the target, judging by a mesh and its size."""
    aim = (1 - 0.3 * _SIZE_TOLERANCE) * target_size
    return rescaled_vertices(mesh.n_vertices, size, metadata_size(mesh.metadata), aim)


def meet_size(
    draft: Draft,
    dense: Callable[[], ThinnedDraft],
    builder: MeshBuilder,
    target_size: int,
    report: Callable[[], None],
) -> Mesh:
    """The best mesh found whose file is not larger than `target_size`, and within 2 % of it.

    A picture whose mesh without any error is smaller gets that.

    Parameters
    ----------
    draft : Draft
    dense : callable
        Draft with a vertex at each pixel.
    builder : MeshBuilder
    target_size : int
        Bytes.
    report : callable
        Called after each attempt.

    Raises
    ------
    ValueError
        If the smallest mesh is larger.
    """
    least = (1 - _SIZE_TOLERANCE) * target_size
    found: list[Candidate] = []
    judge = _judge(builder, found, lambda candidate: candidate.size, least, target_size)
    bounds = _Bounds(draft)
    for _ in range(_MAX_ATTEMPTS):
        mesh = builder.build(draft)
        verdict = judge(mesh)
        if verdict == 0:
            break
        wanted = _vertices_below(mesh, found[-1].size, target_size)
        if not bounds.resize(wanted, verdict):
            break
        report()
    if verdict != 0:
        verdict = tune_around(draft, builder, judge)
    if verdict > 0:
        draft.resize(4)
        tune(builder.fit(draft), builder, judge)
    if verdict < 0 or is_small(builder.image):
        _tune_dense(dense, builder, judge)
    fitting = [candidate for candidate in found if candidate.size <= target_size]
    if not fitting:
        smallest = min(candidate.size for candidate in found)
        share = metadata_size(builder.metadata)
        metadata = f", {share} of them metadata" if share else ""
        raise ValueError(f"the smallest file of this picture takes {smallest} bytes{metadata}")
    near = [candidate for candidate in fitting if candidate.size >= least]
    return max(near or fitting, key=lambda c: (c.psnr, -c.size)).mesh


def meet_psnr(
    draft: Draft,
    dense: Callable[[], ThinnedDraft],
    builder: MeshBuilder,
    target_psnr: float,
    report: Callable[[], None],
) -> Mesh:
    """The smallest mesh found whose PSNR is at least `target_psnr`, and within 0.1 dB of it.

    Where nothing is both, as in a picture of one colour, it is the nearest above that was found.

    Parameters
    ----------
    draft : Draft
    dense : callable
        Draft with a vertex at each pixel.
    builder : MeshBuilder
    target_psnr : float
        Decibels.
    report : callable
        Called after each attempt.

    Raises
    ------
    ValueError
        If no mesh of the picture reaches it, as with colours that are rounded to large steps.
    """
    samples = builder.image.samples
    most = target_psnr + _PSNR_TOLERANCE
    found: list[Candidate] = []
    judge = _judge(builder, found, lambda candidate: candidate.psnr, target_psnr, most)
    gain = _GAIN
    earlier: tuple[float, float] | None = None
    bounds = _Bounds(draft)
    for attempt in range(_MAX_ATTEMPTS):
        verdict = judge(builder.build(draft))
        if verdict == 0:
            break
        before, psnr = draft.n_vertices, found[-1].psnr
        if earlier is not None and log2(before) != earlier[0]:
            slope = (min(psnr, 99.0) - earlier[1]) / (log2(before) - earlier[0])
            gain = min(max(slope, _LEAST_GAIN), _MOST_GAIN)
        earlier = log2(before), min(psnr, 99.0)
        aim = target_psnr + 0.5 * _PSNR_TOLERANCE
        doublings = (aim - psnr) / gain
        # Large changes shake the mesh: they become smaller from one attempt to the next.
        furthest = 2.0 * _STEP_DECAY**attempt
        wanted = round(before * 2.0 ** min(max(doublings, -furthest), furthest))
        if not bounds.resize(wanted, verdict):
            break
        report()
    if verdict != 0:
        verdict = tune_around(draft, builder, judge)

    def reached() -> list[Candidate]:
        return [candidate for candidate in found if candidate.psnr >= target_psnr]

    if verdict < 0 or is_small(builder.image):
        allowed = peak_of(samples) ** 2 / 10.0 ** (target_psnr / 10.0) * samples.shape[2]
        _tune_dense(dense, builder, judge, allowed)
    if not reached():
        highest = max(candidate.psnr for candidate in found)
        raise ValueError(
            f"a mesh of this picture reaches {highest:.2f} dB with colors in such steps, "
            f"not {target_psnr:g}"
        )
    best = min(reached(), key=lambda c: (c.psnr > most, c.psnr if c.psnr > most else c.size))
    smallest = min(reached(), key=lambda c: (c.size, -c.psnr))
    is_exact = smallest.psnr == np.inf
    if is_exact and smallest.mesh.n_vertices == fewest_vertices(builder.grid):
        return smallest.mesh
    if best.psnr > most and is_small(builder.image):
        # Where a level of these steps changes too much, one of the finest may not.
        alike = [c for c in reached() if c.mesh.n_vertices == best.mesh.n_vertices]
        for start in (best, max(alike, key=lambda c: c.psnr)):
            if best.psnr > most:
                mesh = _spent(start.mesh, samples, target_psnr, most)
                best = min(best, _measured(builder, mesh), key=lambda c: c.psnr)
    is_hardly_larger = best.psnr <= most and best.size <= _HARDLY_LARGER * smallest.size
    return smallest.mesh if is_exact and not is_hardly_larger else best.mesh


def _spent(mesh: Mesh, samples: SampleArray, target_psnr: float, most: float) -> Mesh:
    """Mesh whose levels were changed until its PSNR is hardly above a target, if they can be."""

    def measure(levels: Int32Array) -> float:
        return _psnr_of(samples, mesh, mesh.lattice.colors_from_levels(levels))

    levels = spend(mesh.levels, mesh.lattice, measure, target_psnr, most)
    return mesh.replaced(levels=levels)


def _judge(
    builder: MeshBuilder,
    found: list[Candidate],
    value_of: Callable[[Candidate], float],
    least: float,
    most: float,
) -> Judge:
    """Judge of meshes by a value that is to lie between two others; it notes what it has seen."""

    def judge(mesh: Mesh) -> int:
        candidate = _measured(builder, mesh)
        found.append(candidate)
        value = value_of(candidate)
        if least <= value <= most:
            return 0
        return 1 if value > most else -1

    return judge


def _measured(builder: MeshBuilder, mesh: Mesh) -> Candidate:
    return Candidate(mesh, len(dumps(mesh)), measure_psnr(builder.image.samples, mesh))


class _Bounds:
    """Numbers of vertices that are known to be too few and too many.

    Sizes and errors of meshes are not quite monotone in their number, and a search that ends
    nowhere goes back and forth: after some attempts it keeps between the bounds.
    """

    def __init__(self, draft: Draft) -> None:
        self._draft = draft
        self._low, self._high = 3, np.iinfo(np.int64).max
        self._n_attempts = 0

    def resize(self, wanted: int, verdict: int) -> bool:
        """Resize the draft, which has too many vertices, or too few; False if there is no way."""
        before = self._draft.n_vertices
        self._n_attempts += 1
        if verdict > 0:
            self._high, wanted = min(self._high, before), min(wanted, before - 1)
        else:
            self._low, wanted = max(self._low, before), max(wanted, before + 1)
        if self._n_attempts > _FREE_ATTEMPTS:
            if self._high - self._low <= 1:
                return False
            if not self._low < wanted < self._high:
                wanted = (self._low + min(self._high, 2 * self._low)) // 2
        self._draft.resize(max(4, wanted))
        return self._draft.n_vertices != before


def _tune_dense(
    dense: Callable[[], ThinnedDraft], builder: MeshBuilder, judge: Judge, allowed: float = 0.0
) -> None:
    """Try meshes with a vertex at each pixel that needs one.

    `allowed` is the squared error allowed for a pixel; without any, only vertices that make no
    difference are left out.
    """
    for share in _SHARES if allowed else _SHARES[-1:]:
        draft = dense()
        draft.thin(4, lambda: None, max_cost=share * allowed)
        if tune(builder.fit(draft), builder, judge) != -1:
            return
    tune(builder.fit(dense()), builder, judge)


def measure_psnr(samples: SampleArray, mesh: Mesh) -> float:
    """PSNR of a mesh at native size over all samples, in decibels; colours as they are seen."""
    return _psnr_of(samples, mesh, mesh.colors)


def measure_error(image: WeightedImage, mesh: Mesh) -> float:
    """Squared error of a mesh at native size, summed over all samples as each pixel counts."""
    errors = _squared_errors(image.samples, mesh, mesh.colors)
    return float((errors * image.weights[:, :, None]).sum())


def _psnr_of(samples: SampleArray, mesh: Mesh, colors: SampleArray) -> float:
    error = float(np.mean(_squared_errors(samples, mesh, colors)))
    return 10.0 * log10(mesh.lattice.max_sample**2 / error) if error > 0.0 else np.inf


def _squared_errors(samples: SampleArray, mesh: Mesh, colors: SampleArray) -> Float64Array:
    """Squared error of every sample of a mesh in some colours, as far as they are seen."""
    raster = np.zeros_like(samples)
    vertices = mesh.vertices.astype(np.int64) * (SUBPIXEL // mesh.unit)
    draw(vertices, mesh.triangles, colors, raster)
    difference = raster.astype(np.float64) - samples
    if samples.shape[2] == 4:
        difference[:, :, :3] *= samples[:, :, 3:] / mesh.lattice.max_sample
    return difference * difference
