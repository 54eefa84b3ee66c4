"""Files that were cut off, read as far as they go."""

from __future__ import annotations

import warnings
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.codec import samples
from tests.codec.damage import mutant, split, varint
from tests.strategies import meshes
from vmesh.arrays import UInt8Array
from vmesh.codec.reader import loads, read
from vmesh.codec.writer import dumps
from vmesh.encoder.pipeline import encode
from vmesh.errors import FormatError, PartialFileWarning, VmeshError
from vmesh.formats.raster.rendering import render
from vmesh.limits import Limits
from vmesh.mesh import Mesh
from vmesh.metrics import psnr


def soft_picture() -> UInt8Array:
    """A picture of soft blobs, 96 x 64."""
    y, x = np.mgrid[:64, :96] / 10
    planes = [np.sin(x) + np.cos(y), np.sin(x + y), np.cos(x - 2 * y)]
    picture: UInt8Array = np.clip(128 + 60 * np.stack(planes, axis=2), 0, 255).astype(np.uint8)
    return picture


def load_start(data: bytes, length: int) -> Mesh:
    """The mesh of the first bytes of a file, which warns that it is not the whole one."""
    with pytest.warns(PartialFileWarning, match="the file ends within chunk M"):
        return loads(data[:length], allow_partial=True)


def test_a_longer_start_shows_a_better_picture() -> None:
    image = soft_picture()
    data = dumps(encode(image, vertices=400))
    sizes = read(data).sizes
    first = len(data) - 4 - sizes["colors"] - sizes.get("triangles", 0)
    quality = [
        psnr(image, render(load_start(data, length)))
        for length in np.linspace(first + 4, len(data) - 4, 6).astype(int)
    ]
    assert all(a < b for a, b in pairwise(quality))
    assert quality[-1] == psnr(image, render(loads(data)))


@given(meshes(), st.data())
def test_what_is_there_is_that_of_the_whole_file(mesh: Mesh, draw: st.DataObject) -> None:
    data = dumps(mesh)
    length = draw.draw(st.integers(0, len(data) - 1))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PartialFileWarning)
        try:
            start = loads(data[:length], allow_partial=True)
        except FormatError as error:
            assert error.code in ("truncated", "positions", "header")
            return
    start.check()
    assert np.array_equal(start.vertices, mesh.vertices)
    if length >= len(data) - 4:
        assert np.array_equal(start.levels, mesh.levels)
        assert np.array_equal(start.triangles, mesh.triangles)


def test_a_whole_file_warns_of_nothing() -> None:
    data = dumps(samples.CASES["RGB, flipped"]())
    assert np.array_equal(loads(data, allow_partial=True).levels, loads(data).levels)


def test_nothing_but_a_missing_end_is_passed_over() -> None:
    data = dumps(samples.CASES["with metadata"]())
    *_, (_, content) = split(data)[1]
    # A length of the mesh that is too large is as good as a file that is too short.
    length_at = len(data) - 4 - len(content) - len(varint(len(content)))
    for at in {*range(len(data))} - {length_at}:
        changed = bytearray(data)
        changed[at] ^= 1
        with pytest.raises(FormatError):
            loads(bytes(changed), allow_partial=True)
    with pytest.raises(FormatError, match="code trailing"):
        loads(data + b"\0", allow_partial=True)


def test_damaged_starts_of_files_raise_nothing_but_errors_of_vmesh() -> None:
    random = np.random.default_rng(4)
    data = [
        dumps(samples.CASES[name]()) for name in ("grey, flipped", "RGB, implied", "with metadata")
    ]
    limits = Limits(max_pixels=1 << 22, max_vertices=1 << 14)
    outcomes = set()
    for _ in range(3000):
        changed = mutant(data[random.integers(len(data))], random)
        cut = changed[: random.integers(len(changed) // 2, len(changed) + 1)]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", PartialFileWarning)
            try:
                loads(cut, limits=limits, allow_partial=True).check()
                outcomes.add("mesh")
            except VmeshError as error:
                outcomes.add(getattr(error, "code", "limit"))
    assert {"mesh", "truncated", "positions", "header"} <= outcomes
