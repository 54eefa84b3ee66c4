from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given

from tests.mesh.squares import FAN, square
from tests.strategies import meshes
from vmesh.color_lattice import ColorLattice
from vmesh.kernels.delaunay import delaunay
from vmesh.limits import MAX_LATTICE_SIDE, MAX_SIDE
from vmesh.mesh import Mesh


def test_a_whole_mesh_passes_its_check() -> None:
    square().check()


@given(meshes())
def test_generated_meshes_pass_their_check(mesh: Mesh) -> None:
    mesh.check()
    assert mesh.covers_canvas


@pytest.mark.parametrize(
    ("changes", "complaint"),
    [
        ({"width": 0}, "canvas of 1 to"),
        ({"height": 0}, "canvas of 1 to"),
        ({"width": -4}, "canvas of 1 to"),
        ({"height": MAX_SIDE + 1}, "canvas of 1 to"),
        ({"subdivision": -1}, "subdivision of 0 to 8"),
        ({"subdivision": 9}, "subdivision of 0 to 8"),
        ({"width": 40_000, "subdivision": 4}, f"at most {MAX_LATTICE_SIDE} lattice units"),
        ({"levels": [[0]] * 4}, "levels of shape"),
        ({"levels": [[0, 0]] * 5}, "levels of shape"),
        ({"vertices": [[0, 0, 0]] * 5}, "vertices of shape"),
        ({"triangles": [[0, 1]]}, "triangles of shape"),
        ({"vertices": [[0, 0], [4, 0], [0, 4], [4, 4], [5, 2]]}, "outside the canvas"),
        ({"vertices": [[0, 0], [4, 0], [0, 4], [4, 4], [2, -1]]}, "outside the canvas"),
        ({"vertices": [[0, 0], [4, 0], [0, 4], [4, 4], [4, 4]]}, "share a position"),
        ({"triangles": [*FAN[:3], [2, 0, 5]]}, "does not exist"),
        ({"triangles": [*FAN[:3], [2, 0, -1]]}, "does not exist"),
        ({"levels": [[0], [10], [20], [30], [256]]}, "outside its component's range"),
        ({"levels": [[0], [10], [20], [30], [-1]]}, "outside its component's range"),
        ({"triangles": [*FAN[:3], [0, 2, 4]]}, "turned the wrong way"),
        ({"triangles": [*FAN, [0, 3, 4]]}, "no area"),
        ({"triangles": FAN[:3]}, "do not cover the canvas"),
        ({"triangles": np.empty((0, 3), dtype=np.int32)}, "do not cover the canvas"),
        ({"width": 5}, "do not cover the canvas"),
        ({"triangles": [*FAN, FAN[0]]}, "do not cover the canvas"),
        # An overlap that makes up for a gap.
        ({"triangles": [FAN[0], FAN[0], FAN[1], FAN[2]]}, "same side of an edge"),
        ({"triangles": [[0, 1, 3], [0, 1, 2]]}, "same side of an edge"),
    ],
)
def test_a_mesh_that_breaks_a_rule_is_refused(changes: dict[str, Any], complaint: str) -> None:
    with pytest.raises(ValueError, match=complaint):
        square(**changes).check()


def test_a_hanging_vertex_is_refused() -> None:
    # Vertex 4 lies on the diagonal; one side has the whole edge 0-3, the other its two halves.
    hanging = [[0, 1, 3], [0, 4, 2], [4, 3, 2]]
    with pytest.raises(ValueError, match="inner edge belongs to only one triangle"):
        square(triangles=hanging).check()


def test_a_hanging_vertex_on_the_border_is_refused() -> None:
    vertices = [[0, 0], [4, 0], [0, 4], [4, 4], [2, 0]]
    # The upper edge 0-1 runs past vertex 4; the areas add up through an overlap elsewhere.
    triangles = [[0, 1, 3], [0, 4, 2], [4, 1, 2]]
    with pytest.raises(ValueError, match=r"inner edge|same side"):
        square(vertices=vertices, triangles=triangles).check()


@pytest.mark.parametrize(
    ("name", "array"),
    [
        ("vertices", np.zeros((5, 2))),
        ("vertices", np.zeros(10, dtype=np.int32)),
        ("triangles", np.zeros((4, 3), dtype=bool)),
        ("levels", np.zeros((5, 1, 1), dtype=np.int32)),
        ("vertices", np.full((5, 2), 2**31)),
        ("levels", np.full((5, 1), -(2**31) - 1)),
    ],
)
def test_arrays_that_are_not_tables_of_32_bit_integers_are_refused(
    name: str, array: np.typing.NDArray[Any]
) -> None:
    with pytest.raises(ValueError, match=name):
        square(**{name: array})


def test_a_mesh_of_delaunay_triangles_covers_its_canvas_at_the_largest_size() -> None:
    side = MAX_LATTICE_SIDE >> 3
    vertices = np.array([[0, 0], [side - 1, 0], [17, 5], [0, side - 1], [side - 1, side - 1]])
    mesh = Mesh(
        side - 1,
        side - 1,
        vertices,
        delaunay(vertices.astype(np.int32)),
        np.zeros((5, 3), dtype=np.int32),
        ColorLattice((1, 1, 1)),
    )
    mesh.check()
    mesh.replaced(vertices=vertices * 8, subdivision=3).check()


@pytest.mark.parametrize(
    "changes",
    [
        {"triangles": np.array([[0, 1, 10**9], [0, 10**9, 2]])},
        {"triangles": np.array([[0, 1, -(10**9)], [0, 3, 2]])},
        {"levels": np.zeros((1, 1), dtype=int)},
        {"vertices": np.zeros((4, 1), dtype=int)},
        {"width": 0},
        {"vertices": np.full((4, 2), 2**31 - 1)},
    ],
)
def test_what_drawing_relies_on_is_checked_when_a_mesh_is_made(changes: dict[str, Any]) -> None:
    vertices = np.array([[0, 0], [8, 0], [0, 8], [8, 8]])
    mesh = Mesh.from_colors(8, 8, vertices, [[0, 1, 3], [0, 3, 2]], np.zeros((4, 1), dtype=int))
    with pytest.raises(ValueError, match=r"expected|outside|does not exist"):
        mesh.replaced(**changes)
