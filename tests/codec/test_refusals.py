from __future__ import annotations

import zlib
from contextlib import suppress

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.codec import samples
from tests.codec.damage import (
    HEADER_FIELDS,
    STEPS_OFFSET,
    contents_of,
    file_of,
    mutant,
    with_content,
    with_header,
)
from vmesh.arrays import Int32Array
from vmesh.codec.payloads import encode_triangles
from vmesh.codec.reader import loads
from vmesh.codec.writer import dumps
from vmesh.errors import FormatError, LimitError, VmeshError
from vmesh.kernels import entropy
from vmesh.kernels.delaunay import delaunay
from vmesh.limits import Limits

SAMPLES = (
    samples.smallest,
    samples.grey,
    samples.color,
    samples.transparent,
    samples.listed,
    samples.with_metadata,
)


def refusal(data: bytes) -> str:
    """The code of the error that refuses a file."""
    with pytest.raises(FormatError) as caught:
        loads(data)
    assert 0 <= caught.value.offset <= len(data)
    assert f"code {caught.value.code}, at byte {caught.value.offset}" in str(caught.value)
    return caught.value.code


def test_a_file_taken_apart_and_put_together_is_the_same_file() -> None:
    data = dumps(samples.with_metadata())
    assert file_of(contents_of(data)) == data


@pytest.mark.parametrize("sample", [samples.smallest, samples.listed, samples.with_metadata])
def test_every_truncation_is_rejected(sample: type) -> None:
    data = dumps(sample())
    for length in range(len(data)):
        assert refusal(data[:length]) == "truncated"


def test_every_change_of_a_byte_of_the_smallest_file_is_rejected() -> None:
    data = dumps(samples.smallest())
    for at in range(len(data)):
        for change in range(1, 256):
            changed = bytearray(data)
            changed[at] ^= change
            assert refusal(bytes(changed)) in {
                "signature", "chunk", "checksum", "truncated", "trailing",
            }  # fmt: skip


@pytest.mark.parametrize("sample", SAMPLES)
def test_mutants_with_repaired_checksums_load_as_valid_meshes_or_are_refused(
    sample: type,
) -> None:
    data = dumps(sample())
    random = np.random.default_rng(len(data))
    # A count of up to 2**32 vertices is a mutation away: the limits keep the suite small.
    limits = Limits(max_pixels=1 << 22, max_vertices=1 << 14)
    outcomes = set()
    for _ in range(500):
        try:
            mesh = loads(mutant(data, random), limits=limits)
        except FormatError as error:
            outcomes.add(error.code)
        except LimitError:
            outcomes.add("limit")
        else:
            mesh.check()
            assert loads(dumps(mesh)) == mesh
            outcomes.add("loaded")
    assert {"loaded", "header"} <= outcomes


@given(st.binary(max_size=200))
def test_any_bytes_after_the_signature_are_refused(data: bytes) -> None:
    with pytest.raises(VmeshError):
        loads(b"\x8bVMS\r\n\x1a\n" + data)


@given(st.lists(st.tuples(st.sampled_from([b"VERT", b"TRIS", b"COLR", b"note"]), st.binary())))
def test_any_chunks_after_a_header_load_or_are_refused(chunks: list[tuple[bytes, bytes]]) -> None:
    head = contents_of(dumps(samples.grey()))[0]
    with suppress(VmeshError):
        loads(file_of([head, *chunks, (b"DONE", b"")])).check()


@pytest.mark.parametrize(
    "start",
    [
        b"\x89PNG\r\n\x1a\n",
        b"\x0bVMS\r\n\x1a\n",  # passed through seven bits
        b"\x8bVMS\n\x1a\n",  # line ends converted
        b"\x8bVMS\r\n\x1a\r\n",
        b"VMS",
        b"\0",
    ],
)
def test_another_signature_is_rejected(start: bytes) -> None:
    assert refusal(start + dumps(samples.smallest())[8:]) == "signature"


def test_bytes_after_the_end_are_rejected() -> None:
    data = dumps(samples.smallest())
    assert refusal(data + b"\0") == "trailing"
    assert refusal(data + data) == "trailing"


