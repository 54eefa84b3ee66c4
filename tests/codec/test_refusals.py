from __future__ import annotations

import zlib
from collections.abc import Callable
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
from tests.codec.trial import try_file
from vmesh.arrays import Int32Array
from vmesh.codec.hierarchy import build_hierarchy
from vmesh.codec.mesh_coder import Encoder, Flips, encode
from vmesh.codec.reader import loads, read
from vmesh.codec.writer import dumps
from vmesh.color_lattice import ColorLattice
from vmesh.errors import FormatError, LimitError, VmeshError
from vmesh.kernels.coding import range_coder, triangle_list
from vmesh.kernels.delaunay import delaunay
from vmesh.limits import MAX_SIDE, Limits
from vmesh.mesh import Mesh


def refusal(data: bytes) -> str:
    """The code of the error that refuses a file."""
    with pytest.raises(FormatError) as caught:
        loads(data)
    assert 0 <= caught.value.offset <= len(data)
    assert f"code {caught.value.code}, at byte {caught.value.offset}" in str(caught.value)
    return caught.value.code


@pytest.mark.parametrize("name", samples.CASES)
def test_a_file_taken_apart_and_put_together_is_the_same_file(name: str) -> None:
    data = dumps(samples.CASES[name]())
    assert file_of(*split(data)) == data
    assert with_header(data) == data


@pytest.mark.parametrize("name", samples.CASES)
def test_every_truncation_is_rejected(name: str) -> None:
    data = dumps(samples.CASES[name]())
    for length in range(len(data)):
        assert refusal(data[:length]) == "truncated"


@pytest.mark.parametrize("name", ["smallest", "grey, flipped", "with metadata"])
def test_every_change_of_a_byte_is_rejected(name: str) -> None:
    data = dumps(samples.CASES[name]())
    for at in range(len(data)):
        for change in range(1, 256):
            changed = bytearray(data)
            changed[at] ^= change
            assert refusal(bytes(changed)) in {
                "signature", "version", "header", "chunk", "checksum", "truncated", "trailing",
            }  # fmt: skip


def outcome(data: bytes) -> str:
    """The code of the error that refuses a file, or that a valid mesh was loaded."""
    return try_file(data).code


@pytest.mark.parametrize("name", samples.CASES)
def test_every_truncation_of_a_coded_mesh_loads_as_a_valid_mesh_or_is_refused(name: str) -> None:
    data = dumps(samples.CASES[name]())
    content = split(data)[1][-1][1]
    lengths = range(len(content))
    codes = {outcome(with_content(data, b"M", content[:length])) for length in lengths}
    assert codes <= {"positions", "geometry", "colors", "triangles", "loaded"}


@pytest.mark.parametrize("name", samples.CASES)
def test_every_changed_byte_of_a_coded_mesh_loads_as_a_valid_mesh_or_is_refused(name: str) -> None:
    data = dumps(samples.CASES[name]())
    content = split(data)[1][-1][1]
    codes = set()
    for at in range(len(content)):
        for change in (1, 0xFF):
            changed = bytearray(content)
            changed[at] ^= change
            codes.add(outcome(with_content(data, b"M", bytes(changed))))
    assert codes <= {"positions", "geometry", "colors", "triangles", "loaded"}
    # A change of the last byte may mean the same; but hardly any two lists are both meshes.
    assert "loaded" in codes or "listed" in name


@pytest.mark.parametrize("name", samples.CASES)
def test_mutants_with_repaired_checksums_load_as_valid_meshes_or_are_refused(name: str) -> None:
    data = dumps(samples.CASES[name]())
    random = np.random.default_rng(len(data))
    outcomes = {outcome(mutant(data, random)) for _ in range(300)}
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
    with pytest.raises(FormatError, match="critical chunk Z is unknown"):
        loads(file_of(HEADER, [(b"Z", b""), MESH]))


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


@pytest.mark.parametrize("version", [0x00, 0x01, 0x0F, 0x20, 0xFF])
def test_another_version_is_rejected_whatever_its_header_holds(version: int) -> None:
    data = dumps(samples.grey())
    assert refusal(with_header(data, version=version)) == "version"
    assert refusal(SIGNATURE + bytes([version])) == "version"
    assert refusal(SIGNATURE + bytes([version]) + b"\xff" * 40) == "version"
    with pytest.raises(FormatError, match=rf"version {version >> 4}\.{version & 15}"):
        loads(with_header(data, version=version))


OUT_OF_RANGE = [
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
    ("connectivity", 3),
]


@pytest.mark.parametrize(("name", "value"), OUT_OF_RANGE)
def test_a_header_field_out_of_range_is_rejected(name: str, value: int) -> None:
    data = dumps(samples.grey())
    assert header_fields(data)[name] != value
    assert refusal(with_header(data, **{name: value})) == "header"


