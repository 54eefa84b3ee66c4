"""The order in which colours are coded, against one built of plain sets."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given

from tests import twins
from tests.strategies import meshes
from tests.surfaces import scattered
from vmesh.arrays import Int32Array
from vmesh.codec.hierarchy import MAX_TRIANGLES, Hierarchy, build_hierarchy
from vmesh.encoder.image import weighted
from vmesh.encoder.proposals import propose
from vmesh.encoder.settings import Settings
from vmesh.kernels.delaunay import delaunay
from vmesh.mesh import Mesh


def hierarchy_of(vertices: Int32Array) -> Hierarchy:
    return build_hierarchy(vertices, delaunay(vertices))


def parents_of(hierarchy: Hierarchy) -> list[list[int]]:
    """Parents of each place in the order."""
    ends = hierarchy.starts
    return [hierarchy.parents[a:b].tolist() for a, b in pairwise(ends)]


def check_hierarchy(hierarchy: Hierarchy, vertices: Int32Array) -> None:
    """Check what a reader relies on."""
    n = len(vertices)
    assert sorted(hierarchy.order.tolist()) == list(range(n))
    assert len(hierarchy.starts) == n + 1
    assert hierarchy.starts[0] == 0
    assert hierarchy.starts[-1] == len(hierarchy.parents)
    seen: set[int] = set()
    for v, parents in zip(hierarchy.order.tolist(), parents_of(hierarchy), strict=True):
        assert len(set(parents)) == len(parents)
        assert set(parents) <= seen
        assert bool(parents) == bool(seen)
        seen.add(v)


def test_a_rectangle_chains_its_corners() -> None:
    hierarchy = hierarchy_of(np.array([[0, 0], [5, 0], [0, 3], [5, 3]], dtype=np.int32))
    assert hierarchy.order.tolist() == [0, 1, 2, 3]
    assert parents_of(hierarchy) == [[], [0], [1], [2]]


def test_a_vertex_in_the_middle_lies_between_the_corners() -> None:
    vertices = np.array([[0, 0], [6, 0], [3, 2], [0, 4], [6, 4]], dtype=np.int32)
    hierarchy = hierarchy_of(vertices)
    assert hierarchy.order.tolist() == [0, 1, 3, 4, 2]
    assert sorted(parents_of(hierarchy)[-1]) == [0, 1, 3, 4]


@given(meshes())
def test_every_vertex_comes_once_and_after_its_parents(mesh: Mesh) -> None:
    vertices = mesh.canonical().vertices
    check_hierarchy(hierarchy_of(vertices), vertices)


def grid(columns: int, rows: int) -> Int32Array:
    """All sites of a lattice: every circle holds four of them."""
    y, x = np.mgrid[:rows, :columns]
    return np.stack([x.ravel(), y.ravel()], axis=1).astype(np.int32)


def crowded(columns: int, rows: int, n: int) -> Int32Array:
    """Some sites of a lattice and its corners: many circles hold four of them."""
    sites = grid(columns, rows)
    is_taken = np.random.default_rng(n).permutation(len(sites)) < n
    is_corner = ((sites == 0) | (sites == sites[-1])).all(axis=1)
    chosen: Int32Array = sites[is_taken | is_corner]
    return chosen


TAKEN_APART = {
    **{f"{3 * seed} scattered": scattered(20, 17, 3 * seed, seed) for seed in range(6)},
    "crowded": crowded(9, 8, 40),
    "grid": grid(6, 5),
    "two rows": grid(16, 2),
    "one column of pixels": grid(2, 15),
}


@pytest.mark.parametrize("name", TAKEN_APART)
def test_the_order_is_that_of_independent_sets_taken_again_and_again(name: str) -> None:
    vertices = TAKEN_APART[name]
    points = [(x, y) for x, y in vertices.tolist()]
    expected = twins.hierarchy(points, MAX_TRIANGLES)
    hierarchy = hierarchy_of(vertices)
    assert hierarchy.order.tolist() == [v for v, _ in expected]
    assert [set(parents) for parents in parents_of(hierarchy)] == [around for _, around in expected]


def test_a_vertex_with_many_neighbours_waits_until_there_are_fewer() -> None:
    # A hub that sees twelve others around it, and the corners far out.
    angles = np.arange(12) * np.pi / 6
    rim = np.rint(500 + 100 * np.stack([np.cos(angles), np.sin(angles)], axis=1))
    sites = [*rim.tolist(), [500, 500], [0, 0], [1000, 0], [0, 1000], [1000, 1000]]
    points = sorted(((int(x), int(y)) for x, y in sites), key=lambda p: (p[1], p[0]))
    vertices = np.array(points, dtype=np.int32)
    hub = points.index((500, 500))
    degree = int(np.count_nonzero(delaunay(vertices) == hub))
    assert degree > MAX_TRIANGLES
    hierarchy = hierarchy_of(vertices)
    check_hierarchy(hierarchy, vertices)
    assert int(np.flatnonzero(hierarchy.order == hub)[0]) < len(vertices) - 3


@pytest.fixture(scope="module")
def sampled(chelsea: np.ndarray) -> Int32Array:
    """Vertices on a part of a photograph of 150 x 100 pixels."""
    part = np.ascontiguousarray(chelsea[:100, :150])
    return propose(weighted(part), Settings(vertices=900))[1].vertices()


def test_the_corners_of_the_canvas_come_before_all_others(sampled: Int32Array) -> None:
    first = sampled[hierarchy_of(sampled).order[:4]]
    assert sorted(first.tolist()) == [[0, 0], [0, 200], [300, 0], [300, 200]]


def test_the_order_is_from_coarse_to_fine(sampled: Int32Array) -> None:
    hierarchy = hierarchy_of(sampled)
    check_hierarchy(hierarchy, sampled)
    n = len(sampled)
    # A vertex has several parents, and of the last ones none has children.
    assert np.diff(hierarchy.starts)[4:].mean() > 4
    children = np.bincount(hierarchy.parents, minlength=n)[hierarchy.order]
    n_childless = int((children[::-1] > 0).argmax())
    assert n_childless > n / 5


@given(meshes())
def test_the_same_positions_give_the_same_order(mesh: Mesh) -> None:
    vertices = mesh.canonical().vertices
    first, again = (hierarchy_of(vertices.copy()) for _ in range(2))
    assert np.array_equal(first.order, again.order)
    assert np.array_equal(first.starts, again.starts)
    assert np.array_equal(first.parents, again.parents)


def test_vertices_without_the_corners_around_them_are_refused() -> None:
    vertices = np.array([(0, 0), (4, 0), (2, 3), (0, 4)], dtype=np.int32)
    with pytest.raises(ValueError, match="corners of the bounding box"):
        build_hierarchy(vertices, delaunay(vertices))