HEAD, VERT, COLR, DONE = contents_of(dumps(samples.grey()))
TRIS = contents_of(dumps(samples.listed()))[2]
NOTE, ICC = (b"note", b"text"), (b"iccp", zlib.compress(b"profile"))


@pytest.mark.parametrize(
    "contents",
    [
        [DONE],
        [HEAD, DONE],
        [HEAD, VERT, DONE],
        [HEAD, COLR, DONE],
        [VERT, COLR, DONE],
        [VERT, HEAD, COLR, DONE],
        [HEAD, COLR, VERT, DONE],
        [HEAD, HEAD, VERT, COLR, DONE],
        [HEAD, VERT, VERT, COLR, DONE],
        [HEAD, VERT, COLR, COLR, DONE],
        [HEAD, TRIS, VERT, COLR, DONE],
        [HEAD, VERT, COLR, TRIS, DONE],
        [HEAD, VERT, TRIS, TRIS, COLR, DONE],
        [HEAD, VERT, TRIS, DONE],
        [NOTE, HEAD, VERT, COLR, DONE],
        [HEAD, VERT, NOTE, COLR, DONE],
        [HEAD, VERT, COLR, NOTE, DONE],
        [HEAD, ICC, ICC, VERT, COLR, DONE],
        [HEAD, ICC, NOTE, ICC, VERT, COLR, DONE],
        [HEAD, (b"Note", b"text"), VERT, COLR, DONE],
        [HEAD, (b"EXIF", b"text"), VERT, COLR, DONE],
        [HEAD, VERT, COLR, (b"MORE", b""), DONE],
        [HEAD, (b"no e", b"text"), VERT, COLR, DONE],
        [HEAD, (b"not3", b"text"), VERT, COLR, DONE],
        [HEAD, (b"\xe9ote", b"text"), VERT, COLR, DONE],
        [HEAD, VERT, COLR, (b"DONE", b"\0")],
    ],
)
def test_chunks_that_are_missing_doubled_unknown_or_out_of_place_are_rejected(
    contents: list[tuple[bytes, bytes]],
) -> None:
    assert refusal(file_of(contents)) == "chunk"


def test_a_file_without_an_end_is_truncated() -> None:
    assert refusal(file_of([HEAD, VERT, COLR])) == "truncated"


def test_an_unknown_critical_chunk_is_named() -> None:
    with pytest.raises(FormatError, match="critical chunk Grid is unknown"):
        loads(file_of([HEAD, (b"Grid", b""), VERT, COLR, DONE]))


def test_a_length_beyond_any_file_is_rejected() -> None:
    data = dumps(samples.smallest())
    assert refusal(data[:12] + b"\xff\xff\xff\xff" + data[16:]) == "chunk"
    assert refusal(data[:12] + b"\xff\xff\xff\x7f" + data[16:]) == "truncated"


@pytest.mark.parametrize("version", [(0, 1), (1, 0), (0, 255), (255, 255)])
def test_a_newer_version_is_rejected_whatever_its_header_holds(version: tuple[int, int]) -> None:
    major, minor = version
    data = dumps(samples.grey())
    assert refusal(with_header(data, major=major, minor=minor)) == "version"
    assert refusal(with_content(data, b"HEAD", bytes(version))) == "version"
    # Such a file may hold chunks that only its own version knows.
    contents = contents_of(with_header(data, major=major, minor=minor))
    assert refusal(file_of([contents[0], (b"Grid", b""), (b"DONE", b"")])) == "version"
    with pytest.raises(FormatError, match=rf"version {major}\.{minor}"):
        loads(with_header(data, major=major, minor=minor))


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("width", 0),
        ("height", 0),
        ("subdivision", 9),
        ("subdivision", 255),
        ("n_components", 0),
        ("n_components", 2),
        ("n_components", 3),
        ("n_components", 255),
        ("n_vertices", 0),
        ("n_vertices", 3),
        ("n_vertices", 27 * 19 + 1),
        ("n_vertices", 2**32 - 1),
        ("n_triangles", 0),
        ("n_triangles", 1),
        ("n_triangles", 2**32 - 1),
        ("connectivity", 1),
        ("connectivity", 2),
        ("connectivity", 255),
    ],
)
def test_a_header_field_out_of_range_is_rejected(name: str, value: int) -> None:
    data = dumps(samples.grey())
    assert with_header(data, **{name: value}) != data
    assert refusal(with_header(data, **{name: value})) == "header"