def test_every_header_field_is_tried() -> None:
    fields = header_fields(dumps(samples.grey()))
    assert fields.keys() == {*HEADER_FIELDS, *FORMAT_FIELDS}
    # Versions and numbers of components have tests of their own; the format is made of fields.
    apart = {"version", "components", "format"}
    assert {name for name, _ in OUT_OF_RANGE} == fields.keys() - apart
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
    header, contents = split(dumps(samples.grey()))
    deep = bytes([header[0], header[1] & ~3 | 1, 0b000101]) + header[2:] + b"\1"
    assert refusal(file_of(deep, contents)) == "header"


@pytest.mark.parametrize("name", ["RGB, implied", "RGB, flipped", "RGB, listed"])
@pytest.mark.parametrize("connectivity", [0, 1, 2])
def test_triangles_told_in_another_way_than_the_header_says_are_rejected(
    name: str, connectivity: int
) -> None:
    data = dumps(samples.CASES[name]())
    changed = with_header(data, connectivity=connectivity)
    assert outcome(changed) == "loaded" if changed == data else refusal(changed) in {
        "triangles", "colors",
    }  # fmt: skip


# --- the coded mesh ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "code"),
    [("RGB, implied", "colors"), ("RGB, flipped", "triangles"), ("RGB, listed", "triangles")],
)
def test_bytes_after_the_coded_mesh_are_rejected(name: str, code: str) -> None:
    data = dumps(samples.CASES[name]())
    content = split(data)[1][0][1]
    assert refusal(with_content(data, b"M", content + bytes(9))) == code
    assert refusal(with_content(data, b"M", content + b"\1" * 9)) == code


@pytest.mark.parametrize("name", ["RGB, implied", "RGBA, flipped", "RGB, listed"])
def test_a_mesh_that_is_cut_short_is_rejected_in_the_part_that_lacks_bytes(name: str) -> None:
    data = dumps(samples.CASES[name]())
    content = split(data)[1][0][1]
    sizes = read(data).sizes
    begin = 0
    for part, size in sizes.items():
        # Where a part lacks few bytes at its end, the zeros in their place may pass for it.
        lengths = range(begin + 1, min(begin + size, len(content)) - 8)
        codes = {refusal(with_content(data, b"M", content[:length])) for length in lengths}
        assert codes <= {part}
        begin += size


@given(st.binary(max_size=60))
def test_any_content_is_a_mesh_or_is_refused(content: bytes) -> None:
    with suppress(FormatError):
        loads(file_of(HEADER, [(b"M", content)])).check()


@given(st.data(), st.sampled_from(["flipped", "listed"]), st.binary(max_size=40))
def test_any_bytes_after_the_colors_are_triangles_or_are_refused(
    data: st.DataObject, connectivity: str, rest: bytes
) -> None:
    file = dumps(samples.CASES[f"grey, {connectivity}"]())
    content = split(file)[1][0][1]
    sizes = read(file).sizes
    length = data.draw(st.integers(sizes["positions"] + sizes["colors"], len(content)))
    code = outcome(with_content(file, b"M", content[:length] + rest))
    assert code in {"loaded", "colors", "triangles", "geometry"}
    assert (connectivity, code) != ("flipped", "geometry")


@pytest.mark.parametrize("connectivity", [0, 1, 2])
def test_positions_without_the_corners_are_rejected(connectivity: int) -> None:
    data = with_header(dumps(samples.grey()), connectivity=connectivity)
    for byte in (b"\x55", b"\xff"):
        assert refusal(with_content(data, b"M", byte * 30)) == "geometry"


def mesh_and_then(mesh: Mesh, write_triangles: Callable[[Encoder], None]) -> bytes:
    """Content of a mesh: its positions and colours, and triangles that need not make sense."""
    columns, rows = (side * mesh.unit + 1 for side in (mesh.width, mesh.height))
    hierarchy = build_hierarchy(mesh.vertices, delaunay(mesh.vertices))

    def write(encoder: Encoder) -> None:
        encoder.positions(mesh.vertices, columns, rows)
        encoder.levels(mesh.levels, hierarchy, mesh.lattice)
        write_triangles(encoder)

    return encode(write)


def listing(triangles: Int32Array) -> Callable[[Encoder], None]:
    """What writes a list of triangles, in whatever order, first vertices ascending."""

    def write(encoder: Encoder) -> None:
        model = range_coder.even_model(3 * triangle_list.NUMBER_CONTEXTS)
        first = 0
        for a, b, c in triangles.tolist():
            for i, number in enumerate((a - first, b - a - 1, c - a - 1)):
                context = i * triangle_list.NUMBER_CONTEXTS
                triangle_list.code_number(encoder.coder, encoder.data, model, context, number)
            first = a

    return write


