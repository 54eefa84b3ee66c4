"""Twins of half-edges and independent sets against plain dictionaries and sets."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests import twins
from tests.strategies import meshes
from tests.surfaces import scattered
from vmesh.kernels.delaunay import delaunay
from vmesh.kernels.half_edges import find_twins, independent_set
from vmesh.mesh import Mesh


@given(meshes())
def test_the_twin_of_a_half_edge_is_the_reversed_edge_or_none(mesh: Mesh) -> None:
    found = find_twins(mesh.triangles.copy(), mesh.n_vertices)
    edges = twins.directed_edges(mesh.triangles)
    assert found.tolist() == [edges.get((v, u), -1) for u, v in edges]


def test_a_vertex_without_triangles_has_no_half_edges() -> None:
    triangles = np.array([[0, 2, 4], [4, 2, 5]], dtype=np.int32)
    assert find_twins(triangles, 9).tolist() == [-1, 3, -1, 1, -1, -1]


@given(meshes(), st.integers(2, 9), st.integers(0, 2**32 - 1))
def test_independent_sets_are_those_of_sets_taken_in_order(
    mesh: Mesh, max_triangles: int, seed: int
) -> None:
    kept = np.random.default_rng(seed).random(mesh.n_vertices) < 0.3
    taken, starts, neighbours = independent_set(mesh.triangles.copy(), kept, max_triangles)
    found = {int(v): neighbours[starts[i] : starts[i + 1]].tolist() for i, v in enumerate(taken)}
    expected = twins.independent_set(mesh.triangles.tolist(), kept.tolist(), max_triangles)
    assert list(found) == list(expected)
    assert {v: set(around) for v, around in found.items()} == expected
    assert all(len(around) == len(set(around)) for around in found.values())
    assert starts[-1] == len(neighbours)


@pytest.mark.parametrize("n", [0, 1, 20, 300])
def test_no_two_taken_vertices_are_neighbours_and_none_could_be_added(n: int) -> None:
    vertices = scattered(60, 50, n, 4) if n < 100 else _grid(17)
    triangles = delaunay(vertices)
    kept = np.zeros(len(vertices), dtype=bool)
    taken, starts, neighbours = independent_set(triangles, kept, 8)
    assert not set(taken.tolist()) & set(neighbours.tolist())
    counts = np.bincount(triangles.ravel())
    others = set(range(len(vertices))) - set(taken.tolist()) - set(neighbours.tolist())
    assert all(counts[v] > 8 for v in others)
    assert (np.diff(starts) >= 2).all()


def _grid(side: int) -> np.ndarray:
    y, x = np.mgrid[:side, :side]
    return np.stack([x.ravel(), y.ravel()], axis=1).astype(np.int32)
