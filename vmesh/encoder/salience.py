"""Salience: how much a picture changes at each pixel, per colour plane."""

from __future__ import annotations

from typing import Final

import numpy as np

from vmesh.arrays import Float64Array, SampleArray, UInt16Array
from vmesh.kernels.sobel import sobel4

LEVEL: Final = 256
"""Salience is counted in units of 1 / LEVEL of the paper's levels of 0 to 255."""

ONE: Final = 255 * LEVEL
"""The largest salience: a pixel that is sure to become a sample."""

_MAX_RESPONSE: Final = 4 * 255


def compute_salience(planes: SampleArray, gamma: float = 1.0) -> UInt16Array:
    """Salience map of every colour plane.

    F = 255 (x / max)^gamma, where x is the improved Sobel response and max its maximum over the
    plane. The paper prints the exponent as 1 / gamma; its text ("smaller gamma gives more
    points"), its Table 1 and its Fig. 8 agree on gamma.

    Parameters
    ----------
    planes : ndarray
        Shape (c, h, w), uint8; of uint16 the upper byte counts.
    gamma : float
        Contrast of the map, above 0; a smaller value gives more points.

    Returns
    -------
    ndarray
        Shape (c, h, w), uint16, in 1/256 level: 0 to 255 * 256. Zero where a plane is constant.

    References
    ----------
    J. Zhao, J. Feng, B. Zhou, "Image vectorization using blue-noise sampling", Proc. SPIE 8664,
    2013, section 2.1 and equation (1).
    """
    if not gamma > 0.0:
        raise ValueError(f"expected a gamma above 0, got {gamma}")
    salience = np.zeros(planes.shape, dtype=np.uint16)
    if planes.dtype == np.uint16:
        planes = (planes >> 8).astype(np.uint8)
    for plane, result in zip(planes, salience, strict=True):
        response = sobel4(np.pad(plane, 1, mode="edge"))
        largest = int(response.max())
        if largest > 0:
            curve = np.arange(_MAX_RESPONSE + 1) / largest
            table = np.rint(ONE * np.minimum(curve, 1.0) ** gamma).astype(np.uint16)
            table[0] = 0
            result[:] = table[response]
    return salience


def emphasised(salience: UInt16Array, weights: Float64Array) -> UInt16Array:
    """Salience of a picture whose pixels do not all count alike.

    Salience goes with differences and weights count squared ones, so it grows with their root.

    Parameters
    ----------
    salience : ndarray
        Shape (c, h, w), uint16, as :func:`compute_salience` gives it.
    weights : ndarray
        Shape (h, w), float64, with a mean of 1.
    """
    if weights.min() == weights.max():
        return salience
    return np.rint(np.minimum(salience * np.sqrt(weights), ONE)).astype(np.uint16)
