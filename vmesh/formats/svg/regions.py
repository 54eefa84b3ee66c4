"""Regions of a drawing: sets of triangles that share one paint, and the linear gradient that fits.

A linear gradient draws colours that depend on one direction only::

    c(p) = middle + axis * (slope . (p - center))

Position and colour of a region's points have a mean and a scatter: the integral of the products of
their deviations from the mean. The moments of two regions give those of their union, and they tell
the best linear gradient of a region and the squared error that it leaves. With S the scatter of
positions and C that of positions with colours, the best affine map has the matrix inv(S) C; in axes
in which S is the unit matrix its largest singular vector gives the best map of rank 1, which is
what a gradient is (reduced-rank regression).

References
----------
A. J. Izenman, "Reduced-rank regression for the multivariate linear model", Journal of Multivariate
Analysis 5(2), 1975. T. F. Chan, G. H. Golub, R. J. LeVeque, "Updating formulae and a pairwise
algorithm for computing sample variances", COMPSTAT 1982: moments of unions. J. H. Ward,
"Hierarchical grouping to optimize an objective function", Journal of the American Statistical
Association 58(301), 1963: regions that are merged where the squared error grows least.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from vmesh.arrays import Float64Array, Int64Array
from vmesh.kernels.half_edges import find_twins
from vmesh.mesh import Mesh

_CHUNK: Final = 1 << 14  # unions of regions at a time: each takes some kB on the way


@dataclass(frozen=True, slots=True)
class Moments:
    """Moments of regions, of positions and colours together: x, y, red, green, blue.

    Parameters
    ----------
    weights : ndarray
        Shape (n,), float64: areas in square pixels.
    means : ndarray
        Shape (n, 5), float64.
    scatters : ndarray
        Shape (n, 5, 5), float64.
    """

    weights: Float64Array
    means: Float64Array
    scatters: Float64Array

    @classmethod
    def of_triangles(cls, mesh: Mesh, colors: Float64Array) -> Moments:
        """Moments of each triangle; `colors` holds the colours of the vertices, shape (n, 3)."""
        corners = np.concatenate([mesh.points, colors], axis=1)[mesh.triangles]
        means = corners.mean(axis=1)
        apart = corners - means[:, None]
        areas = mesh.doubled_areas() / (2.0 * mesh.unit**2)
        scatters = np.einsum("tij,tik->tjk", apart, apart) * (areas / 12)[:, None, None]
        return cls(areas, means, scatters)

    def take(self, regions: Int64Array) -> Moments:
        """Moments of some regions."""
        return Moments(self.weights[regions], self.means[regions], self.scatters[regions])

    def scaled(self, factors: Float64Array) -> Moments:
        """Moments with weights that are multiplied by `factors`, shape (n,)."""
        scatters = self.scatters * factors[:, None, None]
        return Moments(self.weights * factors, self.means, scatters)

    def joined(self, other: Moments) -> Moments:
        """Moments of the union of each region with its counterpart in `other`."""
        weights = self.weights + other.weights
        share = other.weights / weights
        apart = other.means - self.means
        means = self.means + share[:, None] * apart
        between = apart[:, :, None] * apart[:, None] * (self.weights * share)[:, None, None]
        return Moments(weights, means, self.scatters + other.scatters + between)

    def of_channels(self, channels: Int64Array) -> Moments:
        """Moments with one channel of each region, and black in place of its others; -1 for all."""
        keep = np.ones((len(self.weights), 5))
        chosen = channels >= 0
        keep[chosen, 2:] = np.eye(3)[channels[chosen]]
        scatters = self.scatters * keep[:, :, None]
        scatters *= keep[:, None]
        return Moments(self.weights, self.means * keep, scatters)

    def maps(self) -> Float64Array:
        """Best affine maps from positions to colours, shape (n, 2, 3), in levels per pixel."""
        maps: Float64Array = _inverses(self.scatters[:, :2, :2]) @ self.scatters[:, :2, 2:]
        return maps

    def explained(self) -> Float64Array:
        """Squared errors of flat colours that the best gradients take away, shape (n,)."""
        crossed = self.scatters[:, :2, 2:]
        # Eigenvalues of inv(S) C C^T, which are those of the whitened product.
        matrix = self.maps() @ np.swapaxes(crossed, 1, 2)
        half = (matrix[:, 0, 0] + matrix[:, 1, 1]) / 2
        det = matrix[:, 0, 0] * matrix[:, 1, 1] - matrix[:, 0, 1] * matrix[:, 1, 0]
        largest: Float64Array = half + np.sqrt(np.maximum(half * half - det, 0))
        return largest

    def errors(self) -> Float64Array:
        """Squared errors that the best gradients leave, shape (n,), levels squared times pixels."""
        whole = np.trace(self.scatters[:, 2:, 2:], axis1=1, axis2=2)
        left: Float64Array = whole - self.explained()
        return left


@dataclass(frozen=True, slots=True)
class Slopes:
    """Best gradients of regions, as in the module's formula.

    Parameters
    ----------
    centers : ndarray
        Shape (n, 2), float64, in pixels.
    middles, axes : ndarray
        Shape (n, 3), float64: colours, and unit vectors in the space of colours.
    slopes : ndarray
        Shape (n, 2), float64: levels per pixel.
    """

    centers: Float64Array
    middles: Float64Array
    axes: Float64Array
    slopes: Float64Array

    def take(self, regions: Int64Array) -> Slopes:
        """Gradients of some regions."""
        return Slopes(
            *(array[regions] for array in (self.centers, self.middles, self.axes, self.slopes))
        )

    def followed_by(self, other: Slopes) -> Slopes:
        """Gradients of these regions and then of others."""
        names = ("centers", "middles", "axes", "slopes")
        return Slopes(
            *(np.concatenate([getattr(self, name), getattr(other, name)]) for name in names)
        )

    @classmethod
    def chosen(cls, candidates: Sequence[Slopes], choices: Int64Array) -> Slopes:
        """Gradients of regions, each from the candidate whose number is its choice."""
        regions = np.arange(len(choices))
        names = ("centers", "middles", "axes", "slopes")
        stacks = (np.stack([getattr(each, name) for each in candidates]) for name in names)
        return cls(*(stack[choices, regions] for stack in stacks))

    @classmethod
    def fitted(cls, moments: Moments) -> Slopes:
        """The best gradient of each region."""
        crossed = moments.scatters[:, :2, 2:]
        maps = moments.maps()
        # maps^T crossed = C^T inv(S) C: its first eigenvector is the axis.
        _, vectors = np.linalg.eigh(np.swapaxes(maps, 1, 2) @ crossed)
        axes = vectors[:, :, -1]
        slopes = np.einsum("nij,nj->ni", maps, axes)
        return cls(moments.means[:, :2], moments.means[:, 2:], axes, slopes).turned()

    def turned(self) -> Slopes:
        """Gradients of the same colours, written so that they rise to the right."""
        signs = np.where(self.slopes[:, :1] < 0, -1.0, 1.0)
        return Slopes(self.centers, self.middles, self.axes * signs, self.slopes * signs)


def merge(mesh: Mesh, moments: Moments, largest: float) -> tuple[Int64Array, Moments]:
    """Join neighbouring regions while that adds less than `largest` to the squared error.

    All pairs of which each region is the other's cheapest neighbour join at once, until none is
    left.

    Parameters
    ----------
    mesh : Mesh
    moments : Moments
        Moments of its triangles.
    largest : float
        In squared levels times pixels.

    Returns
    -------
    regions : ndarray
        Shape (m,), int64: the region of each triangle, numbered in the order of first triangles.
    moments : Moments
        Moments of the regions.
    """
    regions = np.arange(mesh.n_triangles)
    if largest <= 0:
        return regions, moments
    current = Moments(moments.weights.copy(), moments.means.copy(), moments.scatters.copy())
    errors = current.errors()
    pairs = _neighbors(mesh)
    costs = _costs(current, errors, pairs)
    while (cheap := np.flatnonzero(costs < largest)).size:
        pairs, costs = pairs[cheap], costs[cheap]
        kept, gone = pairs[_mutual(pairs, costs, len(errors))].T
        _join(current, errors, kept, gone)
        target = np.arange(len(errors))
        target[gone] = kept
        regions = target[regions]
        moved = np.zeros(len(errors), dtype=bool)
        moved[kept] = moved[gone] = True
        stale = moved[pairs[:, 0]] | moved[pairs[:, 1]]
        pairs, first = _distinct(target[pairs])
        costs, stale = costs[first], stale[first]
        costs[stale] = _costs(current, errors, pairs[stale])
    names, numbers = np.unique(regions, return_inverse=True)
    return numbers, current.take(names)


def _neighbors(mesh: Mesh) -> Int64Array:
    """Pairs of triangles that share a side, shape (k, 2), the lower first."""
    twins = find_twins(mesh.triangles, mesh.n_vertices)
    half_edges = np.arange(len(twins))
    inner = twins > half_edges
    return np.stack([half_edges[inner] // 3, twins[inner] // 3], axis=1)


def _costs(moments: Moments, errors: Float64Array, pairs: Int64Array) -> Float64Array:
    """Growth of the squared error where pairs of regions join, shape (k,)."""
    costs = np.empty(len(pairs))
    for start in range(0, len(pairs), _CHUNK):
        first, second = pairs[start : start + _CHUNK].T
        union = moments.take(first).joined(moments.take(second))
        costs[start : start + _CHUNK] = union.errors() - errors[first] - errors[second]
    return costs


def _mutual(pairs: Int64Array, costs: Float64Array, n_regions: int) -> Int64Array:
    """Pairs, by index, of which each region is the other's cheapest neighbour."""
    dear_first = np.argsort(costs, kind="stable")[::-1]
    cheapest = np.full(n_regions, -1)
    # Of several values for one place the last stays.
    cheapest[pairs[dear_first].ravel()] = np.repeat(dear_first, 2)
    best = cheapest[pairs]
    mutual: Int64Array = np.flatnonzero(
        (best[:, 0] == best[:, 1]) & (best[:, 0] == np.arange(len(pairs)))
    )
    return mutual


def _join(moments: Moments, errors: Float64Array, kept: Int64Array, gone: Int64Array) -> None:
    """Put the union of each pair of regions in place of the first."""
    union = moments.take(kept).joined(moments.take(gone))
    moments.weights[kept], moments.means[kept] = union.weights, union.means
    moments.scatters[kept] = union.scatters
    errors[kept] = union.errors()


def _distinct(pairs: Int64Array) -> tuple[Int64Array, Int64Array]:
    """Pairs of different regions, each once, the lower first, and where each was found."""
    ordered = np.sort(pairs, axis=1)
    ordered[ordered[:, 0] == ordered[:, 1]] = -1
    keys = (ordered[:, 0] << 32) | ordered[:, 1]
    keys, first = np.unique(keys, return_index=True)
    first = first[keys >= 0]
    return ordered[first], first


def _inverses(matrices: Float64Array) -> Float64Array:
    """Inverses of positive symmetric matrices of shape (n, 2, 2)."""
    (a, b), (_, d) = np.moveaxis(matrices, 0, -1)
    inverse: Float64Array = np.array([[d, -b], [-b, a]]) / (a * d - b * b)
    return np.moveaxis(inverse, -1, 0)
