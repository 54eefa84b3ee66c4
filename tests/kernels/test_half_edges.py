"""Twins of half-edges against plain dictionaries."""

from __future__ import annotations

import numpy as np
from hypothesis import given

from tests import twins
from tests.strategies import meshes
from vmesh.kernels.half_edges import find_twins
from vmesh.mesh import Mesh


@given(meshes())
def test_the_twin_of_a_half_edge_is_the_reversed_edge_or_none(mesh: Mesh) -> None:
    found = find_twins(mesh.triangles.copy(), mesh.n_vertices)
    edges = twins.directed_edges(mesh.triangles)
    assert found.tolist() == [edges.get((v, u), -1) for u, v in edges]


def test_a_vertex_without_triangles_has_no_half_edges() -> None:
    triangles = np.array([[0, 2, 4], [4, 2, 5]], dtype=np.int32)
    assert find_twins(triangles, 9).tolist() == [-1, 3, -1, 1, -1, -1]