def test_triangles_that_overlap_or_are_out_of_order_are_rejected() -> None:
    mesh = samples.listed()
    data = dumps(mesh)
    assert with_content(data, b"M", mesh_and_then(mesh, listing(mesh.triangles))) == data
    # One triangle takes another corner: the file can say so, the mesh rules forbid it.
    overlapping = mesh.triangles.copy()
    overlapping[0, 2] += 1
    assert overlapping[0, 2] < mesh.n_vertices
    content = mesh_and_then(mesh, listing(overlapping))
    assert refusal(with_content(data, b"M", content)) == "geometry"
    several = np.flatnonzero(mesh.triangles[1:, 0] == mesh.triangles[:-1, 0])[0]
    order = np.arange(mesh.n_triangles)
    order[several : several + 2] = several + 1, several
    content = mesh_and_then(mesh, listing(mesh.triangles[order]))
    assert refusal(with_content(data, b"M", content)) == "triangles"


def ones(encoder: Encoder) -> None:
    """Write bits after which a stream of zeros is read as nothing but ones."""
    model = range_coder.even_model(64)
    for context in range(64):
        range_coder.code_bit(encoder.coder, encoder.data, model, context, 1)


def test_more_flips_than_allowed_are_refused_and_do_not_go_on_for_ever() -> None:
    # A square with a vertex in it: every edge that can be flipped is flipped, again and again.
    mesh = samples.grey()
    content = mesh_and_then(mesh, ones) + bytes(2000)
    data = with_content(with_header(dumps(mesh), connectivity=2), b"M", content)
    with pytest.raises(FormatError, match="number out of range") as caught:
        loads(data)
    assert caught.value.code == "triangles"


def without_flips(mesh: Mesh) -> bytes:
    """A file of a mesh with Delaunay triangles that says of each edge that it is not flipped."""
    none = Flips(np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64))
    content = mesh_and_then(mesh, lambda encoder: encoder.flips(none, mesh.triangles, mesh))
    return with_content(with_header(dumps(mesh), connectivity=2), b"M", content)


@pytest.mark.parametrize("name", ["grey, implied", "RGB, implied", "RGBA, implied"])
def test_no_flips_at_all_are_as_good_as_implied_triangles(name: str) -> None:
    mesh = samples.CASES[name]()
    assert loads(without_flips(mesh)) == mesh


@pytest.mark.parametrize("name", ["RGB, implied", "RGB, flipped"])
def test_any_mesh_may_be_listed(name: str) -> None:
    mesh = samples.CASES[name]()
    content = mesh_and_then(mesh, listing(mesh.triangles))
    data = with_content(with_header(dumps(mesh), connectivity=1), b"M", content)
    assert loads(data) == mesh
    assert list(read(data).sizes) == ["positions", "colors", "triangles"]


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


def test_a_count_that_no_bytes_could_hold_is_refused() -> None:
    data = with_header(dumps(samples.grey()), width=60_000, height=60_000, n_vertices=2**31 - 1)
    with pytest.raises(FormatError, match="cannot hold"):
        loads(data)


def test_the_densest_mesh_is_as_large_as_its_bytes_can_hold() -> None:
    # All sites of the lattice and one colour: no bits for positions, hardly any for levels.
    y, x = np.mgrid[:401, :401]
    vertices = np.stack([x.ravel(), y.ravel()], axis=1).astype(np.int32)
    levels = np.zeros((len(vertices), 1), dtype=np.int32)
    mesh = Mesh(400, 400, vertices, delaunay(vertices), levels, ColorLattice((1,)))
    data = dumps(mesh)
    assert len(data) < 64
    assert loads(data, limits=Limits(max_vertices_per_byte=5_700)) == mesh
    with pytest.raises(FormatError, match="cannot hold"):
        loads(with_header(data, width=600, n_vertices=220_000))


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


def test_vertices_of_very_many_triangles_are_read_in_time() -> None:
    # Each vertex of the upper border is joined to a lower corner, half of them to either. A search
    # among all triangles of a corner for each of them would take the square of their number.
    k = MAX_SIDE
    vertices = np.array([*((x, 0) for x in range(k + 1)), (0, 1), (k, 1)], dtype=np.int32)
    mesh = Mesh(k, 1, vertices, delaunay(vertices), np.zeros((k + 3, 1), int), ColorLattice((1,)))
    assert np.bincount(mesh.triangles.ravel()).max() > k // 2
    data = without_flips(mesh)
    assert len(data) < 500
    assert loads(data) == mesh


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
