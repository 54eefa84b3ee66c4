"""Measures of how close two pictures are: PSNR and SSIM."""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt
from scipy.ndimage import gaussian_filter

from vmesh.arrays import Float64Array, UInt8Array

_LUMA: Final = np.array([0.299, 0.587, 0.114])
_SIGMA: Final = 1.5
_RADIUS: Final = 5  # an 11 x 11 window
_STABILIZERS: Final = ((0.01 * 255) ** 2, (0.03 * 255) ** 2)


def compare(first: UInt8Array, second: UInt8Array) -> dict[str, float]:
    """Measures of the difference of two pictures of one size.

    Parameters
    ----------
    first, second : ndarray
        Shape (h, w, 3), uint8.

    Returns
    -------
    dict
        ``psnr_rgb`` over all three components and ``psnr_y`` over BT.601 luma, in dB, infinite
        for equal pictures; ``ssim`` of luma, at most 1.
    """
    if first.shape != second.shape:
        raise ValueError(f"expected pictures of one size, got {first.shape} and {second.shape}")
    luma, other_luma = first @ _LUMA, second @ _LUMA
    return {
        "psnr_rgb": psnr(first, second),
        "psnr_y": psnr(luma, other_luma),
        "ssim": ssim(luma, other_luma),
    }


def psnr(first: npt.ArrayLike, second: npt.ArrayLike) -> float:
    """Peak signal-to-noise ratio of two arrays of one shape with values of 0 to 255, in dB."""
    ones, others = np.asarray(first), np.asarray(second)
    # Row by row: differences of all samples at once would take eight times a picture's memory.
    rows = (np.subtract(a, b, dtype=np.float64) for a, b in zip(ones, others, strict=True))
    error = sum(float(np.vdot(row, row)) for row in rows) / ones.size
    return float("inf") if error == 0.0 else float(10.0 * np.log10(255.0**2 / error))


def ssim(first: Float64Array, second: Float64Array) -> float:
    """Mean structural similarity of two planes of shape (h, w) with values of 0 to 255.

    A Gaussian window of 11 x 11 with a standard deviation of 1.5; windows that cross the border
    do not count unless the picture is smaller than one.

    References
    ----------
    Z. Wang, A. C. Bovik, H. R. Sheikh, E. P. Simoncelli, "Image quality assessment: from error
    visibility to structural similarity", IEEE Trans. Image Processing 13(4), 2004, equation (13).
    """

    def blur(plane: Float64Array) -> Float64Array:
        result: Float64Array = gaussian_filter(plane, _SIGMA, radius=_RADIUS)
        return result

    mean1, mean2 = blur(first), blur(second)
    variance1 = blur(first * first) - mean1 * mean1
    variance2 = blur(second * second) - mean2 * mean2
    covariance = blur(first * second) - mean1 * mean2
    c1, c2 = _STABILIZERS
    similarity = ((2 * mean1 * mean2 + c1) * (2 * covariance + c2)) / (
        (mean1 * mean1 + mean2 * mean2 + c1) * (variance1 + variance2 + c2)
    )
    if min(first.shape) > 2 * _RADIUS:
        similarity = similarity[_RADIUS:-_RADIUS, _RADIUS:-_RADIUS]
    return float(similarity.mean())
