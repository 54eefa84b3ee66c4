"""The encoder, from top to bottom: pixels -> Mesh."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from vmesh.arrays import UInt8Array, UInt16Array
from vmesh.color_lattice import ColorLattice
from vmesh.encoder.colors import fit_colors, sample_colors
from vmesh.encoder.image import as_image, visible_planes, with_hidden_colors_replaced
from vmesh.encoder.salience import compute_salience
from vmesh.encoder.sampling import Samples, sample
from vmesh.encoder.settings import Settings
from vmesh.encoder.thinning import thin_vertices
from vmesh.kernels.delaunay import delaunay
from vmesh.mesh import Mesh, Metadata

Progress = Callable[[str], None]
"""Called with the name of each stage as it begins."""

STAGES: Final = ("sampling", "thinning", "triangulation", "colors", "quantization")

_SUBDIVISION: Final = 1  # pixel centres lie on the lattice of half pixels


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
        Shape (h, w), (h, w, 3) or (h, w, 4), uint8: grey, RGB or RGBA, alpha not multiplied.
    metadata : Metadata, optional
        What travels with the picture.
    progress : callable, optional
        Called with the name of each of `STAGES` as it begins.
    **settings
        Fields of :class:`vmesh.Settings`.

    Returns
    -------
    Mesh
        In canonical order. The same picture, settings and seed give the same mesh.

    Raises
    ------
    ValueError, TypeError
        If the array or a setting is not as described.
    """
    chosen = Settings(**settings)
    report = progress or _silent
    image = with_hidden_colors_replaced(as_image(array))
    height, width = image.shape[:2]

    report("sampling")
    _, samples = propose(image, chosen)
    vertices = samples.vertices()

    if chosen.method == "adaptive":
        report("thinning")
        vertices = thin_vertices(image, vertices, chosen.n_vertices(width, height))

    report("triangulation")
    triangles = delaunay(vertices)

    report("colors")
    unit = 1 << _SUBDIVISION
    if chosen.colors == "fitted":
        colors = fit_colors(image, vertices, triangles, unit)
    else:
        colors = sample_colors(image, vertices, unit)

    report("quantization")
    lattice = ColorLattice.uniform(image.shape[2], chosen.color_step)
    levels = lattice.levels_from_colors(np.rint(colors))
    return Mesh(
        width,
        height,
        vertices,
        triangles,
        levels,
        lattice,
        _SUBDIVISION,
        metadata or Metadata(),
    )


def propose(image: UInt8Array, settings: Settings) -> tuple[UInt16Array, Samples]:
    """Salience of a picture and the points sampled from it, before any thinning.

    Parameters
    ----------
    image : ndarray
        Shape (h, w, c), uint8.
    settings : Settings

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
        n_points=settings.n_points(width, height),
        sampler=settings.sampler,
        diffusion=settings.diffusion,
        seed=settings.seed,
    )
    return salience, samples


def _silent(stage: str) -> None:
    """Report nothing."""
