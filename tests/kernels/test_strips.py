"""Strips against a slow reader of flags, as the standard words it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given

import vmesh
from tests.strategies import meshes
from vmesh.arrays import Int32Array, UInt8Array
from vmesh.encoder.settings import Method
from vmesh.kernels.half_edges import find_twins
from vmesh.kernels.strips import find_strips
from vmesh.mesh import Mesh


def read_strips(flags: UInt8Array, vertices: Int32Array) -> list[frozenset[int]]:
    """Corners of the triangles that a reader of PDF makes of flags and vertices."""
    found: list[tuple[int, int, int]] = []
    records = list(zip(flags.tolist(), vertices.tolist(), strict=True))
    while records:
        flag, vertex = records.pop(0)
        if flag == 0:
            found.append((vertex, records.pop(0)[1], records.pop(0)[1]))
        else:
            a, b, c = found[-1]
            found.append((b, c, vertex) if flag == 1 else (a, c, vertex))
    return [frozenset(triangle) for triangle in found]


def strips_of(mesh: Mesh) -> tuple[UInt8Array, Int32Array]:
    return find_strips(mesh.triangles.copy(), find_twins(mesh.triangles.copy(), mesh.n_vertices))


@given(meshes())
def test_strips_draw_every_triangle_once(mesh: Mesh) -> None:
    drawn = read_strips(*strips_of(mesh))
    assert len(drawn) == mesh.n_triangles
    assert set(drawn) == {frozenset(triangle) for triangle in mesh.triangles.tolist()}


@pytest.mark.parametrize("method", ["adaptive", "blue-noise"])
def test_photographs_take_few_vertices_for_a_triangle(coffee: np.ndarray, method: Method) -> None:
    mesh = vmesh.encode(coffee[:200, :300], method=method, vertices=2000)
    flags, _ = strips_of(mesh)
    assert len(flags) / mesh.n_triangles <= 1.10


def test_triangles_that_touch_nothing_are_drawn_one_by_one() -> None:
    triangles = np.arange(9, dtype=np.int32).reshape(3, 3)
    flags, vertices = find_strips(triangles, find_twins(triangles, 9))
    assert flags.tolist() == [0] * 9
    assert vertices.tolist() == list(range(9))
