"""Proposals: places where the vertices of a mesh might be, sampled from a picture's salience."""

from __future__ import annotations

from vmesh.arrays import UInt16Array
from vmesh.encoder.image import premultiplied_planes
from vmesh.encoder.salience import compute_salience, emphasised
from vmesh.encoder.sampling import Samples, sample
from vmesh.encoder.settings import Settings
from vmesh.kernels.remeshing import WeightedImage


def propose(image: WeightedImage, settings: Settings) -> tuple[UInt16Array, Samples]:
    """Salience of a picture and the points sampled from it, before any thinning.

    Parameters
    ----------
    image : WeightedImage
    settings : Settings
        With a number of vertices or a density; otherwise gamma decides on the number of points.

    Returns
    -------
    salience : ndarray
        Shape (c, h, w), uint16, as :func:`compute_salience` gives it, more where pixels count more.
    samples : Samples
    """
    height, width = image.weights.shape
    salience = compute_salience(premultiplied_planes(image.samples), settings.gamma)
    salience = emphasised(salience, image.weights)
    samples = sample(
        salience,
        n_points=settings.n_vertices(width, height),
        sampler=settings.sampler,
        diffusion=settings.diffusion,
        seed=settings.seed,
    )
    return salience, samples
