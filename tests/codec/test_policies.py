"""Policies of reading: each refuses or notes what it is told of a damaged file."""

from __future__ import annotations

import pytest

from tests.codec import samples
from tests.codec.damage import file_of, split
from vmesh.codec.policy import Collecting, Partial, Strict
from vmesh.codec.reader import read
from vmesh.codec.writer import dumps
from vmesh.errors import FormatError

WHOLE = dumps(samples.grey())
HEADER, (MESH,) = split(WHOLE)
DAMAGED = file_of(HEADER, [(b"i", b"no stream"), (b"n", b"unknown"), MESH]) + b"rest"


@pytest.mark.parametrize("policy", [Strict(), Partial(), Collecting()])
def test_a_whole_file_is_the_same_to_every_policy(policy: Strict | Partial | Collecting) -> None:
    reading = read(WHOLE, policy)
    assert reading.mesh == samples.grey().canonical()
    assert sum(reading.sizes.values()) == len(MESH[1])
    assert reading.errors == []


@pytest.mark.parametrize("policy", [Strict(), Partial()])
def test_the_first_error_is_raised(policy: Strict | Partial) -> None:
    with pytest.raises(FormatError, match="bytes follow the mesh"):
        read(DAMAGED, policy)
    assert policy.errors == []


def test_a_collecting_reader_returns_the_mesh_with_all_errors() -> None:
    reading = read(DAMAGED, Collecting())
    assert [error.code for error in reading.errors] == ["trailing", "metadata"]
    assert reading.mesh.metadata.unknown == ((b"n", b"unknown"),)
    assert reading.mesh.metadata.icc == b""
    assert read(WHOLE).mesh == reading.mesh.replaced(metadata=read(WHOLE).mesh.metadata)


def test_a_file_that_was_cut_off_is_read_in_part_and_says_so() -> None:
    start = WHOLE[:-8]
    with pytest.raises(FormatError, match="ends within chunk M"):
        read(start)
    reading = read(start, Partial())
    assert [error.code for error in reading.errors] == ["truncated"]
    assert reading.mesh.n_vertices == samples.grey().n_vertices


def test_what_was_noted_is_at_hand_where_nothing_can_be_read() -> None:
    policy = Collecting()
    with pytest.raises(FormatError) as caught:
        read(file_of(HEADER, [(b"Q", b""), (b"M", MESH[1][:4])]), policy)
    assert caught.value.code == "positions"
    assert [error.code for error in policy.errors] == ["chunk"]
