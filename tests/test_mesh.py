from __future__ import annotations

from dataclasses import FrozenInstanceError
from typing import Any

import numpy as np
import pytest
from hypothesis import given

from tests.pictures import drawn, noise
from tests.strategies import meshes
from vmesh.color_lattice import ColorLattice
from vmesh.encoder.pipeline import encode
from vmesh.kernels.delaunay import delaunay
from vmesh.limits import MAX_LATTICE_SIDE, MAX_SIDE
from vmesh.mesh import Mesh, Metadata

FAN = [[0, 1, 4], [1, 3, 4], [3, 2, 4], [2, 0, 4]]


def square(**changes: Any) -> Mesh:
    """A canvas of 4 x 4 pixels: four corners, the centre, and four triangles around it."""
    vertices = [[0, 0], [4, 0], [0, 4], [4, 4], [2, 2]]
    levels = [[0], [10], [20], [30], [40]]
    mesh = Mesh(4, 4, np.array(vertices), np.array(FAN), np.array(levels), ColorLattice((1,)))
    return mesh.replaced(
        **{name: np.array(v) if type(v) is list else v for name, v in changes.items()}
    )


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


# --- transform ---------------------------------------------------------------------------------

TILT = (1.0, 0.2, 0.3, 1.0, 0.0, 0.0)
TURN_30 = (0.8660254, 0.5, -0.5, 0.8660254, 7.0, -3.0)


@pytest.mark.parametrize(
    ("matrix", "size"),
    [
        ((1, 0, 0, 1, 0, 0), (24, 16)),
        ((1, 0, 0, 1, 100.25, -7), (24, 16)),
        ((2, 0, 0, 2, 0, 0), (48, 32)),
        ((0.5, 0, 0, 0.5, 0, 0), (12, 8)),
        ((1.37, 0, 0, 0.83, 0, 0), (33, 13)),
        ((-1, 0, 0, 1, 0, 0), (24, 16)),
        ((1, 0, 0, -1, 0, 0), (24, 16)),
        ((-1, 0, 0, -1, 3, 4), (24, 16)),
        ((0, 1, -1, 0, 0, 0), (16, 24)),
        ((0, -2, 2, 0, 0, 0), (32, 48)),
        ((0, 1, 1, 0, 0, 0), (16, 24)),
        ((6.1e-17, 1, -1, 6.1e-17, 0, 0), (16, 24)),
        ((1e-3, 0, 0, 1, 0, 0), (1, 16)),
    ],
)
def test_scalings_flips_and_quarter_turns_cover_their_canvas(
    matrix: tuple[float, ...], size: tuple[int, int]
) -> None:
    mesh = encode(noise(16, 24), vertices=40)
    moved = mesh.transform(matrix)
    assert (moved.width, moved.height) == size
    assert moved.covers_canvas
    moved.check()


@pytest.mark.parametrize("matrix", [TILT, TURN_30, (1, 0, 0.5, 1, 0, 0), (-1, 0.3, 0.2, 1, 0, 0)])
def test_other_maps_leave_corners_uncovered(matrix: tuple[float, ...]) -> None:
    moved = encode(noise(16, 24), vertices=40).transform(matrix)
    assert not moved.covers_canvas
    assert (moved.doubled_areas() > 0).all()
    assert (moved.points >= 0).all()
    assert (moved.points <= [moved.width, moved.height]).all()
    with pytest.raises(ValueError, match="cover"):
        moved.check()


@pytest.mark.parametrize("matrix", [(2, 0, 0, 3, 0, 0), (0, 1, -1, 0, 0, 0), TILT, TURN_30])
def test_a_map_moves_every_vertex_as_its_matrix_says(matrix: tuple[float, ...]) -> None:
    mesh = encode(noise(16, 24), vertices=40)
    moved = mesh.transform(matrix)
    a, b, c, d, _, _ = matrix
    x, y = mesh.points.T
    expected = np.stack([a * x + c * y, b * x + d * y], axis=1)
    expected -= expected.min(axis=0)
    assert np.abs(moved.points - expected).max() < 0.01


@pytest.mark.parametrize(
    "matrix", [(2, 0, 0, 2, 0, 0), (0, 1, -1, 0, 0, 0), (-1, 0, 0, 1, 0, 0), TILT, TURN_30]
)
def test_the_topology_and_the_colors_stay(matrix: tuple[float, ...]) -> None:
    mesh = encode(noise(16, 24), vertices=40, metadata=Metadata(icc=b"profile"))
    moved = mesh.transform(matrix)
    assert {frozenset(face) for face in moved.triangles.tolist()} == {
        frozenset(face) for face in mesh.triangles.tolist()
    }
    assert np.array_equal(moved.levels, mesh.levels)
    assert (moved.lattice, moved.metadata) == (mesh.lattice, mesh.metadata)


def test_flips_and_quarter_turns_draw_flipped_and_turned_pictures() -> None:
    mesh = encode(noise(16, 24), vertices=60)
    picture = drawn(mesh).astype(int)
    for matrix, expected in (
        ((-1, 0, 0, 1, 0, 0), picture[:, ::-1]),
        ((1, 0, 0, -1, 0, 0), picture[::-1]),
        ((0, 1, -1, 0, 0, 0), np.rot90(picture, -1)),
        ((0, -1, 1, 0, 0, 0), np.rot90(picture)),
        ((0, 1, 1, 0, 0, 0), picture.transpose(1, 0, 2)),
    ):
        result = drawn(mesh.transform(matrix)).astype(int)
        # Centres exactly on an edge change sides: the colours meet there.
        assert np.abs(result - expected).max() <= 1


def test_two_quarter_turns_and_two_flips_come_back_to_the_same_positions() -> None:
    mesh = encode(noise(16, 24), vertices=40)
    turned = mesh
    for _ in range(4):
        turned = turned.transform((0, 1, -1, 0, 0, 0))
    assert np.array_equal(turned.points, mesh.points)
    twice = mesh.transform((-1, 0, 0, 1, 0, 0)).transform((-1, 0, 0, 1, 0, 0))
    assert np.array_equal(twice.points, mesh.points)


@pytest.mark.parametrize(
    ("matrix", "complaint"),
    [
        ((0, 0, 0, 0, 0, 0), "singular"),
        ((1, 2, 2, 4, 0, 0), "singular"),
        ((1, 0, 0, 0, 5, 5), "singular"),
        ((1, 0, 0, 1, 0), "six finite numbers"),
        ((1, 0, 0, float("nan"), 0, 0), "six finite numbers"),
        ((1, 0, 0, 1, float("inf"), 0), "six finite numbers"),
        ((1e5, 0, 0, 1, 0, 0), "wider or higher"),
        ((1e-7, 0, 0, 1e-7, 0, 0), "singular"),
        ((1, 1, 1, 1 + 1e-9, 0, 0), "too small"),
    ],
)
def test_maps_that_no_mesh_survives_are_refused(matrix: tuple[float, ...], complaint: str) -> None:
    mesh = encode(noise(16, 24), vertices=40)
    with pytest.raises(ValueError, match=complaint):
        mesh.transform(matrix)


def test_a_canvas_shrinks_to_one_pixel_at_the_least() -> None:
    moved = encode(noise(16, 24), vertices=40).transform((1e-5, 0, 0, 1e-5, 0, 0))
    assert (moved.width, moved.height) == (1, 1)
    moved.check()


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
