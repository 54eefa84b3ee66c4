from __future__ import annotations

from dataclasses import FrozenInstanceError
from typing import Any

import numpy as np
import pytest
from hypothesis import given

from tests.mesh.squares import FAN, square
from tests.strategies import meshes
from vmesh.color_lattice import ColorLattice
from vmesh.mesh import Mesh, Metadata


def test_a_mesh_cannot_be_changed() -> None:
    mesh = square()
    with pytest.raises(FrozenInstanceError):
        mesh.width = 5  # type: ignore[misc]
    for array in (mesh.vertices, mesh.triangles, mesh.levels):
        with pytest.raises(ValueError, match="read-only"):
            array[0, 0] = 1


def test_a_mesh_keeps_copies_of_what_it_is_given() -> None:
    vertices = square().vertices.copy()
    mesh = square(vertices=vertices)
    vertices[4] = (1, 1)
    assert mesh.vertices[4].tolist() == [2, 2]


def test_a_mesh_is_not_hashable() -> None:
    with pytest.raises(TypeError, match="unhashable"):
        hash(square())


@pytest.mark.parametrize(
    "changes",
    [
        {"width": 5},
        {"subdivision": 1},
        {"levels": [[0], [10], [20], [30], [41]]},
        {"triangles": FAN[::-1]},
        {"vertices": [[0, 0], [4, 0], [0, 4], [4, 4], [2, 3]]},
        {"lattice": ColorLattice((2,))},
        {"metadata": Metadata(icc=b"profile")},
    ],
)
def test_meshes_that_differ_in_a_field_are_not_equal(changes: dict[str, Any]) -> None:
    assert square() == square()
    assert square(**changes) != square()


def test_a_mesh_equals_nothing_else() -> None:
    assert square() != "mesh"


def test_the_text_of_a_mesh_names_its_size() -> None:
    assert repr(square()) == "Mesh(4 x 4 px, 5 vertices, 4 triangles, 1 colour components)"


def test_points_are_in_pixels() -> None:
    assert square(subdivision=2).points[3].tolist() == [1.0, 1.0]


def test_from_colors_rounds_colors_to_the_lattice() -> None:
    colors = np.array([[0, 0, 0], [255, 255, 255], [255, 0, 0], [0, 255, 0], [0, 0, 255]])
    fine = Mesh.from_colors(4, 4, square().vertices, FAN, colors)
    assert fine.colors.tolist() == colors.tolist()
    fine.check()


@given(meshes())
def test_canonical_undoes_any_shuffle_of_vertices_and_triangles(mesh: Mesh) -> None:
    random = np.random.default_rng(mesh.n_vertices)
    order = random.permutation(mesh.n_vertices)
    place = np.argsort(order)
    triangles = random.permutation(place[mesh.triangles])
    for t, turn in enumerate(random.integers(0, 3, len(triangles))):
        triangles[t] = np.roll(triangles[t], turn)
    shuffled = mesh.replaced(
        vertices=mesh.vertices[order], levels=mesh.levels[order], triangles=triangles
    )
    assert shuffled.canonical() == mesh
    assert mesh.canonical() == mesh


def test_canonical_vertices_come_in_raster_order() -> None:
    canonical = square().canonical()
    assert canonical.vertices.tolist() == [[0, 0], [4, 0], [2, 2], [0, 4], [4, 4]]
    assert canonical.triangles.tolist() == [[0, 1, 2], [0, 2, 3], [1, 4, 2], [2, 4, 3]]
