"""Shares of a mesh that several threads work on at the same time."""

from __future__ import annotations

import threading

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.strategies import meshes
from vmesh.arrays import UInt8Array
from vmesh.encoder.independent_sets import independent_sets
from vmesh.encoder.pipeline import encode
from vmesh.encoder.threads import shares, workers
from vmesh.kernels.delaunay import delaunay
from vmesh.mesh import Mesh


@given(meshes(), st.sampled_from([2, 8, 128]))
def test_no_edge_joins_two_groups_of_a_set(mesh: Mesh, band: int) -> None:
    points, triangles = mesh.vertices.astype(np.int64), mesh.triangles.astype(np.int64)
    found = independent_sets(points, triangles, band)
    vertices = [v for groups in found for group in groups for v in group.tolist()]
    assert sorted(vertices) == list(range(mesh.n_vertices))
    for groups in found:
        owner = {v: i for i, group in enumerate(groups) for v in group.tolist()}
        for face in mesh.triangles.tolist():
            assert len({owner[v] for v in face if v in owner}) <= 1


def test_a_tall_mesh_has_work_for_many_threads() -> None:
    random = np.random.default_rng(0)
    points = np.unique(random.integers(0, [200, 2000], (4000, 2)), axis=0).astype(np.int32)
    first, second, rest = independent_sets(
        points.astype(np.int64), delaunay(points).astype(np.int64), band=128
    )
    assert len(first) == len(second) + 1 == -(-2000 // 128)
    assert sum(map(len, first)) > 0.6 * len(points)
    assert sum(map(len, rest)) < 0.02 * len(points)


@pytest.mark.parametrize("n_items", [0, 1, 4096, 4097, 20_000])
def test_shares_hold_every_item_once_in_order(n_items: int) -> None:
    items = [i for first, last in shares(n_items) for i in range(first, last)]
    assert items == list(range(n_items))


@pytest.mark.parametrize("n_threads", [1, 3])
def test_results_come_in_the_order_of_the_arguments(n_threads: int) -> None:
    gate = threading.Event()

    def work(i: int) -> int:
        # The first job ends last, if there is more than one thread.
        if i == 0 and n_threads > 1:
            assert gate.wait(60)
        gate.set() if i else None
        return i * i

    with workers(n_threads) as run:
        assert list(run(work, range(5))) == [0, 1, 4, 9, 16]


def test_an_error_in_a_job_reaches_the_caller() -> None:
    with workers(2) as run, pytest.raises(ZeroDivisionError):
        list(run(lambda i: 1 // i, [1, 0]))


def test_a_mesh_does_not_depend_on_the_number_of_threads(chelsea: UInt8Array) -> None:
    image = np.ascontiguousarray(chelsea[:260, :120])
    first, *others = (
        encode(image, vertices=1500, effort=3, threads=n_threads) for n_threads in (1, 2, 5, None)
    )
    for other in others:
        assert np.array_equal(first.vertices, other.vertices)
        assert np.array_equal(first.triangles, other.triangles)
        assert np.array_equal(first.levels, other.levels)
