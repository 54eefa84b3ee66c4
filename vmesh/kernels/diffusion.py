"""Error diffusion of a salience map into sample points, one class of points per plane.

The picture is scanned in serpentine order. At each pixel the salience of all classes, plus the
error that earlier pixels passed on, decides *whether* the pixel becomes a sample; the class with
the largest corrected value gets it. Every class then passes on its own error::

    scan ->      *   d10          a row that is scanned the other way is mirrored
         d-11   d01

so no two classes share a pixel, each class keeps its own density, and their union is as blue as
the samples of one plane. With one plane this is the plain error diffusion of its authors.

Salience counts in 1/256 of a level of 0..255, so that scaled-down maps keep their gradations; the
coefficients of the nearest whole level apply. All arithmetic is in integers.

References
----------
B. Zhou, X. Fang, "Improving mid-tone quality of variable-coefficient error diffusion using
threshold modulation", SIGGRAPH 2003. V. Ostromoukhov, "A simple and efficient error-diffusion
algorithm", SIGGRAPH 2001. L.-Y. Wei, "Multi-class blue noise sampling", SIGGRAPH 2010: the aim, not
the method. G. Marsaglia, "Xorshift RNGs", Journal of Statistical Software 8(14), 2003: the random
thresholds.
"""

from __future__ import annotations

import numpy as np

from vmesh.arrays import Int64Array, UInt8Array, UInt16Array
from vmesh.kernels.jit import kernel


@kernel
def diffuse(
    salience: UInt16Array,
    scale: int,
    floor: int,
    weights: Int64Array,
    strengths: Int64Array,
    seed: int,
) -> UInt8Array:
    """Class of the sample at each pixel: 0 for none, i + 1 for a sample of plane i.

    Parameters
    ----------
    salience : ndarray
        Shape (c, h, w), uint16, in 1/256 level: 0 to 255 * 256.
    scale : int
        Factor on the salience in units of 2**-16, at most 2**40.
    floor : int
        Added to the scaled salience of every plane, in 1/256 level.
    weights : ndarray
        Shape (256, 3), int64: shares of the error that go right, behind below and below, in
        units of 2**-16, by input level.
    strengths : ndarray
        Shape (256,), int64: threshold modulation by input level, in units of 2**-16.
    seed : int
        Start of the random thresholds.

    Returns
    -------
    ndarray
        Shape (h, w), uint8.
    """
    n_classes, height, width = salience.shape
    one = 255 * 256
    classes = np.zeros((height, width), np.uint8)
    # Errors that the row above passed down and that this row passes down, a column wider on each
    # side.
    above = np.zeros((width + 2, n_classes), np.int64)
    below = np.zeros((width + 2, n_classes), np.int64)
    values = np.zeros(n_classes, np.int64)
    carried = np.zeros(n_classes, np.int64)  # to the next pixel of the row
    pending = np.zeros(n_classes, np.int64)  # below the pixel before, still lacking one share
    random = (seed * 2654435761 + 1013904223) & 0xFFFFFFFF
    if random == 0:
        random = 1
    for y in range(height):
        step = 1 if y % 2 == 0 else -1
        x = 1 if step == 1 else width
        carried[:] = 0
        pending[:] = 0
        for _ in range(width):
            total = 0
            for i in range(n_classes):
                wanted = ((np.int64(salience[i, y, x - 1]) * scale) >> 16) + floor
                values[i] = min(np.int64(one), wanted)
                total += values[i]
            if total > one:  # A pixel holds one sample: the classes share it in proportion.
                for i in range(n_classes):
                    values[i] = values[i] * one // total
                total = one
            level = (total + 128) >> 8
            corrected = 0
            chosen = 0
            for i in range(n_classes):
                values[i] += above[x, i] + carried[i]
                corrected += values[i]
                if values[i] > values[chosen]:
                    chosen = i
            # xorshift32
            random ^= (random << 13) & 0xFFFFFFFF
            random ^= random >> 17
            random ^= (random << 5) & 0xFFFFFFFF
            threshold = 127 * 256
            if strengths[level] > 0:
                threshold = 128 * 256 + (((random & 127) * strengths[level]) >> 8)
            if corrected > threshold:
                classes[y, x - 1] = chosen + 1
                values[chosen] -= one
            for i in range(n_classes):
                behind = (values[i] * weights[level, 1]) >> 16
                carried[i] = (values[i] * weights[level, 0]) >> 16
                below[x - step, i] = pending[i] + behind
                pending[i] = values[i] - carried[i] - behind
            x += step
        for i in range(n_classes):
            below[x - step, i] = pending[i]
        above, below = below, above
    return classes
