"""The encoder, from top to bottom: pixels -> Mesh."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

import numpy as np
import numpy.typing as npt
from scipy.ndimage import distance_transform_edt

from vmesh.arrays import UInt8Array, UInt16Array
from vmesh.color_lattice import ColorLattice
from vmesh.encoder.colors import fit_colors, sample_colors
from vmesh.encoder.salience import compute_salience
from vmesh.encoder.sampling import Samples, sample
from vmesh.encoder.settings import Settings
from vmesh.encoder.thinning import START_DENSITY, thin_vertices
from vmesh.kernels.delaunay import delaunay
from vmesh.mesh import MAX_SIDE, Mesh, Metadata

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
    image = with_hidden_colors_replaced(as_image(array))
    report = progress or _silent

    report("sampling")
    _, samples = propose(image, chosen)
    vertices = samples.vertices()

    if chosen.method == "adaptive":
        report("thinning")
        height, width = image.shape[:2]
        n_vertices = chosen.n_points(width, height) or len(vertices)
        visible = np.ascontiguousarray(visible_planes(image).transpose(1, 2, 0))
        vertices = thin_vertices(visible, vertices, n_vertices)

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
    height, width = image.shape[:2]
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
    n_points = settings.n_points(width, height)
    if settings.method == "adaptive" and n_points is not None:
        n_points = max(n_points, round(START_DENSITY * width * height))
    samples = sample(
        salience,
        n_points=n_points,
        sampler=settings.sampler,
        diffusion=settings.diffusion,
        seed=settings.seed,
    )
    return salience, samples


def with_hidden_colors_replaced(image: UInt8Array) -> UInt8Array:
    """The picture with each fully transparent pixel in the colour of the nearest visible one.

    What is hidden there would show where the mesh's alpha reaches a little further than that of
    the picture. `image` has shape (h, w, c), uint8; only RGBA pictures change.
    """
    if image.shape[2] != 4 or image[:, :, 3].all() or not image[:, :, 3].any():
        return image
    nearest = distance_transform_edt(
        image[:, :, 3] == 0, return_distances=False, return_indices=True
    )
    filled = image.copy()
    filled[:, :, :3] = image[:, :, :3][tuple(nearest)]
    return filled


def as_image(array: npt.ArrayLike) -> UInt8Array:
    """The picture as a contiguous array of shape (h, w, c), uint8, c being 1, 3 or 4."""
    given = np.asarray(array)
    if given.dtype != np.uint8:
        raise TypeError(f"expected a picture of uint8, got {given.dtype}")
    if given.ndim == 2:
        given = given[:, :, None]
    if given.ndim != 3 or given.shape[2] not in (1, 3, 4):
        raise ValueError(
            f"expected a picture of shape (h, w), (h, w, 3) or (h, w, 4), got {given.shape}"
        )
    height, width = given.shape[:2]
    if not (1 <= width <= MAX_SIDE and 1 <= height <= MAX_SIDE):
        raise ValueError(
            f"expected a picture of 1 to {MAX_SIDE} pixels a side, got {width} x {height}"
        )
    return np.ascontiguousarray(given)


def visible_planes(image: UInt8Array) -> UInt8Array:
    """Planes of a picture, shape (c, h, w), uint8, colours multiplied by alpha."""
    planes = np.ascontiguousarray(image.transpose(2, 0, 1))
    if len(planes) == 4:
        alpha = planes[3].astype(np.uint16)
        planes[:3] = (planes[:3] * alpha + 127) // 255
    return planes


def _silent(stage: str) -> None:
    """Report nothing."""
