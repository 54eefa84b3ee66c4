"""Meshes in tiles: what a file holds of them, and what is left of it after damage."""

from __future__ import annotations

import tracemalloc
import warnings
from pathlib import Path
from typing import Final

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.codec.damage import chunk_of, file_of, split, split_varint, varint, with_header
from tests.spec.recipes import flipped, mesh_of
from tests.tiled import tiled
from vmesh.codec.reader import loads, read
from vmesh.codec.stream import dump, load
from vmesh.codec.validation import validate
from vmesh.codec.writer import dumps
from vmesh.errors import FormatError, LimitError, PartialFileWarning
from vmesh.formats.raster.rendering import render
from vmesh.grid import Grid, Tile
from vmesh.limits import Limits
from vmesh.mesh import Mesh

MESH: Final = tiled(40, 30, 16, 3, n_vertices=300, subdivision=1, step=4)
DATA: Final = dumps(MESH)
GRID: Final = Grid(40, 30, 16)


@given(
    st.integers(1, 12),
    st.integers(1, 12),
    st.integers(1, 13),
    st.sampled_from([1, 3, 4]),
    st.integers(0, 60),
    st.integers(0, 4),
)
def test_any_mesh_in_tiles_comes_back(
    width: int, height: int, side: int, n_components: int, n_vertices: int, subdivision: int
) -> None:
    mesh = tiled(width, height, side, n_components, n_vertices=n_vertices, subdivision=subdivision)
    mesh.check()
    assert loads(dumps(mesh)) == mesh


def test_a_path_holds_tiles_like_bytes_do(tmp_path: Path) -> None:
    dump(MESH, tmp_path / "tiles.vmesh")
    assert load(tmp_path / "tiles.vmesh") == MESH


def test_tiles_change_the_file_and_not_the_picture() -> None:
    whole = loads(dumps(MESH.replaced(tile=None)))
    assert whole == MESH.replaced(tile=None)
    assert np.array_equal(render(whole), render(MESH))
    assert DATA[5] == 0x11
    assert dumps(whole)[5] == 0x10


def test_each_tile_is_coded_like_a_mesh_of_its_own() -> None:
    mesh = tiled(
        40, 30, 16, 4, n_vertices=400, subdivision=1, change=lambda piece: flipped(piece, 2)
    )
    data = dumps(mesh)
    _, chunks = split(data)
    assert [tag for tag, _ in chunks] == [b"G", *[b"T"] * GRID.n_tiles]
    sizes: dict[str, int] = {}
    for tile, (_, content) in zip(GRID.tiles(), chunks[1:], strict=True):
        n_vertices, start = split_varint(content, 0)
        header, _ = split(
            with_header(data, width=tile.width, height=tile.height, n_vertices=n_vertices)
        )
        alone, parts, _ = read(file_of(header, [(b"M", content[start:])]))
        assert alone == piece_of(mesh, tile)
        sizes = {name: sizes.get(name, 0) + size for name, size in parts.items()}
    assert read(data).sizes == sizes


def piece_of(mesh: Mesh, tile: Tile) -> Mesh:
    """The triangles of a mesh within a tile, as a mesh on a canvas of its own."""
    low = np.array(tile[:2]) * mesh.unit
    high = low + np.array(tile[2:]) * mesh.unit
    inside = ((mesh.vertices >= low) & (mesh.vertices <= high)).all(axis=1)
    faces = mesh.triangles[inside[mesh.triangles].all(axis=1)]
    number = np.cumsum(inside) - 1
    return Mesh(
        tile.width,
        tile.height,
        mesh.vertices[inside] - low,
        number[faces],
        mesh.levels[inside],
        mesh.lattice,
        mesh.subdivision,
    )


def test_a_triangle_across_a_line_between_tiles_is_refused() -> None:
    mesh = mesh_of(8, 8, 1, n_vertices=20)
    with pytest.raises(ValueError, match="crosses the line between two tiles"):
        dumps(mesh.replaced(tile=4))
    assert loads(dumps(mesh.replaced(tile=8))).tile == 8


@pytest.mark.parametrize(("side", "subdivision"), [(0, 0), (-3, 0), (4097, 0), (2049, 1), (17, 8)])
def test_a_side_out_of_range_is_refused(side: int, subdivision: int) -> None:
    mesh = mesh_of(8, 8, 1, subdivision=subdivision)
    with pytest.raises(ValueError, match=f"tiles of 1 to {4096 >> subdivision} pixels"):
        mesh.replaced(tile=side)


def test_a_mesh_that_is_moved_has_no_tiles() -> None:
    assert MESH.transform((2, 0, 0, 1, 0, 0)).tile is None


# --- damage ------------------------------------------------------------------------------------


def places(data: bytes = DATA) -> list[int]:
    """Where the chunk of each tile of a file starts, and where the file ends."""
    header, (grid, *chunks) = split(data)
    ends = np.cumsum([len(file_of(header, [grid])), *(len(chunk_of(*chunk)) for chunk in chunks)])
    return [int(end) for end in ends]


