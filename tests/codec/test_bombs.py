"""Small files that ask for a lot: what they cost before they are refused."""

from __future__ import annotations

import tracemalloc
import zlib
from collections.abc import Callable
from functools import partial
from typing import Final

import pytest

from tests.codec import samples
from tests.codec.damage import (
    SIGNATURE,
    checked,
    chunk_of,
    file_of,
    split,
    with_content,
    with_header,
)
from tests.spec.recipes import count_bomb, largest_canvas, overdrawn, slivers
from vmesh.codec.hex_dump import annotate
from vmesh.codec.reader import loads
from vmesh.codec.validation import validate
from vmesh.codec.writer import dumps
from vmesh.errors import FormatError, LimitError, VmeshError
from vmesh.formats.raster.rendering import render
from vmesh.limits import FREE_VERTICES, Limits

GREY: Final = dumps(samples.grey())
HEADER, (MESH,) = split(GREY)


def peak(act: Callable[[], object], error: type[VmeshError]) -> int:
    """Most bytes that an act, which is refused with an error, has in use at a time."""
    with pytest.raises(error):  # Kernels are compiled, and modules imported.
        act()
    tracemalloc.start()
    try:
        with pytest.raises(error):
            act()
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def claiming(n_vertices: int, n_bytes: int) -> bytes:
    """A file with a number of vertices, and so many bytes of mesh, that hold something else."""
    data = with_header(GREY, width=3000, height=3000, n_vertices=n_vertices)
    return with_content(data, b"M", b"\x55" * n_bytes)


@pytest.mark.parametrize("n_vertices", [FREE_VERTICES + 8 * 2000 + 1, 1_000_000, 1 << 22])
def test_a_count_beyond_the_bytes_is_refused_before_anything_is_allocated(n_vertices: int) -> None:
    assert peak(partial(loads, claiming(n_vertices, 2000)), LimitError) < 20_000


def test_the_number_of_vertices_for_a_byte_is_respected_to_the_unit() -> None:
    n_bytes = 100
    for most in (1, 8, 20):
        allowed = FREE_VERTICES + most * n_bytes
        limits = Limits(max_vertices_per_byte=most)
        with pytest.raises(FormatError):
            loads(claiming(allowed, n_bytes), limits=limits)
        with pytest.raises(LimitError, match=f"{most} vertices per byte"):
            loads(claiming(allowed + 1, n_bytes), limits=limits)


def test_a_mesh_without_anything_in_it_is_refused_and_read_if_that_is_allowed() -> None:
    mesh = count_bomb()
    data = dumps(mesh)
    assert len(data) < 60
    assert peak(partial(loads, data), LimitError) < 20_000
    assert [finding.code for finding in validate(data)] == ["limit"]
    assert loads(data, limits=Limits(max_vertices_per_byte=5_700)) == mesh


def test_as_many_vertices_as_any_file_may_have_take_little_memory() -> None:
    data = claiming(FREE_VERTICES, 100)
    assert peak(partial(loads, data), FormatError) < 30_000_000


def test_a_file_that_was_cut_off_counts_with_the_bytes_that_are_there() -> None:
    data = claiming(FREE_VERTICES + 8 * 2000, 2000)
    with pytest.raises(LimitError, match="in 1000 bytes"):
        loads(data[:-1004], allow_partial=True)


def test_slivers_are_refused_before_they_are_drawn() -> None:
    data = dumps(slivers())
    assert len(data) < 300
    mesh = loads(data)
    assert peak(partial(render, mesh), LimitError) < 20_000_000
    with pytest.raises(LimitError, match="rows of triangles"):
        render(mesh)


def test_the_rows_of_slivers_are_counted_beside_the_pixels() -> None:
    mesh = samples.listed()
    # Each triangle spans the only row and touches the next, and is looked at in the only band.
    n_rows, n_pixels = 3 * mesh.n_triangles, mesh.width * mesh.height
    assert render(mesh, limits=Limits(max_rows=n_rows - n_pixels)).size
    with pytest.raises(LimitError, match="rows of triangles"):
        render(mesh, limits=Limits(max_rows=n_rows - n_pixels - 1))


def test_the_largest_canvas_is_refused_before_it_is_drawn() -> None:
    data = dumps(largest_canvas())
    assert len(data) < 60
    assert peak(partial(loads, data), LimitError) < 20_000
    mesh = loads(data, limits=Limits(max_pixels=1 << 32))
    assert peak(partial(render, mesh), LimitError) < 20_000


def test_the_size_asked_for_counts_and_not_that_of_the_canvas() -> None:
    mesh = loads(GREY)
    assert peak(partial(render, mesh, scale=2000), LimitError) < 20_000
    canvas = loads(dumps(largest_canvas()), limits=Limits(max_pixels=1 << 32))
    assert render(canvas, width=20).shape == (20, 20)


def test_the_same_area_over_and_over_is_no_mesh() -> None:
    assert peak(partial(loads, overdrawn(40)), FormatError) < 1_000_000


def test_metadata_are_inflated_no_further_than_to_the_limit() -> None:
    bomb = zlib.compress(bytes(1 << 26), 9)
    blocks = [(tag, bomb) for tag in (b"i", b"e", b"x")]
    limits = Limits(max_metadata=1 << 20)
    most = peak(partial(loads, file_of(HEADER, [*blocks, MESH]), limits=limits), LimitError)
    assert most < 4 * (1 << 20)


def test_findings_without_number_are_told_apart_without_comparing_all_of_them(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from vmesh.codec.validation import Finding

    n_compared = 0
    compare = Finding.__eq__

    def counting(self: Finding, other: object) -> bool:
        nonlocal n_compared
        n_compared += 1
        return compare(self, other)

    monkeypatch.setattr(Finding, "__eq__", counting)
    damaged = b"n\0" + bytes(4)
    data = checked(SIGNATURE + HEADER) + 1000 * damaged + chunk_of(*MESH)
    findings = validate(data)
    assert len(findings) == 2000
    assert n_compared < 10_000
    assert len(list(annotate(data))) > 3000
