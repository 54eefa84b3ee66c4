from __future__ import annotations

import io
import zlib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.codec import samples
from tests.codec.damage import file_of, header_fields, split
from tests.pictures import PICTURES, drawn
from tests.strategies import flipped, meshes, raster_sorted
from vmesh.arrays import Int32Array, UInt8Array
from vmesh.codec.hierarchy import build_hierarchy
from vmesh.codec.mesh_coder import Encoder, find_flips
from vmesh.codec.mesh_coder import encode as encode_parts
from vmesh.codec.reader import loads, read
from vmesh.codec.stream import dump, load
from vmesh.codec.writer import dumps
from vmesh.color_lattice import ColorLattice
from vmesh.encoder.pipeline import encode
from vmesh.errors import FormatError
from vmesh.kernels.delaunay import delaunay
from vmesh.mesh import Mesh, Metadata


@st.composite
def canvases(draw: st.DrawFn) -> Int32Array:
    """Vertices of a canvas in raster order, its corners among them."""
    far_x, far_y = draw(st.integers(1, 30)), draw(st.integers(1, 30))
    site = st.tuples(st.integers(0, far_x), st.integers(0, far_y))
    sites = draw(st.sets(site, max_size=50)) | {(0, 0), (far_x, 0), (0, far_y), (far_x, far_y)}
    return raster_sorted(np.array(sorted(sites), dtype=np.int32))


@given(meshes())
def test_every_mesh_comes_back_in_canonical_order(mesh: Mesh) -> None:
    assert loads(dumps(mesh)) == mesh.canonical()


@given(meshes())
def test_a_mesh_that_was_read_is_written_as_the_same_bytes(mesh: Mesh) -> None:
    data = dumps(mesh)
    assert dumps(loads(data)) == data


@pytest.mark.parametrize("name", samples.CASES)
def test_every_way_of_telling_triangles_comes_back(name: str) -> None:
    mesh = samples.CASES[name]()
    data = dumps(mesh)
    ways = {"implied": 0, "listed": 1, "flipped": 2}
    assert header_fields(data)["connectivity"] == ways.get(name.split()[-1], 0)
    assert loads(data) == mesh


@pytest.mark.parametrize("name", ["RGB, implied", "RGB, flipped", "RGB, listed"])
def test_the_same_mesh_gives_the_same_bytes_in_any_order(name: str) -> None:
    mesh = samples.CASES[name]()
    order = np.random.default_rng(2).permutation(mesh.n_vertices)
    place = np.argsort(order).astype(np.int32)
    shuffled = mesh.replaced(
        vertices=mesh.vertices[order],
        levels=mesh.levels[order],
        triangles=place[np.roll(mesh.triangles[::-1], 1, axis=1)],
    )
    assert dumps(shuffled) == dumps(mesh) == dumps(mesh)


@pytest.mark.parametrize("name", PICTURES)
def test_encoded_pictures_come_back_and_draw_the_same(name: str) -> None:
    mesh = encode(PICTURES[name])
    again = loads(dumps(mesh))
    assert again == mesh
    assert np.array_equal(drawn(again), drawn(mesh))


def test_a_photograph_comes_back(coffee: UInt8Array) -> None:
    mesh = encode(coffee, vertices=5000)
    assert loads(dumps(mesh)) == mesh


@pytest.mark.parametrize("cast", [bytes, bytearray, memoryview])
def test_any_bytes_like_object_is_read(cast: type) -> None:
    assert loads(cast(dumps(samples.grey()))) == samples.grey()


def test_delaunay_triangles_are_not_written() -> None:
    for sample, parts in (
        (samples.color, ["positions", "colors"]),
        (samples.flipped, ["positions", "colors", "triangles"]),
    ):
        data = dumps(sample())
        mesh, sizes, _ = read(data)
        assert mesh == loads(data)
        assert list(sizes) == parts
        assert all(size > 0 for size in sizes.values())


