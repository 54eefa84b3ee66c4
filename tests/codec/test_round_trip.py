from __future__ import annotations

import io
import zlib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given

from tests.codec import samples
from tests.codec.damage import contents_of
from tests.pictures import PICTURES, drawn
from tests.strategies import meshes
from vmesh.arrays import UInt8Array
from vmesh.codec.reader import loads
from vmesh.codec.stream import dump, load
from vmesh.codec.writer import dumps
from vmesh.encoder.pipeline import encode
from vmesh.errors import FormatError
from vmesh.mesh import Mesh, Metadata


@given(meshes())
def test_every_mesh_comes_back_in_canonical_order(mesh: Mesh) -> None:
    assert loads(dumps(mesh)) == mesh.canonical()


@given(meshes())
def test_a_mesh_that_was_read_is_written_as_the_same_bytes(mesh: Mesh) -> None:
    data = dumps(mesh)
    assert dumps(loads(data)) == data


def test_the_same_mesh_gives_the_same_bytes_in_any_order() -> None:
    mesh = samples.listed()
    order = np.random.default_rng(2).permutation(mesh.n_vertices)
    place = np.argsort(order)
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
    assert [tag for tag, _ in contents_of(dumps(samples.color()))] == [
        b"HEAD", b"VERT", b"COLR", b"DONE",
    ]  # fmt: skip
    assert [tag for tag, _ in contents_of(dumps(samples.listed()))] == [
        b"HEAD", b"VERT", b"TRIS", b"COLR", b"DONE",
    ]  # fmt: skip


def test_the_smallest_file_is_small() -> None:
    assert len(dumps(samples.smallest())) <= 80


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
    unknown = ((b"note", b"one"), (b"abCD", b""), (b"note", b"two"))
    data = dumps(samples.grey().replaced(metadata=Metadata(unknown=unknown)))
    assert loads(data).metadata.unknown == unknown
    assert [c for c in contents_of(dumps(loads(data))) if c[0] in (b"note", b"abCD")] == [*unknown]


def test_a_zlib_stream_of_any_strength_is_read() -> None:
    content = dict(contents_of(dumps(samples.with_metadata())))[b"iccp"]
    assert zlib.decompress(content) == b"profile" * 20


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
        ((b"HEAD", b""),),
        ((b"Note", b"a critical tag"),),
        ((b"abc", b""),),
        ((b"ab1d", b""),),
        ((b"iccp", b"not a zlib stream"),),
    ],
)
def test_ancillary_chunks_that_no_reader_would_take_are_not_written(
    unknown: tuple[tuple[bytes, bytes], ...],
) -> None:
    with pytest.raises(ValueError):
        dumps(samples.smallest().replaced(metadata=Metadata(unknown=unknown)))
