"""All that is wrong with a file, and its bytes with their meaning."""

from __future__ import annotations

import zlib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.codec import samples
from tests.codec.damage import file_of, mutant, split, with_header
from vmesh.codec.hex_dump import annotate
from vmesh.codec.reader import loads
from vmesh.codec.validation import Finding, Severity, validate
from vmesh.codec.writer import dumps
from vmesh.errors import FormatError, LimitError
from vmesh.limits import Limits


def codes(findings: list[Finding]) -> list[str]:
    return [finding.code for finding in findings if finding.severity is Severity.ERROR]


@pytest.mark.parametrize("name", samples.CASES)
def test_a_sound_file_has_no_errors(name: str) -> None:
    assert not codes(validate(dumps(samples.CASES[name]())))


def test_an_unknown_ancillary_chunk_is_noted() -> None:
    header, (mesh,) = split(dumps(samples.grey()))
    (finding,) = validate(file_of(header, [(b"n", b"text"), mesh]))
    assert finding.severity is Severity.NOTE
    assert finding.code == "unknown"
    assert "chunk n" in finding.message


def test_all_that_is_wrong_is_found() -> None:
    header, (mesh,) = split(dumps(samples.grey()))
    bad = [(b"i", b"no stream"), (b"i", b""), (b"Q", b""), (b"M", mesh[1][:4])]
    data = bytearray(file_of(header, bad) + b"rest")
    data[-9] ^= 1  # the checksum of the mesh
    found = validate(bytes(data))
    assert codes(found) == [
        "chunk", "chunk", "checksum", "trailing", "metadata", "metadata", "positions",
    ]  # fmt: skip
    assert all(finding.offset is not None for finding in found)


def test_every_wrong_field_of_a_header_is_named() -> None:
    data = with_header(dumps(samples.grey()), width=0, height=70_000, n_vertices=2, connectivity=3)
    found = validate(data)
    assert codes(found) == ["header"] * 3
    told = " and ".join(finding.message for finding in found)
    for field in ("got 0 x 70000", "vertices, got 2", "connectivity 3"):
        assert field in told


def test_what_is_beyond_a_limit_is_not_called_valid() -> None:
    data = dumps(samples.color())
    assert codes(validate(data, limits=Limits(max_vertices=10))) == ["limit"]
    assert codes(validate(data, limits=Limits(max_pixels=10))) == ["limit"]


def test_metadata_that_are_too_much_together_are_not_called_valid() -> None:
    header, (mesh,) = split(dumps(samples.grey()))
    blocks = [(tag, zlib.compress(bytes(600))) for tag in (b"i", b"e")]
    data = file_of(header, [*blocks, mesh])
    assert codes(validate(data, limits=Limits(max_metadata=1000))) == ["limit"]
    assert not validate(data, limits=Limits(max_metadata=1200))


@given(st.integers(0, 2**32), st.sampled_from(["grey, flipped", "RGB, listed", "with metadata"]))
def test_the_first_error_of_the_reader_is_among_the_findings(seed: int, name: str) -> None:
    data = mutant(dumps(samples.CASES[name]()), np.random.default_rng(seed))
    limits = Limits(max_pixels=1 << 22, max_vertices=1 << 14)
    try:
        loads(data, limits=limits)
        expected = None
    except FormatError as error:
        expected = error.code
    except LimitError:
        expected = "limit"
    found = codes(validate(data, limits=limits))
    assert expected in found if expected else not found


# --- annotation ---------------------------------------------------------------------------------


@pytest.mark.parametrize("name", samples.CASES)
def test_the_fields_of_a_file_are_all_its_bytes(name: str) -> None:
    data = dumps(samples.CASES[name]())
    fields = list(annotate(data))
    assert b"".join(field.data for field in fields) == data
    assert [field.offset for field in fields] == [
        sum(len(before.data) for before in fields[:i]) for i in range(len(fields))
    ]
    mesh = loads(data)
    meanings = [field.meaning for field in fields]
    assert f"width {mesh.width}" in meanings
    assert f"vertices {mesh.n_vertices}" in meanings
    assert "chunk M: mesh" in meanings
    assert not any("WRONG" in meaning for meaning in meanings)


@given(st.integers(0, 2**32), st.floats(0, 1))
def test_the_fields_of_a_damaged_file_are_all_its_bytes(seed: int, share: float) -> None:
    data = mutant(dumps(samples.CASES["with metadata"]()), np.random.default_rng(seed))
    data = data[: round(share * len(data))]
    assert b"".join(field.data for field in annotate(data)) == data


@given(st.binary(max_size=60))
def test_the_fields_of_any_bytes_are_all_of_them(data: bytes) -> None:
    assert b"".join(field.data for field in annotate(data)) == data


def test_a_wrong_checksum_and_a_cut_are_told() -> None:
    data = bytearray(dumps(samples.grey()))
    data[-1] ^= 255
    assert "CRC-32, WRONG" in list(annotate(bytes(data)))[-1].meaning
    assert list(annotate(bytes(data[:-6])))[-1].meaning.startswith("truncated: the file ends")
