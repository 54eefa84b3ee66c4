from __future__ import annotations

import zlib
from contextlib import suppress

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.codec import samples
from tests.codec.damage import (
    FORMAT_FIELDS,
    HEADER_FIELDS,
    SIGNATURE,
    checked,
    chunk_of,
    file_of,
    header_fields,
    mutant,
    padded,
    split,
    varint,
    with_content,
    with_header,
)
from vmesh.arrays import Int32Array
from vmesh.codec.payloads import Encoder, encode
from vmesh.codec.reader import loads, measure
from vmesh.codec.writer import dumps
from vmesh.color_lattice import ColorLattice
from vmesh.errors import FormatError, LimitError, VmeshError
from vmesh.kernels import entropy
from vmesh.kernels.delaunay import delaunay
from vmesh.limits import Limits
from vmesh.mesh import Mesh

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


@pytest.mark.parametrize("sample", SAMPLES)
def test_a_file_taken_apart_and_put_together_is_the_same_file(sample: type) -> None:
    data = dumps(sample())
    assert file_of(*split(data)) == data
    assert with_header(data) == data


@pytest.mark.parametrize("sample", [samples.smallest, samples.listed, samples.with_metadata])
def test_every_truncation_is_rejected(sample: type) -> None:
    data = dumps(sample())
    for length in range(len(data)):
        assert refusal(data[:length]) == "truncated"


@pytest.mark.parametrize("sample", [samples.smallest, samples.with_metadata])
def test_every_change_of_a_byte_is_rejected(sample: type) -> None:
    data = dumps(sample())
    for at in range(len(data)):
        for change in range(1, 256):
            changed = bytearray(data)
            changed[at] ^= change
            assert refusal(bytes(changed)) in {
                "signature", "version", "header", "chunk", "checksum", "truncated", "trailing",
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
        loads(SIGNATURE + data)


@given(st.lists(st.tuples(st.sampled_from([b"i", b"n", b"M"]), st.binary())))
def test_any_chunks_after_a_header_load_or_are_refused(chunks: list[tuple[bytes, bytes]]) -> None:
    with suppress(VmeshError):
        loads(file_of(HEADER, chunks)).check()


@pytest.mark.parametrize(
    "start",
    [
        b"\x89PNG\r\n\x1a\n",
        b"\x0bVM\r\n",  # passed through seven bits
        b"\x8bVM\n",  # line ends converted
        b"\x8bVM\r\r\n",
        b"\x8bVMS\r\n\x1a\n",  # draft 0
        b"VM",
        b"\0",
    ],
)
def test_another_signature_is_rejected(start: bytes) -> None:
    assert refusal(start + dumps(samples.smallest())[len(SIGNATURE) :]) == "signature"


# The header and the chunk of a grey mesh, and chunks that may come before it.
HEADER, (MESH,) = split(dumps(samples.grey()))
NOTE, ICC = (b"n", b"text"), (b"i", zlib.compress(b"profile"))


def test_the_parts_of_the_next_tests_are_a_valid_file() -> None:
    assert loads(file_of(HEADER, [NOTE, ICC, NOTE, MESH])).metadata.icc == b"profile"


@pytest.mark.parametrize(
    "contents",
    [
        [ICC, ICC, MESH],
        [ICC, NOTE, ICC, MESH],
        [(b"N", b"text"), MESH],
        [(b"E", b"text"), MESH],
        [(b"m", b""), (b"Z", b""), MESH],
        [(b" ", b"text"), MESH],
        [(b"3", b"text"), MESH],
        [(b"\xe9", b"text"), MESH],
        [(b"\0", b""), MESH],
        [(b"@", b""), MESH],
        [(b"`", b""), MESH],
        [(b"{", b""), MESH],
    ],
)
def test_chunks_that_are_doubled_unknown_or_no_chunks_are_rejected(
    contents: list[tuple[bytes, bytes]],
) -> None:
    assert refusal(file_of(HEADER, contents)) == "chunk"


@pytest.mark.parametrize("contents", [[], [NOTE], [ICC, NOTE], [ICC, (b"m", MESH[1])]])
def test_a_file_without_a_mesh_is_truncated(contents: list[tuple[bytes, bytes]]) -> None:
    assert refusal(file_of(HEADER, contents)) == "truncated"


@pytest.mark.parametrize("rest", [b"\0", MESH[1], chunk_of(*MESH), chunk_of(*ICC)])
def test_what_follows_the_mesh_is_rejected(rest: bytes) -> None:
    assert refusal(file_of(HEADER, [MESH]) + rest) == "trailing"


def test_an_unknown_critical_chunk_is_named() -> None:
    with pytest.raises(FormatError, match="critical chunk G is unknown"):
        loads(file_of(HEADER, [(b"G", b""), MESH]))


def test_a_damaged_chunk_is_told_before_its_tag_is_judged() -> None:
    # A bit of the tag turns an ICC profile into an unknown critical chunk.
    start = checked(SIGNATURE + HEADER)
    chunk = bytearray(chunk_of(*ICC))
    chunk[0] ^= 0x20
    assert refusal(start + bytes(chunk) + chunk_of(*MESH)) == "checksum"


@pytest.mark.parametrize(
    ("length", "code"),
    [
        (varint(2**31 - 1), "truncated"),
        (varint(2**31), "chunk"),
        (varint(2**35 - 1), "chunk"),
        (varint(2**35), "chunk"),
        (b"\x80" * 9, "chunk"),
        (b"\x80" * 4, "truncated"),
        (padded(len(MESH[1])), "chunk"),
        (padded(0), "chunk"),
    ],
)
def test_a_length_that_is_too_long_or_not_in_its_shortest_form_is_rejected(
    length: bytes, code: str
) -> None:
    start = checked(SIGNATURE + HEADER)
    rest = b"" if code == "truncated" else checked(b"M" + length + MESH[1])[1 + len(length) :]
    assert refusal(start + b"M" + length + rest) == code


@pytest.mark.parametrize("version", [0x00, 0x02, 0x10, 0x11, 0xFF])
def test_another_version_is_rejected_whatever_its_header_holds(version: int) -> None:
    data = dumps(samples.grey())
    assert refusal(with_header(data, version=version)) == "version"
    assert refusal(SIGNATURE + bytes([version])) == "version"
    assert refusal(SIGNATURE + bytes([version]) + b"\xff" * 40) == "version"
    with pytest.raises(FormatError, match=rf"version {version >> 4}\.{version & 15}"):
        loads(with_header(data, version=version))


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("width", 0),
        ("width", 65_536),
        ("height", 0),
        ("height", 2**31 - 1),
        ("height", 2**31),
        ("height", 2**35),
        ("subdivision", 9),
        ("subdivision", 15),
        ("n_vertices", 0),
        ("n_vertices", 3),
        ("n_vertices", 27 * 19 + 1),
        ("n_vertices", 2**31 - 1),
        ("n_vertices", 2**32),
        ("connectivity", 2),
        ("connectivity", 3),
    ],
)
def test_a_header_field_out_of_range_is_rejected(name: str, value: int) -> None:
    data = dumps(samples.grey())
    assert header_fields(data)[name] != value
    assert refusal(with_header(data, **{name: value})) == "header"