def damaged(*numbers: int) -> bytes:
    """The file with a byte changed in the middle of some of its tiles."""
    data = bytearray(DATA)
    for number in numbers:
        data[sum(places()[number : number + 2]) // 2] ^= 1
    return bytes(data)


def load_rest(data: bytes) -> Mesh:
    """What a damaged file still gives, which warns."""
    with pytest.warns(PartialFileWarning, match="tiles that are lost are filled in"):
        mesh = loads(data, allow_partial=True)
    mesh.check()
    assert (mesh.width, mesh.height, mesh.tile) == (40, 30, 16)
    return mesh


@pytest.mark.parametrize("numbers", [(0,), (4,), (5,), (0, 1), (1, 3, 4), (0, 1, 2, 3, 5)])
def test_damage_stays_in_its_tiles(numbers: tuple[int, ...]) -> None:
    data = damaged(*numbers)
    with pytest.raises(FormatError) as caught:
        loads(data)
    assert caught.value.code == "checksum"
    assert caught.value.offset == places()[numbers[0]]

    mesh = load_rest(data)
    for number, tile in enumerate(GRID.tiles()):
        same = piece_of(mesh, tile) == piece_of(MESH, tile)
        assert same == (number not in numbers)


def test_a_lost_tile_is_made_of_what_is_around_it() -> None:
    mesh = load_rest(damaged(4))
    piece, before = (piece_of(some, list(GRID.tiles())[4]) for some in (mesh, MESH))
    far = np.array([16, 14]) * 2
    above = before.vertices[:, 1] < far[1]
    on_side = ((before.vertices == 0) | (before.vertices[:, :1] == far[0])).any(axis=1)
    wanted = {tuple(v) for v in before.vertices[on_side & above].tolist()} | {(0, 28), (32, 28)}
    assert {tuple(v) for v in piece.vertices.tolist()} == wanted


def test_where_no_tile_is_left_to_tell_it_a_corner_has_the_mean_colour() -> None:
    mesh = load_rest(DATA[: places()[1]])
    first = piece_of(mesh, next(GRID.tiles()))
    (corner,) = mesh.levels[(mesh.vertices == [80, 60]).all(axis=1)]
    assert np.abs(corner - first.levels.mean(axis=0)).max() <= 0.5


def test_every_start_gives_the_tiles_that_are_whole() -> None:
    whole = tiled(40, 30, 16, 1, n_vertices=60, step=4)
    data = dumps(whole)
    ends = places(data)[1:]
    pieces = [piece_of(whole, tile) for tile in GRID.tiles()]
    for length in range(len(data)):
        if length < ends[0]:
            with pytest.raises(FormatError):
                loads(data[:length], allow_partial=True)
            continue
        mesh = load_rest(data[:length])
        n_whole = sum(end <= length for end in ends)
        for tile, piece in list(zip(GRID.tiles(), pieces, strict=True))[:n_whole]:
            assert piece_of(mesh, tile) == piece


def test_a_file_whose_tiles_are_all_damaged_is_refused() -> None:
    with pytest.raises(FormatError, match="no tile of the file can be read"):
        loads(damaged(*range(6)), allow_partial=True)


def test_a_whole_file_is_read_without_a_warning() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert loads(DATA, allow_partial=True) == MESH


def test_every_tile_that_is_damaged_is_named() -> None:
    found = [(finding.code, finding.offset) for finding in validate(damaged(1, 4))]
    assert found == [("checksum", places()[1]), ("checksum", places()[4])]


# --- limits ------------------------------------------------------------------------------------


def test_the_number_of_tiles_is_limited_to_the_unit() -> None:
    assert loads(DATA, limits=Limits(max_tiles=6)) == MESH
    with pytest.raises(LimitError, match="6 tiles, but the limit is 5"):
        loads(DATA, limits=Limits(max_tiles=5))


def test_vertices_of_all_tiles_together_are_limited() -> None:
    n_coded = sum(piece_of(MESH, tile).n_vertices for tile in GRID.tiles())
    assert n_coded > MESH.n_vertices
    assert loads(DATA, limits=Limits(max_vertices=n_coded)) == MESH
    with pytest.raises(LimitError, match=f"{n_coded} vertices"):
        loads(DATA, limits=Limits(max_vertices=n_coded - 1))


@pytest.mark.parametrize("allow_partial", [False, True])
def test_a_claim_of_many_tiles_costs_nothing(allow_partial: bool) -> None:
    header, (_, *tiles) = split(
        with_header(DATA, width=16_000, height=16_000, subdivision=0, n_vertices=2**31 - 1)
    )
    data = file_of(header, [(b"G", varint(1)), *tiles])
    tracemalloc.start()
    try:
        with pytest.raises((FormatError, LimitError)):
            loads(data, allow_partial=allow_partial)
        assert tracemalloc.get_traced_memory()[1] < 200_000
    finally:
        tracemalloc.stop()