def test_a_few_flips_take_less_than_a_list_and_more_of_them_take_more() -> None:
    mesh = samples.color()
    random = np.random.default_rng(5)
    sizes = []
    for n_flips in (3, 10, 30):
        triangles = flipped(mesh.vertices, mesh.triangles, n_flips, random)
        sizes.append(read(dumps(mesh.replaced(triangles=triangles))).sizes["triangles"])
    alone = encode_parts(lambda encoder: encoder.triangles(mesh.triangles, mesh.n_vertices))
    assert sizes == sorted(sizes)
    assert sizes[-1] < len(alone) / 2


@given(canvases(), st.integers(0, 400), st.integers(0, 2**32 - 1))
def test_any_random_flips_come_back(vertices: Int32Array, n_flips: int, seed: int) -> None:
    random = np.random.default_rng(seed)
    triangles = flipped(vertices, delaunay(vertices), n_flips, random)
    width, height = vertices[-1].tolist()
    colors = random.integers(0, random.integers(2, 256), (len(vertices), 1))
    mesh = Mesh.from_colors(width, height, vertices, triangles, colors)
    assert loads(dumps(mesh)) == mesh


@pytest.mark.parametrize("n_steps", range(1, 21))
def test_meshes_come_back_whether_they_are_a_few_flips_or_a_list_away(n_steps: int) -> None:
    mesh = two_rows(20, n_steps)
    assert loads(dumps(mesh)) == mesh


def two_rows(k: int, n_steps: int) -> Mesh:
    """Vertices on the upper and lower border, joined with a number of steps aside."""
    vertices = np.array([(x, y) for y in (0, 1) for x in range(k + 1)], dtype=np.int32)
    triangles = []
    upper = lower = 0
    for step in [0] * n_steps + [1, 0] * (k - n_steps) + [1] * n_steps:
        first, last = upper, k + 1 + lower
        upper, lower = upper + 1 - step, lower + step
        triangles.append((first, k + 1 + lower if step else upper, last))
    levels = np.zeros((len(vertices), 1), dtype=np.int32)
    mesh = Mesh(k, 1, vertices, np.array(triangles), levels, ColorLattice((1,)))
    mesh.check()
    return mesh.canonical()


@pytest.mark.parametrize("name", ["smallest", "RGB, implied", "RGB, flipped", "RGB, listed"])
def test_the_parts_of_a_mesh_add_up_to_its_chunk(name: str) -> None:
    data = dumps(samples.CASES[name]())
    ((_, content),) = split(data)[1]
    assert sum(read(data).sizes.values()) == len(content)


@pytest.mark.parametrize("name", ["RGB, flipped", "RGB, listed"])
def test_each_part_takes_what_it_takes_alone(name: str) -> None:
    # Without the part after it, a part is written in as many bytes, but for rounding.
    mesh = samples.CASES[name]()
    columns, rows = mesh.width * mesh.unit + 1, mesh.height * mesh.unit + 1
    implied = delaunay(mesh.vertices)
    flips = find_flips(mesh)

    def write_triangles(encoder: Encoder) -> None:
        if flips is None:
            encoder.triangles(mesh.triangles, mesh.n_vertices)
        else:
            encoder.flips(flips, implied, mesh)

    hierarchy = build_hierarchy(mesh.vertices, implied)
    alone = {
        "positions": encode_parts(lambda e: e.positions(mesh.vertices, columns, rows)),
        "colors": encode_parts(lambda e: e.levels(mesh.levels, hierarchy, mesh.lattice)),
        "triangles": encode_parts(write_triangles),
    }
    sizes = read(dumps(mesh)).sizes
    assert sizes == {part: pytest.approx(len(alone[part]), abs=2) for part in alone}


@pytest.mark.parametrize("n_components", [1, 3, 4])
@pytest.mark.parametrize("value", [0, 100, 255])
def test_zeros_at_the_end_of_a_mesh_are_cut_and_come_back(value: int, n_components: int) -> None:
    for side in (1, 2, 7):
        y, x = np.mgrid[: side + 1, : side + 1]
        vertices = np.stack([x.ravel(), y.ravel()], axis=1)
        colors = np.full((len(vertices), n_components), value)
        mesh = Mesh.from_colors(side, side, vertices, delaunay(vertices.astype(np.int32)), colors)
        assert loads(dumps(mesh)) == mesh