def test_every_header_field_is_tried() -> None:
    assert len(contents_of(dumps(samples.grey()))[0][1]) == STEPS_OFFSET + 1
    assert len(HEADER_FIELDS) == 9


def test_a_lattice_too_large_for_exact_arithmetic_is_rejected() -> None:
    data = dumps(samples.grey())
    assert refusal(with_header(data, width=40_000, subdivision=4)) == "header"


def test_listed_triangles_in_a_file_of_implied_ones_are_rejected() -> None:
    assert refusal(with_header(dumps(samples.listed()), connectivity=0)) == "header"


def test_a_header_of_another_length_is_rejected() -> None:
    data = dumps(samples.grey())
    header = dict(contents_of(data))[b"HEAD"]
    for content in (*(header[:n] for n in range(2, len(header))), header + b"\1"):
        assert refusal(with_content(data, b"HEAD", content)) == "header"
    # Without a version it is no header at all.
    for content in (b"", header[:1]):
        assert refusal(with_content(data, b"HEAD", content)) == "chunk"


def test_a_step_of_zero_is_rejected() -> None:
    data = dumps(samples.color())
    header = dict(contents_of(data))[b"HEAD"]
    for at in range(STEPS_OFFSET, len(header)):
        changed = header[:at] + b"\0" + header[at + 1 :]
        assert refusal(with_content(data, b"HEAD", changed)) == "header"


def test_another_number_of_implied_triangles_is_rejected() -> None:
    data = dumps(samples.grey())
    n_triangles = samples.grey().n_triangles
    assert refusal(with_header(data, n_triangles=n_triangles - 1)) == "geometry"


@pytest.mark.parametrize(
    ("tag", "code"), [(b"VERT", "positions"), (b"TRIS", "triangles"), (b"COLR", "colors")]
)
def test_bytes_after_a_payload_are_rejected(tag: bytes, code: str) -> None:
    data = dumps(samples.listed())
    payload = dict(contents_of(data))[tag]
    assert refusal(with_content(data, tag, payload + bytes(9))) == code
    assert refusal(with_content(data, tag, payload + b"\1" * 9)) == code


def test_positions_without_the_corners_are_rejected() -> None:
    data = dumps(samples.grey())
    assert refusal(with_content(data, b"VERT", b"\x55" * 9)) in {"geometry", "positions"}
    # All zero bits: every box's points lie in its first half.
    assert refusal(with_content(data, b"VERT", b"\xff" * 9)) in {"geometry", "positions"}


def test_triangles_that_overlap_are_rejected() -> None:
    mesh = samples.listed()
    triangles = mesh.triangles.copy()
    # One triangle takes another corner: the file can say so, the mesh rules forbid it.
    triangles[0, 2] += 1
    payload = encode_triangles(triangles, mesh.n_vertices)
    assert refusal(with_content(dumps(mesh), b"TRIS", payload)) == "geometry"


def listed_in_order(triangles: Int32Array) -> bytes:
    """Payload of TRIS for triangles in any order of their second vertices."""
    coder = np.zeros(entropy.N_FIELDS, np.int64)
    data = np.zeros(1 << 12, np.uint8)
    odds = entropy.fresh_odds(3 * entropy.NUMBER_CONTEXTS)
    entropy.start(coder, data, 0)
    first = 0
    for a, b, c in triangles.tolist():
        for i, number in enumerate((a - first, b - a - 1, c - a - 1)):
            entropy.code_number(coder, data, odds, i * entropy.NUMBER_CONTEXTS, number)
        first = a
    return data[: entropy.finish(coder, data)].tobytes()


def test_triangles_out_of_order_are_rejected() -> None:
    data = dumps(samples.listed())
    triangles = samples.listed().triangles.copy()
    assert with_content(data, b"TRIS", listed_in_order(triangles)) == data
    assert triangles[0, 0] == triangles[1, 0]
    swapped = listed_in_order(triangles[[1, 0, *range(2, len(triangles))]])
    assert refusal(with_content(data, b"TRIS", swapped)) == "triangles"


