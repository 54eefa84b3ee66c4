from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import Delaunay

from tests import twins
from tests.strategies import flipped, point_sets, raster_sorted
from vmesh.arrays import Int32Array, Int64Array
from vmesh.kernels.delaunay import (
    TOO_MANY_FLIPS,
    delaunay,
    flip_to_delaunay,
    sweep,
)
from vmesh.kernels.half_edges import find_twins, sort_triangles
from vmesh.kernels.predicates import in_circle
from vmesh.limits import MAX_LATTICE_SIDE
from vmesh.mesh.canonical_order import sorted_triangles


def random_grid(random: np.random.Generator, columns: int, rows: int, share: float) -> Int32Array:
    """Sites of a grid, each taken with a probability: dense ones are full of common circles."""
    y, x = np.nonzero(random.random((rows, columns)) < share)
    return np.stack([x, y], axis=1).astype(np.int32)


def as_points(vertices: Int32Array) -> list[twins.Point]:
    return [(int(x), int(y)) for x, y in vertices]


def as_faces(triangles: Int32Array) -> list[twins.Face]:
    return [(int(a), int(b), int(c)) for a, b, c in triangles]


def swept(vertices: Int32Array, order: Int64Array) -> list[twins.Face]:
    """Triangles of a sweep in a given order."""
    triangles = np.empty((2 * len(vertices), 3), dtype=np.int64)
    cx, cy = vertices.mean(axis=0).tolist()
    count = sweep(vertices.astype(np.int64), order, cx, cy, triangles)
    return as_faces(sort_triangles(triangles[:count].astype(np.int32), len(vertices)))


def assert_local_rule(points: list[twins.Point], faces: list[twins.Face]) -> None:
    """No edge should be flipped: circles are empty, and ties go to the raster-last vertex."""
    apex = {}
    for a, b, c in faces:
        assert twins.doubled_area(points[a], points[b], points[c]) > 0
        for edge, across in (((a, b), c), ((b, c), a), ((c, a), b)):
            assert edge not in apex, "two triangles on the same side of an edge"
            apex[edge] = across
    for (b, c), a in apex.items():
        d = apex.get((c, b))
        if d is not None:
            sign = twins.in_circle_determinant(points[a], points[b], points[c], points[d])
            assert sign < 0 or (sign == 0 and max(a, d) < max(b, c))


def test_points_in_general_position_give_the_triangles_of_scipy() -> None:
    random = np.random.default_rng(5)
    for n in (3, 4, 10, 100, 3000):
        points = np.unique(random.integers(0, MAX_LATTICE_SIDE, (n, 2)), axis=0)
        vertices = raster_sorted(points.astype(np.int32))
        expected = Delaunay(vertices.astype(float)).simplices
        ours = {frozenset(face) for face in as_faces(delaunay(vertices))}
        # Slivers on the hull are beyond scipy's floating point: there it may leave some out.
        theirs = {frozenset(int(v) for v in face) for face in expected}
        assert theirs <= ours
        assert len(ours - theirs) <= n // 1000


def test_small_dense_grids_give_the_triangles_with_empty_circles() -> None:
    random = np.random.default_rng(7)
    for _ in range(1500):
        columns, rows = random.integers(1, 5, 2)
        vertices = random_grid(random, columns, rows, random.uniform(0.4, 1.0))[:10]
        assert as_faces(delaunay(vertices)) == twins.canonical_delaunay(as_points(vertices))


def test_the_local_rule_holds_on_thousands_of_dense_grids() -> None:
    random = np.random.default_rng(8)
    for _ in range(2000):
        columns, rows = random.integers(2, 12, 2)
        vertices = random_grid(random, columns, rows, random.uniform(0.3, 1.0))
        points, faces = as_points(vertices), as_faces(delaunay(vertices))
        assert_local_rule(points, faces)
        area = sum(twins.doubled_area(*(points[v] for v in face)) for face in faces)
        assert area == twins.hull_doubled_area(points)


@pytest.mark.parametrize("radius_squared", [5 * 13, 5 * 13 * 17, 5 * 5 * 13 * 17])
def test_points_on_one_circle_are_fanned_from_the_last(radius_squared: int) -> None:
    side = int(radius_squared**0.5) + 1
    y, x = np.mgrid[-side : side + 1, -side : side + 1]
    on_circle = x * x + y * y == radius_squared
    vertices = np.stack([x[on_circle], y[on_circle]], axis=1).astype(np.int32) + side
    faces = as_faces(delaunay(vertices))
    assert len(faces) == len(vertices) - 2
    assert all(len(vertices) - 1 in face for face in faces)


