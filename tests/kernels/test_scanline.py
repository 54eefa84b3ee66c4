from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests import twins
from tests.pictures import noise
from tests.strategies import meshes
from vmesh.arrays import Int32Array, Int64Array, SampleArray
from vmesh.kernels.scanline import SUBPIXEL, accumulate, cover, draw, label
from vmesh.mesh import Mesh

ONE_TRIANGLE = np.array([[0, 1, 2]], dtype=np.int32)


def filled(
    vertices: Int64Array, triangles: Int32Array, colors: SampleArray, height: int, width: int
) -> SampleArray:
    raster = np.full((height, width, colors.shape[1]), 99, dtype=colors.dtype)
    draw(vertices, triangles, colors, raster)
    return raster


def filled_slowly(
    vertices: Int64Array, triangles: Int32Array, colors: SampleArray, height: int, width: int
) -> SampleArray:
    raster = np.full((height, width, colors.shape[1]), 99, dtype=colors.dtype)
    twins.fill(vertices, triangles.tolist(), colors, raster)
    return raster


def assert_filled_exactly(vertices: Int64Array, n_components: int, seed: int) -> None:
    """One triangle, turned the positive way, is what exact arithmetic draws."""
    random = np.random.default_rng(seed)
    colors = random.integers(0, 256, (3, n_components), dtype=np.uint8)
    corners = [(int(x), int(y)) for x, y in vertices]
    if twins.doubled_area(*corners) < 0:
        vertices = vertices[::-1].copy()
    result = filled(vertices, ONE_TRIANGLE, colors, 13, 17)
    assert np.array_equal(result, filled_slowly(vertices, ONE_TRIANGLE, colors, 13, 17))


@pytest.mark.parametrize("n_components", [1, 3, 4])
@pytest.mark.parametrize(
    "reach",
    [
        (0, 256 * 17),  # about the raster
        (-256 * 40, 256 * 60),  # clipped
        (-(1 << 17), 1 << 17),  # around the largest determinant for floating point
        (-(1 << 20), 1 << 20),  # the exact path
        (-(1 << 24), 1 << 24),  # the largest coordinates allowed
    ],
)
def test_random_triangles_are_drawn_as_exact_arithmetic_draws_them(
    n_components: int, reach: tuple[int, int]
) -> None:
    random = np.random.default_rng(reach[1] + n_components)
    for seed in range(40):
        vertices = random.integers(*reach, (3, 2), endpoint=True)
        assert_filled_exactly(vertices, n_components, seed)


