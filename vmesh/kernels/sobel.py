"""The improved Sobel operator: the largest of four directional differences."""

from __future__ import annotations

import numpy as np

from vmesh.arrays import UInt8Array, UInt16Array
from vmesh.kernels.jit import kernel


@kernel
def sobel4(plane: UInt8Array) -> UInt16Array:
    """Largest absolute response of the four Sobel templates at each pixel.

    The templates measure differences at 0, 90, 45 and 135 degrees::

        -1 -2 -1     -1  0  1      2  1  0      0  1  2
         0  0  0     -2  0  2      1  0 -1     -1  0  1
         1  2  1     -1  0  1      0 -1 -2     -2 -1  0

    Parameters
    ----------
    plane : ndarray
        Shape (h + 2, w + 2), uint8, contiguous: a plane with a margin of one pixel.

    Returns
    -------
    ndarray
        Shape (h, w), uint16, 0 to 1020.

    References
    ----------
    J. Zhao, J. Feng, B. Zhou, "Image vectorization using blue-noise sampling", Proc. SPIE 8664,
    2013, section 2.1.
    """
    height, width = plane.shape[0] - 2, plane.shape[1] - 2
    response = np.empty((height, width), np.uint16)
    for y in range(height):
        for x in range(width):
            nw, n, ne = np.int32(plane[y, x]), np.int32(plane[y, x + 1]), np.int32(plane[y, x + 2])
            w, e = np.int32(plane[y + 1, x]), np.int32(plane[y + 1, x + 2])
            sw = np.int32(plane[y + 2, x])
            s = np.int32(plane[y + 2, x + 1])
            se = np.int32(plane[y + 2, x + 2])
            two = np.int32(2)
            vertical = abs(sw + two * s + se - nw - two * n - ne)
            horizontal = abs(ne + two * e + se - nw - two * w - sw)
            falling = abs(two * nw + n + w - e - s - two * se)
            rising = abs(two * ne + n + e - w - s - two * sw)
            response[y, x] = max(max(vertical, horizontal), max(falling, rising))
    return response