@given(st.data())
def test_any_small_set_of_points_gives_the_triangles_with_empty_circles(
    data: st.DataObject,
) -> None:
    coordinate = st.integers(0, data.draw(st.sampled_from([3, 8, MAX_LATTICE_SIDE])))
    points = data.draw(st.sets(st.tuples(coordinate, coordinate), min_size=1, max_size=9))
    vertices = raster_sorted(np.array(sorted(points), dtype=np.int32))
    assert as_faces(delaunay(vertices)) == twins.canonical_delaunay(as_points(vertices))


def test_a_translation_changes_nothing() -> None:
    random = np.random.default_rng(9)
    for _ in range(200):
        vertices = random_grid(random, 12, 12, 0.6)
        moved = vertices + random.integers(0, 1000, 2, dtype=np.int32)
        assert np.array_equal(delaunay(moved), delaunay(vertices))


def test_a_mirrored_set_without_ties_gives_the_mirrored_triangles() -> None:
    random = np.random.default_rng(10)
    points = np.unique(random.integers(0, MAX_LATTICE_SIDE, (500, 2)), axis=0).astype(np.int32)
    vertices = raster_sorted(points)
    mirrored = raster_sorted(np.abs(points - np.array([MAX_LATTICE_SIDE, 0], dtype=np.int32)))
    there = {frozenset(as_points(vertices[face])) for face in delaunay(vertices)}
    back = {
        frozenset((MAX_LATTICE_SIDE - x, y) for x, y in as_points(mirrored[face]))
        for face in delaunay(mirrored)
    }
    assert there == back


def test_the_order_among_points_of_equal_distance_does_not_matter() -> None:
    random = np.random.default_rng(11)
    for _ in range(100):
        vertices = random_grid(random, 9, 9, 0.7)
        expected = as_faces(delaunay(vertices))
        doubled = 2 * vertices.astype(np.int64)
        centre = doubled.min(axis=0) // 2 + doubled.max(axis=0) // 2
        distances = ((doubled - centre) ** 2).sum(axis=1)
        for _ in range(5):
            order = np.lexsort((random.random(len(vertices)), distances)).astype(np.int64)
            assert swept(vertices, order) == expected


def test_the_centre_of_the_sweep_does_not_matter() -> None:
    random = np.random.default_rng(12)
    for _ in range(300):
        vertices = random_grid(random, 9, 7, 0.7)
        centre = random.integers(-5, 15, 2)
        order = np.argsort(((vertices.astype(np.int64) - centre) ** 2).sum(axis=1))
        assert swept(vertices, order) == as_faces(delaunay(vertices))


