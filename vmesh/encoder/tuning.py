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

from vmesh.encoder.draft import Draft
from vmesh.encoder.image import peak_of
from vmesh.encoder.mesh_builder import Fit, MeshBuilder
from vmesh.mesh import Mesh

Judge = Callable[[Mesh], int]
"""Judges a mesh: 0 if it meets the goal, 1 if coarser colours may help, -1 if finer ones may."""

# Numbers of vertices around that of a draft.
_CHANGES: Final = (0, 1, -1, 2, -2, 3, -3)
# Meshes of more vertices have sizes and errors that are fine enough.
_MANY_VERTICES: Final = 5000
# The error that colours are chosen for is searched for by halving, from so many octaves below that
# of the draft, then around what is found so often, this far apart.
_FINER: Final = 10.0
_LEAST_MEAN_ERROR: Final = 0.05
_BISECTIONS: Final = 16
_NEIGHBOURS: Final = 12
_APART: Final = 0.04
_MAX_CHANGES: Final = 200  # of single levels


def tune_around(draft: Draft, builder: MeshBuilder, judge: Judge) -> bool:
    """Try colours of every coarseness, then with a few vertices more or less; True if that met it.

    More or fewer vertices are tried only where some colours are too fine and others too coarse.
    """
    n_vertices = draft.n_vertices
    for change in _CHANGES:
        if change:
            draft.resize(max(4, n_vertices + change))
        verdict = tune(builder.fit(draft), builder, judge)
        if verdict is not None:
            return verdict == 0
        if n_vertices > _MANY_VERTICES:
            break
    return False


def tune(fit: Fit, builder: MeshBuilder, judge: Judge) -> int | None:
    """Make the colours of a mesh finer or coarser until it meets the goal.

    Returns 0 if it does, -1 if the finest colours are too coarse, 1 if the coarsest are too fine,
    and None if there are both but none in between meets it.
    """
    samples = builder.image.samples

    def try_octave(octave: float) -> int:
        return judge(builder.rounded(fit, 2.0**octave))

    low = log2(max(fit.error, _LEAST_MEAN_ERROR * samples.size)) - _FINER
    high = log2(samples.size * float(peak_of(samples)) ** 2)
    if (verdict := judge(builder.finest(fit))) <= 0:
        return verdict
    if (verdict := try_octave(high)) >= 0:
        return verdict
    for _ in range(_BISECTIONS):
        middle = (low + high) / 2
        verdict = try_octave(middle)
        if verdict == 0:
            return 0
        low, high = (middle, high) if verdict > 0 else (low, middle)
    if len(fit.vertices) <= _MANY_VERTICES:
        # Size and error are not quite monotone: what is nearby may be nearer.
        for i in range(1, _NEIGHBOURS + 1):
            for octave in (low - i * _APART, low + i * _APART):
                if try_octave(octave) == 0:
                    return 0
    return None


def spend(mesh: Mesh, measure: Callable[[Mesh], float], target_psnr: float, most: float) -> Mesh:
    """Mesh whose levels were changed, one by one, until its PSNR is between a target and `most`.

    Each change is the one that comes closest to the target from above; it ends where there is none.
    """
    best, best_psnr = mesh, measure(mesh)
    lowest, highest = mesh.lattice.level_bounds()
    for _ in range(_MAX_CHANGES):
        if best_psnr <= most:
            break
        found, found_psnr = best, best_psnr
        for (v, z), change in product(np.ndindex(best.levels.shape), (-1, 1)):
            level = best.levels[v, z] + change
            if lowest[z] <= level <= highest[z]:
                levels = best.levels.copy()
                levels[v, z] = level
                tried = best.replaced(levels=levels)
                psnr = measure(tried)
                if target_psnr <= psnr < found_psnr:
                    found, found_psnr = tried, psnr
        if found is best:
            break
        best, best_psnr = found, found_psnr
    return best
