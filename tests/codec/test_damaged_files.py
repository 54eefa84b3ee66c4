"""Files with damage behind checksums that fit, read by compiled, plain and bounds-checked code."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections import Counter
from pathlib import Path
from typing import Final

import pytest

from tests.codec.damage import file_of, split
from tests.codec.mutants import corpus
from tests.codec.outcomes import digest, outcomes
from tests.codec.trial import Outcome, try_file

_ROOT: Final = Path(__file__).parents[2]
N_TRIED: Final = 20_000
# Uncompiled, a file takes a hundred times as long.
N_PLAIN: Final = 300
N_BOUNDS_CHECKED: Final = 4_000

pytestmark = pytest.mark.skipif(
    "NUMBA_DISABLE_JIT" in os.environ, reason="uncompiled, 20,000 files take half an hour"
)


@pytest.fixture(scope="module")
def smallest() -> list[bytes]:
    """The five smallest conformance files that are in order."""
    return [data for data in corpus() if try_file(data).code == "loaded"][:5]


@pytest.fixture(scope="module")
def tried() -> list[Outcome]:
    """What became of many damaged files."""
    return list(outcomes(N_TRIED))


def changes(data: bytes) -> list[bytes]:
    """The bytes with one of them changed, each to all other values."""
    return [
        data[:at] + bytes([value]) + data[at + 1 :]
        for at in range(len(data))
        for value in range(256)
        if value != data[at]
    ]


def test_every_truncation_of_the_smallest_files_is_refused(smallest: list[bytes]) -> None:
    starts = [data[:length] for data in smallest for length in range(len(data))]
    assert {try_file(start).code for start in starts} == {"truncated"}


def test_every_change_of_a_byte_of_the_smallest_files_is_refused(smallest: list[bytes]) -> None:
    codes = Counter(try_file(changed).code for data in smallest for changed in changes(data))
    assert len(smallest) == 5
    assert "loaded" not in codes
    assert codes.total() == 255 * sum(map(len, smallest))


def test_every_change_of_a_byte_behind_the_checksums_loads_or_is_refused(
    smallest: list[bytes],
) -> None:
    codes = set()
    for data in smallest:
        header, (mesh,) = split(data)
        codes |= {try_file(file_of(changed, [mesh])).code for changed in changes(header)}
        for content in changes(mesh[1]):
            codes.add(try_file(file_of(header, [(mesh[0], content)])).code)
    assert {"loaded", "header", "positions", "geometry", "colors"} <= codes


def test_damaged_files_load_as_valid_meshes_or_are_refused(tried: list[Outcome]) -> None:
    codes = {outcome.code for outcome in tried}
    assert codes >= {
        "loaded", "limit", "truncated", "trailing", "version", "header", "checksum", "chunk",
        "metadata", "positions", "geometry", "colors", "triangles",
    }  # fmt: skip


def read_elsewhere(n_files: int, **environment: str) -> tuple[bool, str]:
    """Whether bounds are checked in another process, and the digest of its outcomes."""
    done = subprocess.run(
        [sys.executable, "-W", "error", "-m", "tests.codec.outcomes", str(n_files)],
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=False,
        cwd=_ROOT,
    )
    assert done.returncode == 0, done.stderr
    checked, found = json.loads(done.stdout.splitlines()[-1])
    return checked, found


def test_plain_python_makes_the_same_of_damaged_files(tried: list[Outcome]) -> None:
    _, found = read_elsewhere(N_PLAIN, NUMBA_DISABLE_JIT="1")
    assert found == digest(tried[:N_PLAIN])


def test_damaged_files_are_read_within_the_bounds_of_all_arrays(
    tried: list[Outcome], tmp_path: Path
) -> None:
    # With a warm cache Numba would silently take kernels that were compiled without the checks.
    checked, found = read_elsewhere(
        N_BOUNDS_CHECKED, NUMBA_BOUNDSCHECK="1", NUMBA_CACHE_DIR=str(tmp_path)
    )
    assert checked, "a read beyond the end, planted to be found, was not noticed"
    assert found == digest(tried[:N_BOUNDS_CHECKED])
