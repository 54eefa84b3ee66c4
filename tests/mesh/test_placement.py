from __future__ import annotations

import numpy as np
import pytest

from tests.pictures import drawn, noise
from vmesh.encoder.pipeline import encode
from vmesh.mesh import Metadata

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
