"""Tuning: meshes of one draft in finer and coarser colours, until one meets a goal.

A vertex more or less may change a small picture by more than a goal allows. The error that the
colours' steps and levels are chosen for changes a mesh in much smaller steps, a single level in
the smallest there are.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from math import log2
from typing import Final

import numpy as np

from vmesh.arrays import Int32Array
from vmesh.color_lattice import ColorLattice
from vmesh.encoder.draft import Draft
from vmesh.encoder.image import peak_of
from vmesh.encoder.mesh_builder import Fit, MeshBuilder
from vmesh.encoder.rate_model import lambda_for
from vmesh.mesh import Mesh

Judge = Callable[[Mesh], int]
"""Judges a mesh: 0 if it meets the goal, 1 if coarser colours may help, -1 if finer ones may."""

# Numbers of vertices around that of a draft.
_CHANGES: Final = (0, 1, -1, 2, -2, 3, -3)
# The error that colours are chosen for is searched for by halving, then up to so many octaves above
# it that for which lambda is.
_COARSER: Final = 12.0
_BISECTIONS: Final = 12
_LEAST_MEAN_ERROR: Final = 0.75
_MANY_VERTICES: Final = 200  # sizes and errors of meshes of more are fine enough
# Of single levels: more than one at once, since one may change no pixel.
_LEVEL_CHANGES: Final = (-13, -5, -2, -1, 1, 2, 5, 13)
_MAX_TRIALS: Final = 3000


def tune_around(draft: Draft, builder: MeshBuilder, judge: Judge) -> int:
    """Try colours of every coarseness, then with a few vertices more or less.

    Returns what :func:`tune` does, 0 instead of None. More or fewer vertices are tried only where
    some colours are too fine and others too coarse.
    """
    n_vertices = draft.n_vertices
    for change in _CHANGES:
        if change:
            draft.resize(max(4, n_vertices + change))
        verdict = tune(builder.fit(draft), builder, judge)
        if verdict is not None:
            return verdict
        if n_vertices > _MANY_VERTICES:
            break
    return 0


def tune(fit: Fit, builder: MeshBuilder, judge: Judge) -> int | None:
    """Make the colours of a mesh finer or coarser until it meets the goal.

    Returns 0 if it does, -1 if the finest colours are too coarse, 1 if the coarsest are too fine,
    and None if there are both but none in between meets it.
    """
    samples, n_vertices = builder.image.samples, len(fit.vertices)

    def by_error(octave: float) -> Mesh:
        """Mesh in steps and levels for an error of so many octaves."""
        error = 2.0**octave
        return builder.rounded(fit, error, lambda_for(error, n_vertices))

    def by_lambda(octave: float) -> Mesh:
        """Mesh in steps that are too fine, and levels for an error of so many octaves."""
        return builder.rounded(fit, 2.0**low, lambda_for(2.0**octave, n_vertices))

    # A mean error for which all steps are 1.
    low = log2(_LEAST_MEAN_ERROR * samples.size)
    high = log2(samples.size * float(peak_of(samples)) ** 2)
    finest = builder.finest(fit)
    if (verdict := judge(finest)) <= 0:
        return verdict
    if (verdict := judge(by_error(high))) >= 0:
        return verdict
    if (verdict := judge(by_error(low))) == 0:
        return 0
    if verdict < 0:
        return _mix(finest, by_error(low), judge)
    # From one step to the next the mesh changes at once, with lambda level by level.
    low, high = _halved(by_error, judge, low, high)
    if low == high:
        return 0
    fine, coarse = _halved(by_lambda, judge, low, low + _COARSER)
    if fine == coarse:
        return 0
    return _mix(by_lambda(fine), by_lambda(coarse), judge)


def _halved(
    mesh_of: Callable[[float], Mesh], judge: Judge, low: float, high: float
) -> tuple[float, float]:
    """Octaves next to each other of which one is too fine and the other too coarse.

    They are the same where the mesh met the goal.
    """
    for _ in range(_BISECTIONS):
        middle = (low + high) / 2
        verdict = judge(mesh_of(middle))
        if verdict == 0:
            return middle, middle
        low, high = (middle, high) if verdict > 0 else (low, middle)
    return low, high


def _mix(fine: Mesh, coarse: Mesh, judge: Judge) -> int | None:
    """Give more and more vertices of a mesh the levels of another; 0 if that met the goal."""
    apart = np.flatnonzero((fine.levels != coarse.levels).any(axis=1))
    few, many = 0, len(apart)
    while many - few > 1:
        middle = (few + many) // 2
        levels = fine.levels.copy()
        levels[apart[:middle]] = coarse.levels[apart[:middle]]
        verdict = judge(fine.replaced(levels=levels))
        if verdict == 0:
            return 0
        few, many = (middle, many) if verdict > 0 else (few, middle)
    return None


def spend(
    levels: Int32Array,
    lattice: ColorLattice,
    measure: Callable[[Int32Array], float],
    target_psnr: float,
    most: float,
) -> Int32Array:
    """Levels of a mesh, changed one by one until its PSNR is between a target and `most`.

    Each change is the first that meets it, or the one that comes closest from above; it ends where
    there is none.
    `measure` gives the PSNR with some levels, shape (n, c).
    """
    best, best_psnr = levels, measure(levels)
    lowest, highest = lattice.level_bounds()
    n_passes = max(2, _MAX_TRIALS // (len(_LEVEL_CHANGES) * levels.size))
    for _ in range(n_passes if best_psnr > most else 0):
        found, found_psnr = best, best_psnr
        for (v, z), change in product(np.ndindex(levels.shape), _LEVEL_CHANGES):
            level = best[v, z] + change
            if lowest[z] <= level <= highest[z]:
                tried = best.copy()
                tried[v, z] = level
                psnr = measure(tried)
                if target_psnr <= psnr <= most:
                    return tried
                if target_psnr <= psnr < found_psnr:
                    found, found_psnr = tried, psnr
        if found is best:
            break
        best, best_psnr = found, found_psnr
    return best