@pytest.mark.parametrize(
    ("width", "n_vertices", "frame"),
    [(127, 127, 23), (128, 127, 24), (127, 128, 24), (128, 128, 25)],
)
def test_the_frame_is_as_short_as_the_numbers_in_it(
    width: int, n_vertices: int, frame: int
) -> None:
    # The corners, and the others side by side on the lower border.
    below = [(x, 1) for x in range(1, n_vertices - 3)]
    vertices = np.array([(0, 0), (width, 0), (0, 1), *below, (width, 1)], dtype=np.int32)
    levels = np.zeros((n_vertices, 3), dtype=np.int32)
    mesh = Mesh(width, 1, vertices, delaunay(vertices), levels, ColorLattice((1, 1, 1)))
    data = dumps(mesh)
    ((_, content),) = split(data)[1]
    assert len(content) < 128
    assert len(data) - len(content) == frame


def test_the_smallest_file_is_small() -> None:
    assert len(dumps(samples.smallest())) <= 30


def test_metadata_come_back() -> None:
    mesh = samples.with_metadata()
    again = loads(dumps(mesh))
    assert again.metadata == mesh.metadata
    assert again == mesh


def test_metadata_are_compressed() -> None:
    mesh = samples.grey()
    plain = len(dumps(mesh))
    described = len(dumps(mesh.replaced(metadata=Metadata(icc=bytes(10_000)))))
    assert described < plain + 100


def test_unknown_ancillary_chunks_are_kept_as_they_are() -> None:
    unknown = ((b"n", b"one"), (b"a", b""), (b"n", b"two"))
    data = dumps(samples.grey().replaced(metadata=Metadata(unknown=unknown)))
    assert loads(data).metadata.unknown == unknown
    assert split(dumps(loads(data)))[1][:-1] == [*unknown]


@pytest.mark.parametrize("strength", range(10))
def test_a_zlib_stream_of_any_strength_is_read(strength: int) -> None:
    profile = b"profile" * 20
    header, chunks = split(dumps(samples.grey()))
    data = file_of(header, [(b"i", zlib.compress(profile, strength)), *chunks])
    assert loads(data).metadata.icc == profile


def test_files_and_streams_are_written_and_read(tmp_path: Path) -> None:
    mesh = samples.color()
    path = tmp_path / "picture.vmesh"
    dump(mesh, path)
    assert load(path) == load(str(path)) == mesh
    stream = io.BytesIO()
    dump(mesh, stream)
    assert stream.getvalue() == path.read_bytes() == dumps(mesh)
    stream.seek(0)
    assert load(stream) == mesh


def test_a_mesh_that_breaks_a_rule_is_not_written(tmp_path: Path) -> None:
    path = tmp_path / "picture.vmesh"
    dump(samples.color(), path)
    before = path.read_bytes()
    bad = samples.color().transform((1, 0.2, 0.1, 1, 0, 0))
    with pytest.raises(ValueError, match="cover") as caught:
        dump(bad, path)
    assert not isinstance(caught.value, FormatError)
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


def test_a_missing_file_is_an_error_of_the_system(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        load(tmp_path / "missing.vmesh")


@pytest.mark.parametrize(
    "unknown",
    [
        ((b"M", b""),),
        ((b"N", b"a critical tag"),),
        ((b"note", b""),),
        ((b"", b""),),
        ((b"1", b""),),
        ((b"\xe9", b""),),
        ((b"i", b"not a zlib stream"),),
    ],
)
def test_ancillary_chunks_that_no_reader_would_take_are_not_written(
    unknown: tuple[tuple[bytes, bytes], ...],
) -> None:
    with pytest.raises(ValueError):
        dumps(samples.smallest().replaced(metadata=Metadata(unknown=unknown)))