# --- limits and metadata -----------------------------------------------------------------------


def test_limits_are_respected_to_the_unit() -> None:
    mesh = samples.with_metadata()
    data = dumps(mesh)
    n_bytes = len(b"profile" * 20) + len(b"exif\0\1") + len(b"<x:xmpmeta/>") + len(b"hello")
    exact = Limits(
        max_pixels=mesh.width * mesh.height, max_vertices=mesh.n_vertices, max_metadata=n_bytes
    )
    assert loads(data, limits=exact) == mesh
    for limits in (
        Limits(max_pixels=mesh.width * mesh.height - 1),
        Limits(max_vertices=mesh.n_vertices - 1),
        Limits(max_metadata=n_bytes - 1),
        Limits(max_metadata=0),
    ):
        with pytest.raises(LimitError):
            loads(data, limits=limits)


def test_a_huge_count_is_refused_before_anything_is_allocated() -> None:
    data = with_header(dumps(samples.grey()), width=60_000, height=60_000, n_vertices=2**31)
    with pytest.raises(FormatError, match="cannot hold"):
        loads(data)


def test_more_pixels_and_vertices_than_allowed_are_refused() -> None:
    data = with_header(dumps(samples.grey()), width=60_000, height=60_000)
    with pytest.raises(LimitError, match="pixels"):
        loads(data)
    with pytest.raises(LimitError, match="vertices"):
        loads(dumps(samples.grey()), limits=Limits(max_vertices=4))


def test_points_arranged_to_make_the_triangulation_slow_are_refused_in_time() -> None:
    # On a ray and on an arc beyond it, as the sweep meets them: flips grow with the square.
    n, side = 12_000, 1 << 19
    t = np.arange(1, n + 1) / n
    arc = np.stack([side / 2 + t * side / 2, side / 2 + t * t * side / 8], axis=1)
    ray = np.stack([side / 2 - t * side / 2 * 0.999, np.full(n, side / 2)], axis=1)
    corners = [[0, 0], [side, 0], [0, side], [side, side]]
    points = np.unique(
        np.concatenate([np.rint(arc), np.rint(ray), corners]).astype(np.int32), axis=0
    )
    vertices = np.ascontiguousarray(points[np.lexsort((points[:, 0], points[:, 1]))])
    with pytest.raises(LimitError, match="flips"):
        delaunay(vertices)


def test_limit_errors_are_not_format_errors() -> None:
    assert not issubclass(LimitError, FormatError)
    assert issubclass(FormatError, ValueError)


@pytest.mark.parametrize("tag", [b"iccp", b"exif", b"xmpp"])
def test_a_metadata_bomb_is_refused_at_the_limit(tag: bytes) -> None:
    bomb = (tag, zlib.compress(bytes(1 << 22), 9))
    assert len(bomb[1]) < 5000
    with pytest.raises(LimitError, match="metadata"):
        loads(file_of([HEAD, bomb, VERT, COLR, DONE]), limits=Limits(max_metadata=1 << 16))


def test_blocks_of_metadata_are_counted_together() -> None:
    blocks = [(tag, zlib.compress(bytes(900))) for tag in (b"iccp", b"exif", b"xmpp")]
    data = file_of([HEAD, *blocks, (b"note", bytes(900)), VERT, COLR, DONE])
    assert loads(data, limits=Limits(max_metadata=3600)).metadata.icc == bytes(900)
    with pytest.raises(LimitError):
        loads(data, limits=Limits(max_metadata=3599))


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"profile",
        zlib.compress(b""),
        zlib.compress(b"profile")[:-1],
        zlib.compress(b"profile") + b"\0",
        zlib.compress(b"profile") * 2,
        zlib.compress(b"profile")[:-4] + b"\0\0\0\0",
    ],
)
def test_metadata_that_are_not_one_whole_zlib_stream_are_rejected(content: bytes) -> None:
    assert refusal(file_of([HEAD, (b"iccp", content), VERT, COLR, DONE])) == "metadata"