def test_every_header_field_is_tried() -> None:
    fields = header_fields(dumps(samples.grey()))
    assert fields.keys() == {*HEADER_FIELDS, *FORMAT_FIELDS}
    assert len(HEADER) == 2 + sum(len(varint(fields[name])) for name in HEADER_FIELDS[2:]) + 1


def test_a_number_of_the_header_that_is_not_in_its_shortest_form_is_rejected() -> None:
    fields = header_fields(dumps(samples.grey()))
    numbers = [fields[name] for name in HEADER_FIELDS[2:]]
    for longer in range(3):
        form = [padded(n) if i == longer else varint(n) for i, n in enumerate(numbers)]
        assert refusal(file_of(HEADER[:2] + b"".join(form) + HEADER[-1:], [MESH])) == "header"


def test_a_damaged_header_is_told_before_its_fields_are_judged() -> None:
    data = bytearray(dumps(samples.grey()))
    data[len(SIGNATURE) + len(HEADER) - 1] = 0  # the step
    assert refusal(bytes(data)) == "checksum"


def test_a_lattice_too_large_for_exact_arithmetic_is_rejected() -> None:
    data = dumps(samples.grey())
    assert refusal(with_header(data, width=40_000, subdivision=4)) == "header"


def test_a_step_of_zero_is_rejected() -> None:
    data = dumps(samples.color())
    for steps in (b"\0\1\1", b"\1\0\1", b"\1\1\0"):
        assert refusal(with_header(data, steps)) == "header"


def test_two_components_are_rejected() -> None:
    assert refusal(with_header(dumps(samples.grey()), b"\1\1", components=1)) == "header"


def test_triangles_that_are_said_to_be_listed_or_implied_wrongly_are_rejected() -> None:
    for sample, connectivity in ((samples.grey, 1), (samples.listed, 0)):
        data = with_header(dumps(sample()), connectivity=connectivity)
        assert refusal(data) in {"triangles", "colors"}


# --- the coded mesh ----------------------------------------------------------------------------


def test_bytes_after_the_coded_mesh_are_rejected() -> None:
    data = dumps(samples.listed())
    content = split(data)[1][0][1]
    assert refusal(with_content(data, b"M", content + bytes(9))) == "colors"
    assert refusal(with_content(data, b"M", content + b"\1" * 9)) == "colors"


