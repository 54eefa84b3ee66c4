"""Rate control: how many vertices a mesh needs for a wanted size or error.

One lambda decides which vertices are worth their bits, which flips, and which levels
(``rate_model``). Fewer vertices go with a larger lambda, so the number of vertices is all there is
to search for.
"""

from __future__ import annotations

from collections.abc import Callable
from math import log2, log10
from typing import Final

import numpy as np

from vmesh.arrays import SampleArray
from vmesh.codec.writer import dumps, metadata_size
from vmesh.encoder.draft import Draft
from vmesh.encoder.mesh_builder import MeshBuilder
from vmesh.encoder.rate_model import rescaled_vertices, size_after_refinement
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


def refined_vertices(mesh: Mesh, target_size: int) -> int:
    """Number of vertices for a file of a size, judging by a mesh before it is refined."""
    size = size_after_refinement(len(dumps(mesh)))
    return max(4, _vertices_below(mesh, size, target_size))


def _vertices_below(mesh: Mesh, size: int, target_size: int) -> int:
    """Number of vertices for a size a little below the target, judging by a mesh and its size."""
    aim = (1 - 0.3 * _SIZE_TOLERANCE) * target_size
    return rescaled_vertices(mesh.n_vertices, size, metadata_size(mesh.metadata), aim)


def meet_size(
    draft: Draft, builder: MeshBuilder, target_size: int, report: Callable[[], None]
) -> Mesh:
    """The best mesh whose file is not larger than `target_size`, and within 2 % of it.

    Raises
    ------
    ValueError
        If the smallest mesh is larger.
    """
    best: Mesh | None = None
    best_size = 0
    for _ in range(_MAX_ATTEMPTS):
        mesh = builder.build(draft)
        size = len(dumps(mesh))
        if best_size < size <= target_size:
            best, best_size = mesh, size
        if (1 - _SIZE_TOLERANCE) * target_size <= size <= target_size:
            break
        before = draft.n_vertices
        wanted = _vertices_below(mesh, size, target_size)
        wanted = min(wanted, before - 1) if size > target_size else max(wanted, before + 1)
        draft.resize(max(4, wanted))
        report()
        if draft.n_vertices == before:
            break
    if best is None:
        raise ValueError(f"the smallest file of this picture takes {size} bytes")
    return best


def meet_psnr(
    draft: Draft, builder: MeshBuilder, target_psnr: float, report: Callable[[], None]
) -> Mesh:
    """The smallest mesh found whose PSNR is at least `target_psnr`, and within 0.1 dB of it.

    Raises
    ------
    ValueError
        If no mesh of the picture reaches it.
    """
    best: Mesh | None = None
    best_psnr = np.inf
    gain = _GAIN
    earlier: tuple[float, float] | None = None
    for attempt in range(_MAX_ATTEMPTS):
        mesh = builder.build(draft)
        psnr = measure_psnr(builder.image.samples, mesh)
        if psnr >= target_psnr and (best is None or psnr < best_psnr):
            best, best_psnr = mesh, psnr
        if target_psnr <= psnr <= target_psnr + _PSNR_TOLERANCE:
            break
        before = draft.n_vertices
        if earlier is not None and log2(before) != earlier[0]:
            slope = (min(psnr, 99.0) - earlier[1]) / (log2(before) - earlier[0])
            gain = min(max(slope, _LEAST_GAIN), _MOST_GAIN)
        earlier = log2(before), min(psnr, 99.0)
        aim = target_psnr + 0.5 * _PSNR_TOLERANCE
        doublings = (aim - psnr) / gain
        # Large changes shake the mesh: they become smaller from one attempt to the next.
        most = 2.0 * _STEP_DECAY**attempt
        wanted = round(before * 2.0 ** min(max(doublings, -most), most))
        wanted = min(wanted, before - 1) if psnr > target_psnr else max(wanted, before + 1)
        draft.resize(max(4, wanted))
        report()
        if draft.n_vertices == before:
            break
    if best is None:
        raise ValueError(f"a mesh of this picture reaches {psnr:.2f} dB, not {target_psnr:g}")
    return best


def measure_psnr(image: SampleArray, mesh: Mesh) -> float:
    """PSNR of a mesh at native size over all samples, in decibels; colours as they are seen."""
    raster = np.zeros_like(image)
    vertices = mesh.vertices.astype(np.int64) * (SUBPIXEL // mesh.unit)
    draw(vertices, mesh.triangles, mesh.colors, raster)
    difference = raster.astype(np.float64) - image
    if image.shape[2] == 4:
        difference[:, :, :3] *= image[:, :, 3:] / mesh.lattice.max_sample
    error = float(np.mean(difference * difference))
    return 10.0 * log10(mesh.lattice.max_sample**2 / error) if error > 0.0 else np.inf
