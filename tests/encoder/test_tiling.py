"""Meshes in tiles: sound, joined without gaps, and as good as those of the whole picture."""

from __future__ import annotations

import threading
from typing import Any

import numpy as np
import pytest

from tests.pictures import constant, disc, drawn, noise, psnr, ramp
from vmesh.arrays import Int32Array, UInt8Array
from vmesh.codec.hierarchy import build_hierarchy
from vmesh.codec.writer import dumps
from vmesh.encoder.image import as_image
from vmesh.encoder.pipeline import STAGES, count_steps, encode
from vmesh.encoder.rate_control import measure_psnr
from vmesh.encoder.settings import Settings
from vmesh.encoder.tiles.code_order import code_order
from vmesh.encoder.tiles.joining import join
from vmesh.encoder.tiles.tiled_draft import apportion
from vmesh.grid import Grid
from vmesh.kernels.delaunay import delaunay
from vmesh.mesh import Mesh


@pytest.fixture(scope="module")
def cup(coffee: UInt8Array) -> UInt8Array:
    """A part of a photograph, 96 x 128 pixels: smooth, with sharp edges."""
    return np.ascontiguousarray(coffee[110:206, 170:298])


def check(mesh: Mesh, picture: UInt8Array, tile: int) -> None:
    mesh.check()
    assert mesh.tile == tile
    assert (mesh.height, mesh.width) == picture.shape[:2]
    assert np.array_equal(mesh.vertices, mesh.canonical().vertices)
    assert np.array_equal(mesh.triangles, mesh.canonical().triangles)


@pytest.mark.parametrize("effort", [1, 2, 5])
@pytest.mark.parametrize(
    "picture",
    [
        noise(40, 65),
        noise(33, 64, 1)[:, :, 0],
        noise(40, 90, 4),
        disc(64, 64, (255, 0, 0), (20, 90, 160)),
        constant(65, 33, 9, 8, 7),
        ramp(1, 100),
        noise(97, 1),
        noise(33, 40).astype(np.uint16) * 257,
    ],
    ids=["1 wide at the end", "grey", "RGBA", "disc", "constant", "row", "column", "16 bits"],
)
def test_every_picture_becomes_a_sound_mesh_in_tiles(picture: UInt8Array, effort: int) -> None:
    goals: tuple[dict[str, Any], ...] = ({}, {"vertices": 60}, {"quality": 100}, {"vertices": 4})
    for goal in goals:
        check(encode(picture, effort=effort, tile=32, **goal), picture, 32)


def test_a_picture_that_fits_one_tile_has_none(cup: UInt8Array) -> None:
    mesh = encode(cup, vertices=100, tile=128)
    assert mesh == encode(cup, vertices=100)
    assert mesh.tile is None
    assert encode(cup, vertices=100, tile=127).tile == 127


@pytest.mark.parametrize("effort", [1, 5])
def test_a_mesh_in_tiles_does_not_depend_on_the_number_of_threads(
    cup: UInt8Array, effort: int
) -> None:
    first, *others = (
        encode(cup, vertices=300, effort=effort, tile=48, threads=n) for n in (1, 2, 5)
    )
    assert all(other == first for other in others)


@pytest.mark.parametrize("n_vertices", [60, 300, 1000, 3000])
def test_a_number_of_vertices_is_met(cup: UInt8Array, n_vertices: int) -> None:
    assert encode(cup, vertices=n_vertices, tile=48).n_vertices == n_vertices
    sampled = encode(cup, vertices=n_vertices, tile=48, effort=1)
    assert sampled.n_vertices == pytest.approx(n_vertices, rel=0.02, abs=1)


@pytest.mark.parametrize("effort", [1, 3])
@pytest.mark.parametrize("size", [700, 3000])
def test_a_size_is_met_from_below(cup: UInt8Array, size: int, effort: int) -> None:
    mesh = encode(cup, target_size=size, tile=64, effort=effort)
    check(mesh, cup, 64)
    assert 0.98 * size <= len(dumps(mesh)) <= size


@pytest.mark.parametrize(("wanted", "effort"), [(24.0, 3), (32.0, 3), (28.0, 1)])
def test_a_psnr_is_met_from_above(cup: UInt8Array, wanted: float, effort: int) -> None:
    mesh = encode(cup, target_psnr=wanted, tile=64, effort=effort)
    check(mesh, cup, 64)
    assert wanted <= measure_psnr(as_image(cup), mesh) <= wanted + 0.1


def test_a_quality_leaves_about_as_many_vertices_as_without_tiles(cup: UInt8Array) -> None:
    for quality in (50, 75, 95):
        whole, tiled = (encode(cup, quality=quality, tile=tile) for tile in (None, 64))
        assert tiled.n_vertices == pytest.approx(whole.n_vertices, rel=0.15)


@pytest.mark.parametrize("effort", [1, 5])
def test_tiles_cost_less_than_a_tenth_of_the_vertices(coffee: UInt8Array, effort: int) -> None:
    picture = np.ascontiguousarray(coffee[60:316, 120:440])
    tiled = encode(picture, vertices=1500, effort=effort, tile=128)
    whole = encode(picture, vertices=1350, effort=effort)
    assert psnr(drawn(tiled), picture) > psnr(drawn(whole), picture)


def test_vertices_go_where_they_matter() -> None:
    picture = np.full((64, 128, 3), 90, dtype=np.uint8)
    picture[:, 64:] = noise(64, 64)
    for effort in (1, 3):
        mesh = encode(picture, vertices=400, tile=64, effort=effort)
        assert (mesh.points[:, 0] < 64).sum() < 30