def test_a_mesh_that_is_cut_short_is_rejected_in_the_part_that_lacks_bytes() -> None:
    data = dumps(samples.listed())
    content = split(data)[1][0][1]
    _, sizes = measure(data)
    lengths = range(len(content) - 8)
    codes = [refusal(with_content(data, b"M", content[:length])) for length in lengths]
    ends = np.cumsum(list(sizes.values()))
    # Where a part lacks few bytes at its end, the zeros in their place may pass for that part.
    assert set(codes[: ends[0] - 8]) == {"positions"}
    assert set(codes[ends[0] + 1 : ends[1] - 8]) == {"triangles"}
    assert set(codes[ends[1] + 1 :]) == {"colors"}


@given(st.binary(max_size=60))
def test_any_content_is_a_mesh_or_is_refused(content: bytes) -> None:
    with suppress(FormatError):
        loads(file_of(HEADER, [(b"M", content)])).check()


def test_positions_without_the_corners_are_rejected() -> None:
    data = dumps(samples.grey())
    for byte in (b"\x55", b"\xff"):
        assert refusal(with_content(data, b"M", byte * 30)) == "geometry"


def content_of(vertices: Int32Array, triangles: Int32Array, header: bytes) -> bytes:
    """Positions and triangles, which need not make sense, on the canvas of a header."""
    canvas = header_fields(file_of(header, []))
    columns, rows = ((canvas[side] << canvas["subdivision"]) + 1 for side in ("width", "height"))

    def write(encoder: Encoder) -> None:
        encoder.positions(vertices, columns, rows)
        odds = entropy.fresh_odds(3 * entropy.NUMBER_CONTEXTS)
        first = 0
        for a, b, c in triangles.tolist():
            for i, number in enumerate((a - first, b - a - 1, c - a - 1)):
                context = i * entropy.NUMBER_CONTEXTS
                entropy.code_number(encoder.coder, encoder.data, odds, context, number)
            first = a

    return encode(write)


def test_triangles_that_overlap_or_are_out_of_order_are_rejected() -> None:
    mesh = samples.listed()
    data = dumps(mesh)
    header = split(data)[0]
    with_colors = split(data)[1][0][1]
    content = content_of(mesh.vertices, mesh.triangles, header)
    assert with_colors[: len(content) - 4] == content[:-4]
    # One triangle takes another corner: the file can say so, the mesh rules forbid it.
    overlapping = mesh.triangles.copy()
    overlapping[0, 2] += 1
    assert overlapping[0, 2] < mesh.n_vertices
    content = content_of(mesh.vertices, overlapping, header)
    assert refusal(with_content(data, b"M", content)) == "geometry"
    assert mesh.triangles[0, 0] == mesh.triangles[1, 0]
    swapped = mesh.triangles[[1, 0, *range(2, mesh.n_triangles)]]
    content = content_of(mesh.vertices, swapped, header)
    assert refusal(with_content(data, b"M", content)) == "triangles"


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
    data = with_header(dumps(samples.grey()), width=60_000, height=60_000, n_vertices=2**31 - 1)
    with pytest.raises(FormatError, match="cannot hold"):
        loads(data)


def test_the_densest_mesh_is_as_large_as_its_bytes_can_hold() -> None:
    # All sites of the lattice and one colour: no bits for positions, the longest odds for levels.
    y, x = np.mgrid[:401, :401]
    vertices = np.stack([x.ravel(), y.ravel()], axis=1).astype(np.int32)
    levels = np.zeros((len(vertices), 1), dtype=np.int32)
    mesh = Mesh(400, 400, vertices, delaunay(vertices), levels, ColorLattice((1,)))
    data = dumps(mesh)
    assert len(data) < 60
    assert loads(data) == mesh
    with pytest.raises(FormatError, match="cannot hold"):
        loads(with_header(data, width=500, n_vertices=200_000))


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


@pytest.mark.parametrize("tag", [b"i", b"e", b"x"])
def test_a_metadata_bomb_is_refused_at_the_limit(tag: bytes) -> None:
    bomb = (tag, zlib.compress(bytes(1 << 22), 9))
    assert len(bomb[1]) < 5000
    with pytest.raises(LimitError, match="metadata"):
        loads(file_of(HEADER, [bomb, MESH]), limits=Limits(max_metadata=1 << 16))


def test_blocks_of_metadata_are_counted_together() -> None:
    blocks = [(tag, zlib.compress(bytes(900))) for tag in (b"i", b"e", b"x")]
    data = file_of(HEADER, [*blocks, (b"n", bytes(900)), MESH])
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
    assert refusal(file_of(HEADER, [(b"i", content), MESH])) == "metadata"
