"""Thinning against a twin that triangulates the whole mesh anew for every candidate."""

from __future__ import annotations

import numpy as np
import pytest

import vmesh
from tests.pictures import constant, noise, ramp
from vmesh.arrays import BoolArray, Float64Array, Int32Array, UInt8Array
from vmesh.encoder.thinning import thin_vertices
from vmesh.kernels.delaunay import delaunay
from vmesh.kernels.scanline import SUBPIXEL, label
from vmesh.kernels.thinning import find_twins, thin, triangle_error
from vmesh.metrics import psnr


def scattered(width: int, height: int, n: int, seed: int) -> Int32Array:
    """Corners, some border points and `n` random ones in half pixels, in raster order."""
    random = np.random.default_rng(seed)
    right, bottom = 2 * width, 2 * height
    points = {(0, 0), (right, 0), (0, bottom), (right, bottom), (right // 3, 0), (0, bottom // 2)}
    points |= {(int(x), int(y)) for x, y in random.integers(1, [right, bottom], (n, 2))}
    return np.array(sorted(points, key=lambda p: (p[1], p[0])), dtype=np.int32)


def mesh_error(
    vertices: Int32Array, triangles: Int32Array, colors: Float64Array, image: UInt8Array
) -> float:
    """Squared error of a mesh over all pixels, through the labels of the pixels' triangles."""
    height, width = image.shape[:2]
    labels = np.full((height, width), -1, dtype=np.int32)
    label(vertices.astype(np.int64) * (SUBPIXEL // 2), triangles, labels)
    total = 0.0
    for y in range(height):
        for x in range(width):
            corners = triangles[labels[y, x]]
            system = np.vstack([vertices[corners].T, np.ones(3)])
            weights = np.linalg.solve(system, [2 * x + 1, 2 * y + 1, 1])
            total += float(((weights @ colors[corners] - image[y, x]) ** 2).sum())
    return total


def thinned_by_trying_all(
    vertices: Int32Array, colors: Float64Array, image: UInt8Array, n_keep: int
) -> BoolArray:
    """Greedy removal in which each candidate is judged by the error of its whole mesh."""
    right, bottom = vertices.max(axis=0)
    kept = np.ones(len(vertices), dtype=bool)
    while kept.sum() > n_keep:
        best, victim = np.inf, -1
        for v in np.flatnonzero(kept):
            if vertices[v, 0] in (0, right) and vertices[v, 1] in (0, bottom):
                continue
            rest = kept.copy()
            rest[v] = False
            corners = np.ascontiguousarray(vertices[rest])
            error = mesh_error(corners, delaunay(corners), colors[rest], image)
            if error < best:
                best, victim = error, int(v)
        kept[victim] = False
    return kept


@pytest.mark.parametrize("seed", range(4))
def test_the_cheapest_vertex_goes_first(seed: int) -> None:
    image = noise(9, 11, 3, seed=seed)
    # Points in general position: cocircular ones may be triangulated either way on the way.
    vertices = scattered(11, 9, 14, seed)
    colors = np.random.default_rng(seed).uniform(0, 255, (len(vertices), 3))
    triangles = delaunay(vertices)
    kept = thin(
        vertices.astype(np.int64),
        triangles.reshape(-1).copy(),
        find_twins(triangles, len(vertices)),
        colors,
        image,
        8,
    )
    # Ties in the triangulation can change single choices, never the error by much.
    expected = thinned_by_trying_all(vertices, colors, image, 8)
    errors = [
        mesh_error(vertices[k], delaunay(np.ascontiguousarray(vertices[k])), colors[k], image)
        for k in (kept, expected)
    ]
    assert kept.sum() == 8
    assert (kept == expected).all() or errors[0] <= 1.05 * errors[1]


@pytest.mark.parametrize("n_components", [1, 3, 4])
def test_the_triangles_share_the_error_of_the_mesh(n_components: int) -> None:
    image = noise(8, 10, n_components)
    vertices = scattered(10, 8, 25, 3)
    triangles = delaunay(vertices)
    colors = np.random.default_rng(0).uniform(0, 255, (len(vertices), n_components))
    points = vertices.astype(np.int64)
    total = sum(triangle_error(points, colors, image, *map(int, corners)) for corners in triangles)
    assert total == pytest.approx(mesh_error(vertices, triangles, colors, image))


def test_twins_are_the_reversed_edges() -> None:
    vertices = scattered(30, 20, 200, 5)
    triangles = delaunay(vertices)
    twins = find_twins(triangles, len(vertices))
    starts, ends = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    places = {edge: e for e, edge in enumerate(zip(starts.tolist(), ends.tolist(), strict=True))}
    for e, (u, v) in enumerate(zip(starts.tolist(), ends.tolist(), strict=True)):
        assert twins[e] == places.get((v, u), -1)


def test_the_corners_and_nothing_else_are_left_in_the_end() -> None:
    vertices = scattered(30, 20, 200, 6)
    kept = thin_vertices(noise(20, 30), vertices, 4)
    assert kept.tolist() == [[0, 0], [60, 0], [0, 40], [60, 40]]


def test_thinning_to_more_than_there_are_changes_nothing() -> None:
    vertices = scattered(30, 20, 50, 7)
    assert thin_vertices(noise(20, 30), vertices, 1000) is vertices


def test_adaptive_meshes_are_far_better_at_the_same_number_of_vertices(chelsea: UInt8Array) -> None:
    picture = chelsea[40:200, 80:280]
    plain = vmesh.encode(picture, vertices=800)
    adaptive = vmesh.encode(picture, vertices=plain.n_vertices, method="adaptive")
    assert adaptive.n_vertices == plain.n_vertices
    adaptive.check()
    gain = psnr(vmesh.render(adaptive), picture) - psnr(vmesh.render(plain), picture)
    assert gain > 1.5


@pytest.mark.parametrize(
    "picture",
    [
        constant(1, 1, 7),
        constant(40, 1, 1, 2, 3),
        constant(20, 30, 9, 9, 9),
        ramp(24, 17),
        noise(20, 20, 4),
    ],
    ids=["one pixel", "one column", "constant", "ramp", "noise"],
)
def test_adaptive_meshes_of_odd_pictures_are_sound(picture: UInt8Array) -> None:
    mesh = vmesh.encode(picture, method="adaptive", vertices=6)
    mesh.check()
    assert 4 <= mesh.n_vertices <= 6
    assert vmesh.loads(vmesh.dumps(mesh)) == mesh.canonical()


def test_adaptive_encoding_takes_a_density_of_its_own(chelsea: UInt8Array) -> None:
    picture = np.ascontiguousarray(chelsea[:100, :100])
    assert vmesh.encode(picture, method="adaptive").n_vertices == 200