def test_progress_is_reported_from_the_thread_that_asked(cup: UInt8Array) -> None:
    for goal in ({}, {"vertices": 200}, {"target_psnr": 28.0}):
        stages, threads = [], set()

        def report(stage: str) -> None:
            stages.append(stage)  # noqa: B023
            threads.add(threading.current_thread())  # noqa: B023

        encode(cup, tile=32, threads=2, progress=report, **goal)
        assert set(stages) <= set(STAGES)
        assert threads == {threading.current_thread()}
        assert len(stages) <= 2 * count_steps(Settings(tile=32))


# --- Parts ----------------------------------------------------------------------------------------

SQUARE = np.array([[0, 0], [64, 0], [0, 64], [64, 64]], dtype=np.int32)


def with_corners(*points: tuple[int, int]) -> tuple[Int32Array, Int32Array]:
    vertices = np.concatenate([SQUARE, np.array(points, dtype=np.int32).reshape(-1, 2)])
    vertices = vertices[np.lexsort((vertices[:, 0], vertices[:, 1]))]
    return vertices, delaunay(vertices)


def joined(*tiles: tuple[Int32Array, Int32Array], columns: int) -> Mesh:
    """The joined mesh of some tiles of 32 x 32 pixels."""
    grid = Grid(32 * columns, 32 * len(tiles) // columns, 32)
    vertices, triangles = join(grid, tiles)
    colors = np.zeros((len(vertices), 1), dtype=np.uint8)
    mesh = Mesh.from_colors(
        grid.width, grid.height, vertices, triangles, colors, subdivision=1
    ).replaced(tile=32)
    mesh.check()
    assert mesh == mesh.canonical()
    return mesh


def test_neighbours_share_the_vertices_of_both() -> None:
    left = with_corners((64, 11), (64, 31), (31, 31))
    right = with_corners((0, 31), (0, 41), (0, 43), (21, 21))
    mesh = joined(left, right, columns=2)
    on_line = mesh.vertices[mesh.vertices[:, 0] == 64]
    assert on_line[:, 1].tolist() == [0, 11, 31, 41, 43, 64]
    assert mesh.n_vertices == 4 + 6 + 2


def test_a_triangle_in_a_corner_fans_out_to_two_sides() -> None:
    plain = with_corners()
    mesh = joined(plain, with_corners((0, 21)), with_corners((5, 0), (33, 0)), plain, columns=2)
    assert mesh.n_vertices == 9 + 3


def test_vertices_beside_a_line_are_put_on_it() -> None:
    left = with_corners((63, 11), (61, 31), (1, 31), (31, 31))
    right = with_corners((1, 31), (5, 41), (31, 63))
    mesh = joined(left, right, columns=2)
    x, y = mesh.vertices.T
    assert sorted(y[x == 64].tolist()) == [0, 11, 31, 64]
    # The sides of the canvas are no lines between tiles.
    assert {(1, 31), (69, 41), (95, 63)} <= set(zip(x.tolist(), y.tolist(), strict=True))


def test_any_tiles_are_joined_to_a_sound_mesh() -> None:
    random = np.random.default_rng(5)
    for n in (3, 30, 300):
        tiles = []
        for _ in range(6):
            points = np.unique(random.integers(0, 33, (n, 2)) * 2, axis=0)
            inner = np.unique(random.integers(0, 32, (n, 2)) * 2 + 1, axis=0)
            border = points[((points == 0) | (points == 64)).any(axis=1)]
            corner = ((border == 0) | (border == 64)).all(axis=1)
            tiles.append(with_corners(*map(tuple, [*border[~corner], *inner])))
        joined(*tiles, columns=3)


def test_each_tile_is_coded_on_its_own(cup: UInt8Array) -> None:
    mesh = encode(cup, vertices=500, tile=48, effort=2)
    grid = Grid(mesh.width, mesh.height, 48)
    hierarchy = code_order(mesh.vertices, grid, mesh.unit)
    assert sorted(hierarchy.order.tolist()) == list(range(mesh.n_vertices))
    place = 0
    known: set[int] = set()
    for tile in grid.tiles():
        low = np.array([tile.x, tile.y]) * mesh.unit
        high = low + np.array([tile.width, tile.height]) * mesh.unit
        inside = ((mesh.vertices >= low) & (mesh.vertices <= high)).all(axis=1)
        members = np.flatnonzero(inside)
        own = mesh.vertices[members] - low.astype(np.int32)
        expected = build_hierarchy(own, delaunay(own))
        for i, v in enumerate(members[expected.order].tolist()):
            if v in known:
                continue
            known.add(v)
            parents = members[expected.parents[expected.starts[i] : expected.starts[i + 1]]]
            start, end = hierarchy.starts[place], hierarchy.starts[place + 1]
            assert hierarchy.order[place] == v
            assert hierarchy.parents[start:end].tolist() == parents.tolist()
            assert set(parents.tolist()) <= known
            place += 1
    assert place == mesh.n_vertices


def test_numbers_in_proportion_add_up() -> None:
    assert apportion([1.0, 1.0, 1.0], 100) == [34, 33, 33]
    assert apportion([10.0, 20.0, 70.0], 50) == [5, 10, 35]
    assert apportion([0.0, 0.0], 50) == [4, 4]
    assert apportion([0.0, 96.0], 96) == [4, 96]
