"""The rate model: what bits, vertices and flips are expected to cost and to gain.

The encoder minimises D + lambda R, squared error plus lambda times bits. One lambda decides which
vertices are worth their bits, which flips, and which levels; what is expected of all of them stands
here. With n vertices the squared error is about D = c n**-p, p = ``ERROR_POWER``, and bits are
proportional to vertices, so at the optimum, where dD/dR = -lambda,

    lambda = p D / R.

References
----------
Y. Shoham, A. Gersho, "Efficient bit allocation for an arbitrary set of quantizers", IEEE
Transactions on Acoustics, Speech, and Signal Processing 36(9), 1988: one lambda for all decisions.
"""

from __future__ import annotations

from math import sqrt
from typing import Final, Protocol

ERROR_POWER: Final = 0.85
"""The error falls with about this power of the number of vertices, and so of the bits."""
SAMPLED_POWER: Final = 1.6
"""Lambda falls with about this power of the number of vertices that are only sampled."""

# ERROR_POWER divided by the bits of a vertex, which are about 19 in a refined mesh.
_LAMBDA: Final = 0.045
# What a vertex has to be worth to stay when a mesh is thinned: the bits that it takes, and what it
# will gain in its final place.
_STAYING_BITS: Final = 20.0
# Bits of a vertex for a first guess, and bytes of a file beside its vertices.
_FIRST_BITS: Final = 18.0
_FRAME_BYTES: Final = 28
# Bits that an edge costs if it is not Delaunay.
_FLIP_BITS: Final = 3.5

# Size of a mesh after refinement, by that before: 1.19 to 1.34 on five photographs at three sizes.
_REFINED_SIZE: Final = 1.28
# Error of a mesh before refinement, by that after it.
_REFINEMENT_GAIN: Final = 1.6

# At quality 75 a bit saves this much squared error, and 25 points of quality change it by the
# factor.
_LAMBDA_AT_75: Final = 400.0
_LAMBDA_FACTOR: Final = 15.0
# Lambda of a mesh when it is finished, by that which it was thinned for: 0.15 to 0.25 on three
# photographs at quality 75, efforts 2 and 5.
_FINISHED_LAMBDA: Final = 0.2
# Lambda at quality 100 falls with this power of the size of a small picture.
_SMALLER_POWER: Final = 2.0
# The luma step for a root mean square error of 1. Measured on four photographs at three densities
# each: 0.8, 1.0, 1.3 and 1.7 times as much change the PSNR at equal bytes by -0.03, 0, -0.04 and
# -0.19 dB.
_STEP: Final = 1.08


class Measured(Protocol):
    """A mesh whose error is known."""

    @property
    def n_vertices(self) -> int:
        """Number of vertices."""

    @property
    def error(self) -> float:
        """Squared error, summed over all samples."""


def lambda_of(mesh: Measured) -> float:
    """Squared error that a bit is worth at a mesh's number of vertices."""
    return lambda_for(mesh.error, mesh.n_vertices)


def lambda_for(error: float, n_vertices: int) -> float:
    """Squared error that a bit is worth where so many vertices leave a squared error."""
    return _LAMBDA * error / n_vertices


def lambda_of_quality(quality: int, peak: int) -> float:
    """Squared error that a bit has to save at a quality of 0 to 100, for samples up to `peak`."""
    return float(_LAMBDA_AT_75 * _LAMBDA_FACTOR ** ((75 - quality) / 25)) * (peak / 255) ** 2


def lambda_of_small_picture(quality: int, peak: int, share: float) -> float:
    """Squared error that a bit of a finished mesh saves at a quality, in a small picture.

    `share`, up to 1, is that of the pixels which a small picture may have. Above 75 lambda falls
    the faster, the fewer there are: at 100 a few hundred pixels come out all but exactly.
    """
    faster: float = share ** (_SMALLER_POWER * (max(0, quality - 75) / 25) ** 2)
    return _FINISHED_LAMBDA * faster * lambda_of_quality(quality, peak)


def staying_cost(lambda_: float) -> float:
    """Squared error that a vertex has to save to stay in a mesh."""
    return _STAYING_BITS * lambda_


def flip_cost(lambda_: float) -> float:
    """Squared error that an edge has to save if it is not Delaunay."""
    return _FLIP_BITS * lambda_


def luma_step(error: float, n_samples: int, peak: int) -> int:
    """Step of the luma lattice for a squared error over some samples of up to `peak`."""
    return min(max(round(exact_luma_step(error, n_samples)), 1), peak)


def exact_luma_step(error: float, n_samples: int) -> float:
    """Step of the luma lattice, not rounded, for a squared error over some samples."""
    return _STEP * sqrt(error / n_samples)


def error_before_refinement(error: float) -> float:
    """Squared error of a mesh that will have the given one when it is refined."""
    return _REFINEMENT_GAIN * error


def size_after_refinement(size: int) -> int:
    """Bytes that a file will take when its mesh is refined."""
    return round(_REFINED_SIZE * size)


def vertices_for(target_size: int) -> int:
    """Number of vertices to start from for a file of some bytes."""
    return max(4, round(8 * (target_size - _FRAME_BYTES) / _FIRST_BITS))


def rescaled_vertices(n_vertices: int, size: int, metadata_size: int, aim: float) -> int:
    """Number of vertices for a file of `aim` bytes, judging by one of `size` bytes."""
    n_bytes = max(size - _FRAME_BYTES - metadata_size, 1) / n_vertices
    return n_vertices + round((aim - size) / n_bytes)