@pytest.mark.parametrize(
    "points",
    [
        [],
        [(3, 4)],
        [(0, 0), (5, 9)],
        [(x, 0) for x in range(6)],
        [(0, y) for y in range(6)],
        [(3 * i, 2 * i) for i in range(20)],
        [(MAX_LATTICE_SIDE * i // 2, MAX_LATTICE_SIDE * i // 2) for i in range(3)],
    ],
)
def test_points_on_a_line_give_no_triangles(points: list[twins.Point]) -> None:
    vertices = np.array(points, dtype=np.int32).reshape(-1, 2)
    assert delaunay(vertices).shape == (0, 3)


@pytest.mark.parametrize("apex", [(0, 1), (4, 1), (7, 1), (30, 1), (3, 50)])
def test_a_line_and_one_point_give_a_fan(apex: twins.Point) -> None:
    vertices = np.array([*((x, 0) for x in range(9)), apex], dtype=np.int32)
    expected = [(i, i + 1, 9) for i in range(8)]
    assert as_faces(delaunay(vertices)) == expected


@pytest.mark.parametrize("n", [3, 4, 12])
def test_coincident_points_are_refused(n: int) -> None:
    random = np.random.default_rng(n)
    for _ in range(200):
        points = random.integers(0, 6, (n, 2)).astype(np.int32)
        twice = raster_sorted(np.concatenate([points, points[random.integers(n, size=1)]]))
        if twins.hull_doubled_area(as_points(twice)) == 0:
            continue
        with pytest.raises(ValueError, match="share a position"):
            delaunay(twice)


# The largest, the largest whose squares are short in all cases, one in between, and a small one.
@pytest.mark.parametrize("far", [MAX_LATTICE_SIDE, 23_170, 40_000, 20])
def test_the_in_circle_test_is_exact(far: int) -> None:
    random = np.random.default_rng(13)
    for i in range(20_000):
        points = random.integers(0, far + 1, (4, 2)).tolist()
        if i % 2:  # Nearly on one circle, or exactly: the corners of a square, nudged.
            x, y, side = 0, 0, far
            nudge = random.integers(0, 2, (4, 2))
            square = np.array([(x, y), (side, y), (side, side), (x, side)])
            points = np.abs(square - nudge).tolist()
        a, b, c, d = ((int(px), int(py)) for px, py in points)
        determinant = twins.in_circle_determinant(a, b, c, d)
        assert in_circle(*a, *b, *c, *d) == (determinant > 0) - (determinant < 0)


def test_areas_add_up_for_the_largest_coordinates() -> None:
    random = np.random.default_rng(14)
    far = MAX_LATTICE_SIDE
    corners = np.array([(0, 0), (far, 0), (0, far), (far, far)])
    # Points along the border one unit inside it: triangles of every thinness.
    ring = random.integers(0, far, (400, 2))
    ring[:200, 1] = 1
    ring[200:, 0] = far - 1
    vertices = raster_sorted(np.unique(np.concatenate([corners, ring]), axis=0).astype(np.int32))
    points, faces = as_points(vertices), as_faces(delaunay(vertices))
    assert_local_rule(points, faces)
    assert sum(twins.doubled_area(*(points[v] for v in face)) for face in faces) == 2 * far * far


def as_edges(keys: Int64Array) -> list[tuple[int, int]]:
    """Pairs of vertices, the lower one first."""
    return [(int(key) >> 32, int(key) & 0xFFFFFFFF) for key in keys]


def edges_of(triangles: Int32Array) -> set[tuple[int, int]]:
    """Edges as pairs of vertices, the lower one first."""
    return {(min(edge), max(edge)) for edge in twins.directed_edges(triangles)}


def flipped_back(
    vertices: Int32Array, triangles: Int32Array, capacity: int
) -> tuple[int, Int32Array, Int64Array, Int64Array]:
    """Number of flips to Delaunay, the triangles then, and the edges that came and went."""
    origin = triangles.ravel().astype(np.int64)
    created, removed = np.zeros((2, capacity), dtype=np.int64)
    twin = find_twins(triangles, len(vertices))
    count = flip_to_delaunay(vertices.astype(np.int64), origin, twin, created, removed)
    return count, origin.reshape(-1, 3).astype(np.int32), created[:count], removed[:count]


@given(point_sets(), st.integers(0, 200), st.integers(0, 2**32 - 1))
def test_flips_lead_from_any_triangulation_to_delaunay(
    drawn: tuple[int, int, Int32Array], n_flips: int, seed: int
) -> None:
    _, _, vertices = drawn
    delaunay_triangles = delaunay(vertices)
    triangles = flipped(vertices, delaunay_triangles, n_flips, np.random.default_rng(seed))
    capacity = len(vertices) ** 2
    count, result, created, removed = flipped_back(vertices, triangles, capacity)
    assert count >= 0
    assert np.array_equal(sorted_triangles(result), delaunay_triangles)
    # No edge goes twice, none comes back, and the difference is that of the two triangulations.
    came, went = as_edges(created), as_edges(removed)
    assert len(set(went)) == len(set(came)) == count
    assert edges_of(triangles) - edges_of(delaunay_triangles) == set(went) - set(came)
    assert edges_of(delaunay_triangles) - edges_of(triangles) == set(came) - set(went)
    for i, edge in enumerate(went):
        assert edge not in came[i:]


def test_a_delaunay_triangulation_takes_no_flips() -> None:
    vertices = random_grid(np.random.default_rng(17), 30, 30, 0.5)
    triangles = delaunay(vertices)
    count, result, _, _ = flipped_back(vertices, triangles, 0)
    assert count == 0
    assert np.array_equal(result, triangles)


def test_more_flips_than_can_be_held_are_told() -> None:
    random = np.random.default_rng(18)
    vertices = random_grid(random, 9, 9, 0.6)
    triangles = flipped(vertices, delaunay(vertices), 60, random)
    count, _, _, _ = flipped_back(vertices, triangles, 1000)
    assert flipped_back(vertices, triangles, count)[0] == count
    assert count > 1
    for capacity in (0, 1, count - 1):
        assert flipped_back(vertices, triangles, capacity)[0] == TOO_MANY_FLIPS


def test_triangles_are_sorted_as_the_mesh_sorts_them() -> None:
    random = np.random.default_rng(15)
    triangles = delaunay(random_grid(random, 20, 20, 0.5))
    shuffled = random.permutation(triangles)
    for t, turn in enumerate(random.integers(0, 3, len(shuffled))):
        shuffled[t] = np.roll(shuffled[t], turn)
    assert np.array_equal(sorted_triangles(shuffled), triangles)
    assert np.array_equal(sort_triangles(shuffled.copy(), int(triangles.max()) + 1), triangles)