@given(st.lists(st.tuples(st.integers(-4, 36), st.integers(-4, 28)), min_size=3, max_size=3))
def test_vertices_on_pixel_centres_and_corners_keep_the_top_left_rule(
    corners: list[twins.Point],
) -> None:
    assert_filled_exactly(np.array(corners, dtype=np.int64) * (SUBPIXEL // 2), 3, 1)


@pytest.mark.parametrize("det_side", [1 << 18, (1 << 18) + 256])
def test_both_sides_of_the_largest_floating_point_determinant_are_exact(det_side: int) -> None:
    colors = np.array([[0, 255, 7], [255, 0, 8], [128, 1, 9]], dtype=np.uint8)
    for shift in (0, 1, 127, 128, 255):
        corners = [(shift - det_side // 2, -256), (shift + det_side // 2, -256)]
        corners.append((shift, det_side - 256))
        vertices = np.array(corners, dtype=np.int64)
        result = filled(vertices, ONE_TRIANGLE, colors, 9, 9)
        assert np.array_equal(result, filled_slowly(vertices, ONE_TRIANGLE, colors, 9, 9))


def test_colors_halfway_between_two_levels_are_rounded_up() -> None:
    # Two grey levels one apart over 512 pixels: the centres hit every fraction, 1/2 included.
    vertices = np.array([(0, 0), (1024 * 256, 0), (0, 1024 * 256)], dtype=np.int64)
    colors = np.array([[10], [11], [10]], dtype=np.uint8)
    result = filled(vertices, ONE_TRIANGLE, colors, 1, 1000)
    assert result[0, :512, 0].tolist() == [10] * 512
    vertices[:, 0] += 128
    shifted = filled(vertices, ONE_TRIANGLE, colors, 1, 1000)
    assert shifted[0, 511:513, 0].tolist() == [10, 11]


def just_below_half(reach: int, random: np.random.Generator) -> Int64Array:
    """A triangle whose first weight at the centre of pixel (0, 0) is (det - 1) / 2.

    With sides v1, v2 and the centre at d from their common corner that is cross(2 d, v2) =
    cross(v1, v2) - 1, so v1 = 2 d + u with a vector u whose cross product with v2 is 1.
    """
    while True:
        x2, y2, dx, dy = random.integers(-reach, reach, 4).tolist()
        if y2 == 0 or math.gcd(x2, y2) != 1:
            continue
        # ux y2 - uy x2 = 1
        ux = pow(y2, -1, abs(x2)) if abs(x2) > 1 else 0
        if x2 == 0 or (ux * y2 - 1) % x2:
            continue
        uy = (ux * y2 - 1) // x2
        corner = (128 - dx, 128 - dy)
        corners = [corner, (corner[0] + 2 * dx + ux, corner[1] + 2 * dy + uy)]
        corners.append((corner[0] + x2, corner[1] + y2))
        det = twins.doubled_area(*corners)
        parts = twins.pixel_weights(corners, 0, 0) if det > 0 else None
        if parts is not None and parts[1] == (det - 1) // 2 and det > reach * reach // 4:
            return np.array(corners, dtype=np.int64)


@pytest.mark.parametrize("reach", [1 << 8, 1 << 14, 1 << 17, 1 << 18, 1 << 20, 1 << 22])
def test_colors_a_hair_below_the_middle_of_two_levels_are_rounded_down(reach: int) -> None:
    random = np.random.default_rng(reach)
    for _ in range(50):
        vertices = just_below_half(reach, random)
        level = int(random.integers(255))
        colors = np.array([[level], [level + 1], [level]], dtype=np.uint8)
        assert filled(vertices, ONE_TRIANGLE, colors, 1, 1).tolist() == [[[level]]]


def test_triangles_without_area_or_turned_the_wrong_way_draw_nothing() -> None:
    vertices = np.array([(0, 0), (2560, 0), (0, 2560), (2560, 2560), (1280, 1280)], dtype=np.int64)
    triangles = np.array([[0, 2, 1], [0, 4, 3], [1, 1, 2]], dtype=np.int32)
    colors = np.zeros((5, 3), dtype=np.uint8)
    assert (filled(vertices, triangles, colors, 10, 10) == 99).all()


def test_a_triangle_outside_the_raster_draws_nothing() -> None:
    colors = np.zeros((3, 3), dtype=np.uint8)
    base = np.array([(0, 0), (2560, 0), (0, 2560)], dtype=np.int64)
    for shift in ((-2560, 0), (2560, 0), (0, -2560), (0, 2560), (-(1 << 23), 1 << 23)):
        result = filled(base + shift, ONE_TRIANGLE, colors, 10, 10)
        assert (result == 99).all()


def positions_of(mesh: Mesh) -> Int64Array:
    return mesh.vertices.astype(np.int64) * (SUBPIXEL // mesh.unit)


@given(meshes())
def test_every_pixel_of_a_mesh_is_covered_once(mesh: Mesh) -> None:
    counts = np.zeros((mesh.height, mesh.width), dtype=np.uint8)
    cover(positions_of(mesh), mesh.triangles, counts)
    assert (counts == 1).all()


@given(meshes(), st.integers(-600, 600), st.integers(-600, 600))
def test_a_shifted_mesh_never_covers_a_pixel_twice(mesh: Mesh, right: int, down: int) -> None:
    counts = np.zeros((mesh.height, mesh.width), dtype=np.uint8)
    shifted = positions_of(mesh) + np.array([right, down])
    cover(shifted, mesh.triangles, counts)
    assert counts.max() <= 1
    inside = np.zeros_like(counts)
    for y, x in np.ndindex(inside.shape):
        across, along = 256 * x + 128 - right, 256 * y + 128 - down
        # The top and left border belongs to the mesh, the lower and right one does not.
        if 0 <= across < 256 * mesh.width and 0 <= along < 256 * mesh.height:
            inside[y, x] = 1
    assert np.array_equal(counts, inside)


def test_cover_takes_triangles_turned_either_way() -> None:
    vertices = np.array([(0, 0), (2000, 300), (700, 2500)], dtype=np.int64)
    counts = np.zeros((10, 10), dtype=np.uint8)
    cover(vertices, np.array([[0, 1, 2], [0, 2, 1]], dtype=np.int32), counts)
    assert set(counts.ravel().tolist()) == {0, 2}


@pytest.mark.parametrize("side", [1 << 16, 1 << 24])
def test_deep_samples_are_exact_on_the_largest_triangles(side: int) -> None:
    vertices = np.array([(-side, -side), (side, -side // 3), (-side // 5, side)], dtype=np.int64)
    triangles = np.array([(0, 1, 2)], dtype=np.int32)
    random = np.random.default_rng(side)
    for colors in (random.integers(0, 65_536, (3, 3)), np.array([[65_535] * 3, [0] * 3, [1] * 3])):
        arguments = vertices, triangles, colors.astype(np.uint16), 6, 9
        assert np.array_equal(filled(*arguments), filled_slowly(*arguments))


@given(meshes())
def test_a_mesh_is_drawn_as_exact_arithmetic_draws_it(mesh: Mesh) -> None:
    arguments = positions_of(mesh), mesh.triangles, mesh.colors, mesh.height, mesh.width
    assert np.array_equal(filled(*arguments), filled_slowly(*arguments))


@given(meshes(), st.sampled_from([1, 3]))
def test_the_sums_of_the_fit_are_those_of_the_dense_least_squares_problem(
    mesh: Mesh, n_components: int
) -> None:
    samples = noise(mesh.height, mesh.width, n_components).astype(np.float64)
    weights = np.random.default_rng(3).random((mesh.height, mesh.width))
    products = np.zeros((mesh.n_triangles, 6))
    moments = np.zeros((mesh.n_vertices, n_components))
    positions = positions_of(mesh)
    accumulate(positions, mesh.triangles, samples, weights, products, moments)
    matrix = twins.barycentric_matrix(positions, mesh.triangles.tolist(), mesh.height, mesh.width)
    weighted = matrix.T * weights.ravel()
    expected_moments = weighted @ samples.reshape(-1, n_components)
    assert np.allclose(moments, expected_moments, rtol=1e-9, atol=1e-7)
    dense = np.zeros((mesh.n_vertices, mesh.n_vertices))
    for (i, j, k), sums in zip(mesh.triangles.tolist(), products, strict=True):
        for (a, b), value in zip(
            ((i, i), (j, j), (k, k), (i, j), (j, k), (k, i)), sums, strict=True
        ):
            dense[a, b] += value
            if a != b:
                dense[b, a] += value
    assert np.allclose(dense, weighted @ matrix, rtol=1e-9, atol=1e-9)


@given(meshes())
def test_every_pixel_is_labelled_with_the_triangle_it_belongs_to(mesh: Mesh) -> None:
    positions = positions_of(mesh)
    labels = np.full((mesh.height, mesh.width), -1, dtype=np.int32)
    label(positions, mesh.triangles, labels)
    for y, x in np.ndindex(labels.shape):
        corners = [(int(px), int(py)) for px, py in positions[mesh.triangles[labels[y, x]]]]
        assert labels[y, x] >= 0
        assert twins.pixel_weights(corners, x, y) is not None


def test_later_labels_lie_over_earlier_ones() -> None:
    vertices = np.array([(0, 0), (2560, 0), (0, 2560)], dtype=np.int64)
    labels = np.full((4, 4), -1, dtype=np.int32)
    label(vertices, np.array([[0, 1, 2], [0, 2, 1]], dtype=np.int32), labels)
    assert (labels == 1).all()
