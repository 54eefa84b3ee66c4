"""Surfaces to edit in the tests, and what must hold of every one of them."""

from __future__ import annotations

import numpy as np

from tests.twins import directed_edges, in_circle_determinant
from vmesh.arrays import Float64Array, Int32Array, Int64Array, UInt8Array
from vmesh.color_lattice import ColorLattice
from vmesh.kernels.delaunay import delaunay
from vmesh.kernels.remeshing import Surface, WeightedImage, make_workspace, measure
from vmesh.mesh import Mesh


def scattered(width: int, height: int, n: int, seed: int) -> Int32Array:
    """Corners, four border points and `n` random pixel centres in half pixels, in raster order.

    No four of them are on a circle but the corners: there is one Delaunay triangulation.
    """
    random = np.random.default_rng(seed)
    right, bottom = 2 * width, 2 * height
    points = [(0, 0), (right, 0), (0, bottom), (right, bottom)]

    def is_free(x: int, y: int) -> bool:
        """Whether a point is on no circle through three others, and on none of them."""
        return (x, y) not in points and all(
            in_circle_determinant(points[i], points[j], points[k], (x, y))
            for i in range(len(points))
            for j in range(i)
            for k in range(j)
        )

    while len(points) < n + 8:
        x, y = 2 * random.integers([width, height]) + 1
        side = len(points) - 4
        if side < 4:
            x, y = [(x, 0), (x, bottom), (0, y), (right, y)][side]
        if is_free(int(x), int(y)):
            points.append((int(x), int(y)))
    return np.array(sorted(points, key=lambda p: (p[1], p[0])), dtype=np.int32)


def evenly(samples: UInt8Array) -> WeightedImage:
    """A picture of which every pixel counts alike."""
    return WeightedImage(samples, np.ones(samples.shape[:2]))


def unevenly(samples: UInt8Array, seed: int = 0) -> WeightedImage:
    """A picture of which some pixels count three times as much as others, and some nothing."""
    weights = np.random.default_rng(seed).choice([0.0, 0.5, 1.0, 1.5, 3.0], samples.shape[:2])
    return WeightedImage(samples, weights)


def open_surface(
    image: WeightedImage, vertices: Int32Array, colors: Float64Array, n_spare: int = 0
) -> Surface:
    """The Delaunay triangles of some vertices, measured, with work for more vertices."""
    triangles = delaunay(vertices)
    n_edges, more = triangles.size, 6 * n_spare
    edges = directed_edges(triangles)
    twins = [edges.get((v, u), -1) for u, v in edges]
    leaving = np.full(len(vertices) + n_spare, -1, dtype=np.int64)
    leaving[triangles.ravel()] = np.arange(n_edges)
    surface = Surface(
        points=np.concatenate([vertices, np.zeros((n_spare, 2))]).astype(np.int64),
        colors=np.concatenate([colors, np.zeros((n_spare, colors.shape[1]))]),
        origin=np.concatenate([triangles.ravel(), np.full(more, -1)]).astype(np.int64),
        twin=np.array([*twins, *[-1] * more], dtype=np.int64),
        leaving=leaving,
        errors=np.zeros(len(triangles) + 2 * n_spare),
        dirty=np.ones(len(vertices) + n_spare, dtype=bool),
    )
    measure_all(surface, image)
    return surface


def measure_all(surface: Surface, image: WeightedImage) -> float:
    """Compute the errors of all triangles anew; their sum."""
    work = make_workspace(image.samples.shape[0], image.samples.shape[2])
    measure(surface, image, work, 0, len(surface.errors))
    return float(surface.errors.sum())


def triangles_of(surface: Surface) -> Int32Array:
    """Triangles in use, shape (m, 3), int32."""
    triangles = surface.origin.reshape(-1, 3)
    return triangles[triangles[:, 0] >= 0].astype(np.int32)


def check_surface(surface: Surface, width: int, height: int) -> None:
    """Check that the half-edges agree with each other, and that the mesh passes its check."""
    origin, twin = surface.origin, surface.twin
    edges = np.arange(len(origin))
    after = edges - edges % 3 + (edges + 1) % 3
    in_use = origin >= 0
    assert (in_use.reshape(-1, 3).all(axis=1) == in_use.reshape(-1, 3).any(axis=1)).all()
    assert (twin[~in_use] == -1).all()
    assert (surface.errors[~in_use[::3]] == 0).all()
    inner = np.flatnonzero(twin >= 0)
    assert (twin[twin[inner]] == inner).all()
    assert (origin[twin[inner]] == origin[after[inner]]).all()
    assert (origin[after[twin[inner]]] == origin[inner]).all()
    used = np.flatnonzero(surface.leaving >= 0)
    assert (origin[surface.leaving[used]] == used).all()
    assert np.array_equal(np.unique(origin[in_use]), used)
    assert np.isfinite(surface.colors).all()
    check_mesh(surface.points, triangles_of(surface), width, height)


def check_mesh(points: Int64Array, triangles: Int32Array, width: int, height: int) -> None:
    """Check that triangles cover a canvas, each edge once on either side."""
    used = np.unique(triangles)
    rank = np.zeros(len(points), dtype=np.int32)
    rank[used] = np.arange(len(used))
    lattice = ColorLattice((1,))
    levels = lattice.zero_levels(len(used))
    vertices = points[used].astype(np.int32)
    Mesh(width, height, vertices, rank[triangles], levels, lattice, subdivision=1).check()
