"""Half-edges against plain dictionaries."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from tests import twins
from tests.strategies import meshes
from vmesh.kernels.half_edges import find_twins, walk_outlines
from vmesh.mesh import Mesh


@given(meshes())
def test_the_twin_of_a_half_edge_is_the_reversed_edge_or_none(mesh: Mesh) -> None:
    found = find_twins(mesh.triangles.copy(), mesh.n_vertices)
    edges = twins.directed_edges(mesh.triangles)
    assert found.tolist() == [edges.get((v, u), -1) for u, v in edges]


def test_a_vertex_without_triangles_has_no_half_edges() -> None:
    triangles = np.array([[0, 2, 4], [4, 2, 5]], dtype=np.int32)
    assert find_twins(triangles, 9).tolist() == [-1, 3, -1, 1, -1, -1]


@given(meshes(), st.data())
def test_outlines_are_closed_walks_along_all_that_bounds_a_region(
    mesh: Mesh, data: st.DataObject
) -> None:
    regions = data.draw(st.lists(st.integers(0, 2), min_size=1, max_size=5))
    own = np.repeat(np.resize(regions, mesh.n_triangles), 3)
    edges = twins.directed_edges(mesh.triangles)
    across = [edges.get((v, u), -1) for u, v in edges]
    inner = np.array([e >= 0 and own[e] == region for e, region in zip(across, own, strict=True)])
    outer = np.flatnonzero(~inner)
    ordered, loops = walk_outlines(outer, np.array(across, dtype=np.int64), inner)
    assert sorted(ordered) == outer.tolist()
    ends = list(edges)
    for loop in np.split(ordered, loops[1:]):
        assert len(set(own[loop])) == 1
        corners = [ends[e] for e in loop]
        assert [end for _, end in corners] == [start for start, _ in corners[1:] + corners[:1]]
