"""Vertex colours: taken from the vertices' pixels, or fitted to all pixels."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from vmesh.arrays import Float64Array, Int32Array, SampleArray
from vmesh.encoder.image import peak_of
from vmesh.kernels.least_squares import solve
from vmesh.kernels.remeshing import WeightedImage
from vmesh.kernels.scanline import SUBPIXEL, accumulate

_RIDGE: Final = 1e-2  # in pixels: holds a vertex whose triangles cover no pixel centre
_TOLERANCE: Final = 1e-3
_MAX_STEPS: Final = 200
_HIDDEN_WEIGHT: Final = 1e-4  # of a transparent pixel's colour, so that the system stays regular


def sample_colors(image: SampleArray, vertices: Int32Array, unit: int) -> Float64Array:
    """Colours of the pixels that the vertices lie in, as Zhao, Feng and Zhou (2013) take them.

    Parameters
    ----------
    image : ndarray
        Shape (h, w, c), uint8 or uint16.
    vertices : ndarray
        Shape (n, 2), int32, in lattice units.
    unit : int
        Lattice units in a pixel.

    Returns
    -------
    ndarray
        Shape (n, c), float64.
    """
    height, width = image.shape[:2]
    x = np.minimum(vertices[:, 0] // unit, width - 1)
    y = np.minimum(vertices[:, 1] // unit, height - 1)
    colors: Float64Array = image[y, x].astype(np.float64)
    return colors


@dataclass(frozen=True, slots=True)
class NormalEquations:
    """The squared error of a sample component as a function of the vertices' values.

    Parameters
    ----------
    triangles : ndarray
        Shape (m, 3), int32.
    products : ndarray
        Shape (m, 6), float64: each triangle's block, entries 00, 11, 22, 01, 12, 20.
    moments : ndarray
        Shape (n,), float64: the right-hand side.
    """

    triangles: Int32Array
    products: Float64Array
    moments: Float64Array


def fit_colors(
    image: WeightedImage, vertices: Int32Array, triangles: Int32Array, unit: int
) -> tuple[Float64Array, list[NormalEquations]]:
    """Colours that make the rendered mesh closest to the picture in squared error.

    Solves (A'GA + r I) c = A'G y + r s, where A holds the barycentric weights of every pixel's
    centre, G the pixels' weights, y the picture and s the sampled colours, with a small r. An
    RGBA picture's colours count in proportion to their alpha too, so that what is hidden in
    transparent pixels does not leak; alpha is fitted on its own.

    Parameters
    ----------
    image : WeightedImage
    vertices, triangles : ndarray
        Shapes (n, 2) and (m, 3), int32; they cover the picture.
    unit : int
        Lattice units in a pixel.

    Returns
    -------
    colors : ndarray
        Shape (n, c), float64, 0 to the largest sample.
    equations : list of NormalEquations
        Equations that were solved, for each sample component.
    """
    samples, whole = image
    start = sample_colors(samples, vertices, unit)
    if samples.shape[2] != 4:
        return fit_components(samples, whole, vertices, triangles, unit, start)
    visible = whole * np.maximum(samples[:, :, 3] / peak_of(samples), _HIDDEN_WEIGHT)
    colors, first = fit_components(
        samples[:, :, :3], visible, vertices, triangles, unit, start[:, :3]
    )
    alpha, last = fit_components(samples[:, :, 3:], whole, vertices, triangles, unit, start[:, 3:])
    return np.concatenate([colors, alpha], axis=1), first + last


def fit_components(
    image: SampleArray,
    weights: Float64Array,
    vertices: Int32Array,
    triangles: Int32Array,
    unit: int,
    start: Float64Array,
) -> tuple[Float64Array, list[NormalEquations]]:
    """Colours closest to a picture with a weight for each pixel, each component on its own.

    Parameters
    ----------
    image : ndarray
        Shape (h, w, c), uint8 or uint16.
    weights : ndarray
        Shape (h, w), float64, 0 or more.
    vertices, triangles, unit
        As for :func:`fit_colors`.
    start : ndarray
        Shape (n, c), float64: where the solution starts, and stays where nothing else decides.

    Returns
    -------
    colors : ndarray
        Shape (n, c), float64, 0 to the largest sample.
    equations : list of NormalEquations
        Equations that were solved, for each component.
    """
    products = np.zeros((len(triangles), 6))
    moments = np.zeros(start.shape)
    positions = vertices.astype(np.int64) * (SUBPIXEL // unit)
    samples = np.ascontiguousarray(image, dtype=np.float64)
    accumulate(positions, triangles, samples, weights, products, moments)
    initial = np.ascontiguousarray(start)
    fitted = solve(triangles, products, moments, _RIDGE, initial, _TOLERANCE, _MAX_STEPS)
    equations = [NormalEquations(triangles, products, column) for column in moments.T]
    return np.clip(fitted, 0.0, float(peak_of(image))), equations
