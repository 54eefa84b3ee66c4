"""The specification, executed: its decoder, its dumps and its tables against the library."""

from __future__ import annotations

import re
import zlib
from collections.abc import Callable, Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import vmesh
from tests.codec.damage import (
    header_fields,
    split,
    varint,
    with_content,
)
from tests.spec.recipes import (
    DAMAGED,
    DUMPED,
    IMPLIED,
    LIST,
    MESHES,
    VALID,
    corners_only,
    mesh_of,
)
from tests.strategies import meshes
from vmesh.arrays import Int32Array
from vmesh.codec import layout
from vmesh.codec.hierarchy import Hierarchy
from vmesh.codec.mesh_coder import Decoder, Encoder, encode
from vmesh.color_lattice import ColorLattice
from vmesh.kernels.coding import colors, flips, positions, range_coder, triangle_list
from vmesh.kernels.scanline import SUBPIXEL, cover
from vmesh.limits import MAX_DEPTH, MAX_LATTICE_SIDE, MAX_SIDE, MAX_SUBDIVISION, MAX_TILE_SIDE
from vmesh.mesh import Mesh, Metadata

_ROOT: Final = Path(__file__).parents[2]
_TEXT: Final = (_ROOT / "spec" / "vmesh.md").read_text(encoding="utf-8")

Decoded = dict[str, Any]


def blocks(language: str) -> list[str]:
    """Code blocks of the specification in one language."""
    return re.findall(rf"^```{language}\n(.*?)^```$", _TEXT, re.DOTALL | re.MULTILINE)


def section(number: int) -> str:
    """Text of one numbered section."""
    found = re.search(rf"^## {number}\. .*?(?=^## |\Z)", _TEXT, re.DOTALL | re.MULTILINE)
    assert found
    return found[0]


def table(text: str, first_heading: str) -> list[list[str]]:
    """Cells of the rows of the table whose first column has this heading."""
    _, _, rest = text.partition(f"| {first_heading} |")
    rows = []
    for line in rest.splitlines()[2:]:
        if not line.startswith("|"):
            break
        rows.append([cell.strip().strip("`") for cell in line.strip("|").split("|")])
    assert rows
    return rows


def whole(text: str) -> int:
    """The last number of a text, with commas between thousands."""
    return int(re.findall(r"\d[\d,]*", text)[-1].replace(",", ""))


def program() -> str:
    """The Python blocks, on the lines on which they stand in the specification."""
    language = ""
    lines = []
    for line in _TEXT.splitlines():
        fence = line.startswith("```")
        lines.append(line if language == "python" and not fence else "")
        if fence:
            language = "" if language else line[3:]
    return "\n".join(lines)


SPEC: Final[dict[str, Any]] = {"__name__": "spec"}
exec(compile(program(), "spec/vmesh.md", "exec"), SPEC)


def decode(data: bytes) -> Decoded:
    mesh: Decoded = SPEC["decode"](data)
    return mesh


def assert_same_mesh(decoded: Decoded, mesh: Mesh) -> None:
    assert decoded["width"] == mesh.width
    assert decoded["height"] == mesh.height
    assert decoded["subdivision"] == mesh.subdivision
    assert np.array_equal(decoded["vertices"], mesh.vertices)
    assert np.array_equal(decoded["triangles"], mesh.triangles)
    assert np.array_equal(decoded["colors"], mesh.colors)
    known = ("i", mesh.metadata.icc), ("e", mesh.metadata.exif), ("x", mesh.metadata.xmp)
    unknown = [(tag.decode(), content) for tag, content in mesh.metadata.unknown]
    assert decoded["steps"] == mesh.lattice.steps
    assert np.array_equal(decoded["levels"], mesh.levels)
    assert decoded["metadata"] == [(tag, block) for tag, block in known if block] + unknown


@pytest.mark.parametrize("name", MESHES)
def test_the_decoder_of_the_specification_agrees_with_the_library(name: str) -> None:
    data = vmesh.dumps(MESHES[name]())

    assert_same_mesh(decode(data), vmesh.loads(data))


@pytest.mark.parametrize("name", MESHES)
def test_the_renderer_of_the_specification_agrees_with_the_library(name: str) -> None:
    data = vmesh.dumps(MESHES[name]())
    mesh = vmesh.loads(data)
    raster = vmesh.render(mesh).reshape(mesh.height, mesh.width, mesh.n_components)

    assert SPEC["render"](decode(data)) == [
        [tuple(pixel) for pixel in row] for row in raster.tolist()
    ]


@pytest.mark.parametrize("name", ["grey", "many ties", "subdivision 1"])
def test_each_centre_is_in_the_same_triangle_by_specification_and_library(name: str) -> None:
    # Neighbours agree on the colour of their edge: a picture does not show who drew it.
    mesh = MESHES[name]()
    decoded = decode(vmesh.dumps(mesh))
    scaled = mesh.vertices.astype(np.int64) * (SUBPIXEL // mesh.unit)
    for triangle in decoded["triangles"]:
        counts = np.zeros((mesh.height, mesh.width), dtype=np.uint8)
        cover(scaled, np.array([triangle], dtype=np.int32), counts)
        rows = SPEC["render"]({**decoded, "triangles": [triangle]})
        assert [[pixel is not None for pixel in row] for row in rows] == (counts == 1).tolist()


@pytest.mark.parametrize("name", MESHES)
def test_the_meshes_tell_their_triangles_as_their_names_say(name: str) -> None:
    connectivity = header_fields(vmesh.dumps(MESHES[name]()))["connectivity"]

    assert connectivity == (1 if "listed" in name else 2 if "flipped" in name else 0)


@settings(max_examples=60)
@given(meshes())
def test_any_mesh_means_the_same_to_specification_and_library(mesh: Mesh) -> None:
    assert_same_mesh(decode(vmesh.dumps(mesh)), mesh)


def test_the_encoder_of_the_specification_writes_the_bytes_of_the_library() -> None:
    random = np.random.default_rng(7)
    contexts = random.integers(0, 5, 3000).tolist()
    bits = (random.random(3000) < np.array([0.5, 0.99, 0.01, 0.9, 0.0])[contexts]).tolist()
    by_specification = SPEC["RangeEncoder"]()
    starts = [None, 2048, 63488, 43690, None]
    model = range_coder.even_model(5)
    for context, start in enumerate(starts):
        if start:
            model[context] = start, positions.SPLIT_SEEN

    def write(encoder: Encoder) -> None:
        for context, bit in zip(contexts, bits, strict=True):
            range_coder.code_bit(encoder.coder, encoder.data, model, context, int(bit))

    for context, bit in zip(contexts, bits, strict=True):
        by_specification.bit(int(bit), context, start=starts[context])
    content = by_specification.content()

    assert content == encode(write)
    decoder = SPEC["RangeDecoder"](content)
    assert [decoder.bit(context, start=starts[context]) for context in contexts] == bits
    decoder.end()


def read_start(data: bytes) -> Decoded | str:
    """What the specification makes of a file that was cut off: a mesh or the code of an error."""
    try:
        mesh: Decoded = SPEC["decode_start"](data)
    except SPEC["Invalid"] as error:
        return str(error.code)
    return mesh


@pytest.mark.parametrize(
    "name",
    [
        "one pixel",
        "two by three",
        "no subdivision",
        "flipped",
        "flipped, ties",
        "listed",
        "metadata",
    ],
)
def test_the_start_of_a_file_means_the_same_to_specification_and_library(name: str) -> None:
    data = vmesh.dumps(MESHES[name]())
    n_pictures = 0
    for length in {*range(0, len(data), 1 + len(data) // 40)} | {*range(len(data) - 8, len(data))}:
        expected = read_start(data[:length])
        if isinstance(expected, str):
            with pytest.raises(vmesh.FormatError) as caught:
                vmesh.loads(data[:length], allow_partial=True)
            assert caught.value.code == expected
        else:
            with pytest.warns(vmesh.PartialFileWarning):
                mesh = vmesh.loads(data[:length], allow_partial=True)
            assert np.array_equal(expected["vertices"], mesh.vertices)
            assert np.array_equal(expected["triangles"], mesh.triangles)
            assert np.array_equal(expected["levels"], mesh.levels)
            n_pictures += 1
    assert n_pictures > 4  # Without its last bytes, the checksum, nothing is missing.


class Script:
    """Stands for a decoder: writes the bits that a function wants, and returns them."""

    is_whole, ended = True, False

    def __init__(self, wanted: Callable[[int], int]) -> None:
        self.wanted = wanted
        self.encoder = SPEC["RangeEncoder"]()
        self.n_bits = 0
        self.part = ""

    def bit(self, *context: object, start: int | None = None) -> int:
        bit = self.wanted(self.n_bits)
        self.n_bits += 1
        self.encoder.bit(bit, *context, start=start)
        return bit


@pytest.mark.parametrize("more", [-1, 0, 1])
def test_as_many_flips_as_half_edges_are_read_and_no_more(more: int) -> None:
    mesh = mesh_of(6, 5, 1, n_vertices=15)
    vertices, triangles = mesh.vertices.tolist(), mesh.triangles.tolist()
    n_flips = mesh.triangles.size + more
    script = Script(lambda n_bits: int(n_bits < n_flips))

    def by_specification() -> object:
        return SPEC["read_flips"](script, vertices, triangles, mesh.levels[:, 0].tolist())

    def by_library() -> object:
        decoder = Decoder(script.encoder.content() + bytes(1000), 0)
        flips = decoder.flips(mesh.vertices, mesh.triangles, mesh.levels)
        return [tuple(face) for face in flips.tolist()]

    if more > 0:
        with pytest.raises(SPEC["Invalid"]):
            by_specification()
        with pytest.raises(vmesh.FormatError, match="out of range"):
            by_library()
    else:
        assert by_specification() == by_library()


def test_the_size_of_a_difference_has_the_same_bound_by_specification_and_library() -> None:
    most = 14 + 16
    assert SPEC["read_size"](Script(lambda i: int(i != most)), 0, 0) == 2**17 + 12
    with pytest.raises(SPEC["Invalid"]):
        SPEC["read_size"](Script(lambda i: 1), 0, 0)


def assert_same_levels(levels: Int32Array, around: list[list[int]], depth: int = 8) -> None:
    """Both read the levels of vertices in order, each between parents before it, as written."""
    n, n_components = levels.shape
    starts = np.cumsum([0, *map(len, around)])
    parents = np.array([u for own in around for u in own], dtype=np.int32)
    hierarchy = Hierarchy(np.arange(n, dtype=np.int32), starts, parents)
    lattice = ColorLattice((1,) * n_components, depth)
    content = encode(lambda encoder: encoder.levels(levels, hierarchy, lattice))
    assert np.array_equal(Decoder(content, 0).levels(hierarchy, lattice), levels)
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(SPEC, "hierarchy", lambda *_: enumerate(around))
        decoder = SPEC["RangeDecoder"](content)
        read = SPEC["read_levels"](decoder, [(0, 0)] * n, [], lattice.steps, depth)
    assert read == levels.tolist()


@given(
    st.integers(0, 2**32 - 1),
    st.sampled_from([1, 3, 4]),
    st.sampled_from([2, 30, 256, 1100, 65_536]),
)
def test_levels_between_any_parents_mean_the_same_to_specification_and_library(
    seed: int, n_components: int, n_levels: int
) -> None:
    random = np.random.default_rng(seed)
    around = [random.permutation(i)[: random.integers(1, 21)].tolist() for i in range(50)]
    levels = random.integers(0, n_levels, (50, n_components), dtype=np.int32)
    levels[:, 1:3] *= random.choice([-1, 1], levels[:, 1:3].shape)
    assert_same_levels(levels, around, 8 if n_levels <= 256 else 16)


@pytest.mark.parametrize("share", range(21))
def test_means_on_the_thresholds_lean_the_same_way_by_specification_and_library(share: int) -> None:
    # Of twenty parents a share has the level 6 and the others 5: a twentieth each from 5 to 6.
    # Above are the vertices between them, below some whose mean is whole, so that their signs
    # differ if the leans do.
    parents = [6] * share + [5] * (20 - share)
    levels = np.array([*parents, *[9, 2] * 20], dtype=np.int32)[:, np.newaxis]
    chain = [[i - 1] if i else [] for i in range(20)]
    assert_same_levels(levels, [*chain, *[list(range(20)), [0]] * 20])


def test_both_encoders_cut_no_more_than_four_zeros() -> None:
    # Ones keep the low end of the interval at 0; a hundred halvings shift it by twelve bytes.
    by_specification = SPEC["RangeEncoder"]()
    model = range_coder.even_model(100)

    def write(encoder: Encoder) -> None:
        for context in range(100):
            range_coder.code_bit(encoder.coder, encoder.data, model, context, 1)

    for context in range(100):
        by_specification.bit(1, context)

    assert by_specification.content() == encode(write) == bytes(12)


# Section 15: the dumps.


def bytes_of_dump(dump: str) -> bytes:
    """Bytes of an annotated dump: pairs of hex digits, comments from # on."""
    return bytes.fromhex("".join(line.partition("#")[0] for line in dump.splitlines()))


def test_every_dump_is_the_file_of_its_picture() -> None:
    dumps = [bytes_of_dump(dump) for dump in blocks("hex")]

    assert [dump.hex(" ") for dump in dumps] == [vmesh.dumps(mesh).hex(" ") for mesh in DUMPED]
    for dump, mesh in zip(dumps, DUMPED, strict=True):
        assert_same_mesh(decode(dump), mesh)
    assert f"has {min(map(len, dumps))} bytes" in section(15)


def test_every_line_of_the_dumps_is_explained() -> None:
    for dump in blocks("hex"):
        assert all(re.search(r"# +\S", line) for line in dump.splitlines())


def test_the_pixels_of_the_annotated_file_are_as_stated() -> None:
    stated = re.search(r"the two pixels are (\d+) and (\d+)", section(15))
    assert stated

    rows = SPEC["render"](decode(vmesh.dumps(DUMPED[0])))
    assert rows == [[(int(stated[1]),), (int(stated[2]),)]]


def test_the_bits_of_the_annotated_file_are_as_stated(monkeypatch: pytest.MonkeyPatch) -> None:
    bits = {"positions": "", "colors": "", "triangles": ""}

    read_bit = SPEC["RangeDecoder"].bit

    def record(decoder: Any, *context: object, start: int | None = None) -> int:
        bit: int = read_bit(decoder, *context, start=start)
        bits[decoder.part] += str(bit)
        return bit

    monkeypatch.setattr(SPEC["RangeDecoder"], "bit", record)
    decode(vmesh.dumps(DUMPED[1]))

    def digits(rows: list[list[str]], column: int) -> str:
        return "".join(re.sub(r"\D", "", row[column]) for row in rows)

    assert bits["positions"] == digits(table(section(15), "Box"), 3)
    assert bits["colors"] == digits(table(section(15), "Vertex"), 5)
    stated = re.search(r"comes one bit, `(\d)`", section(15))
    assert stated
    assert bits["triangles"] == stated[1]


# Section 12: the error codes, and files that bring them about.


def test_the_error_codes_are_those_of_the_library() -> None:
    sources = "\n".join(
        path.read_text(encoding="utf-8") for path in (_ROOT / "vmesh" / "codec").glob("*.py")
    )
    raised = set(re.findall(r'FormatError\(\s*"(\w+)"', sources))
    raised |= set(re.findall(r'(?:_end|read_varint)\([^"]*"(\w+)"', sources))

    assert {code for code, _ in table(section(12), "Code")} == raised
    stated = "\n".join(blocks("python"))
    named = re.findall(r'(?:require|Invalid)\(.*?"(\w+)"\)', stated, re.DOTALL)
    named += re.findall(r'Invalid\("(\w+)" if', stated)
    named += re.findall(r'decoder\.part = "(\w+)"', stated)
    assert raised <= set(named)


def code_of(read: Callable[[bytes], object], data: bytes) -> str | None:
    """Code of the rule that a file breaks, None if it is valid."""
    try:
        read(data)
    except (SPEC["Invalid"], vmesh.FormatError) as error:
        code: str = error.code
        return code
    return None


@pytest.mark.parametrize("name", DAMAGED)
def test_a_damaged_file_has_the_same_code_by_specification_and_library(name: str) -> None:
    code, data = DAMAGED[name]

    assert code_of(decode, data) == code
    assert code_of(vmesh.loads, data) == code


def test_the_damaged_files_show_every_code() -> None:
    assert {code for code, _ in DAMAGED.values()} == {
        code for code, _ in table(section(12), "Code")
    }


def test_every_truncation_has_the_same_code_by_specification_and_library() -> None:
    for length in range(len(VALID)):
        code = code_of(vmesh.loads, VALID[:length])
        assert code == "truncated"
        assert code_of(decode, VALID[:length]) == code


@settings(max_examples=300)
@given(st.sampled_from([VALID, LIST, IMPLIED]), st.integers(0, 200), st.binary(max_size=40))
@example(VALID, 0, bytes(40))
@example(VALID, 0, b"\xff" * 40)
@example(VALID, 200, b"\0")
@example(LIST, 200, b"\0")
@example(IMPLIED, 200, b"\0")
def test_any_coded_mesh_means_the_same_to_specification_and_library(
    valid: bytes, length: int, rest: bytes
) -> None:
    data = with_content(valid, b"M", split(valid)[1][-1][1][:length] + rest)

    code = code_of(decode, data)
    assert code == code_of(vmesh.loads, data)
    if code is None:
        assert_same_mesh(decode(data), vmesh.loads(data))


# The numbers in the tables.


def test_the_table_of_the_signature_spells_the_signature() -> None:
    values = "".join(value for _, value, _ in table(section(3), "Byte"))

    assert bytes.fromhex(values) == layout.SIGNATURE == SPEC["SIGNATURE"]


def test_the_tables_of_the_header_match_the_bytes_that_are_packed() -> None:
    rows = table(section(4), "Bytes")
    values = {"width": 300, "height": 20_000, "n": 127}
    header = layout.Header(300, 20_000, 3, 1, 127, steps=(4, 300, 6), depth=12)
    packed = header.pack()[len(layout.SIGNATURE) :]
    place = 0
    for size, kind, field, _ in rows:
        if kind == "varint":
            lowest, _, highest = size.partition(" to ")
            coded = varint(values[re.findall("width|height|n", field)[0]])
            assert int(lowest) <= len(coded) <= int(highest)
        elif kind == "c varints":
            coded = b"".join(map(varint, header.steps))
            assert size == "c or more"
        elif size == "0 or 1":
            coded = packed[place : place + 1]
            assert kind == "u8"
        else:
            coded = packed[place : place + int(size)]
            assert len(coded) == {"u8": 1, "u32": 4}[kind]
        assert packed[place : place + len(coded)] == coded
        place += len(coded)
    assert place == len(packed)
    assert rows[0][3].startswith(f"{packed[0] >> 4}.{packed[0] & 15}, ")
    form = {"number": 1, "subdivision": 3, "connectivity": 1}
    deep = {"number": header.n_components - 1, "depth": 12 - 8, "none": 0}
    texts = section(4).split("a byte follows it")
    for byte, stored, text in zip(packed[1:3], (form, deep), texts, strict=True):
        for bits, field, _ in table(text, "Bits"):
            first, *_, last = re.findall(r"\d", bits)
            mask = (1 << int(last) - int(first) + 1) - 1
            assert byte >> int(first) & mask == stored[re.split(r"\W", field)[0]]


def frame_of(data: bytes) -> int:
    """Bytes of a file that are not the content of a chunk."""
    return len(data) - sum(len(content) for _, content in split(data)[1])


@pytest.mark.parametrize("name", MESHES)
def test_the_frame_is_as_long_as_stated(name: str) -> None:
    mesh = MESHES[name]().replaced(metadata=Metadata())
    data = vmesh.dumps(mesh)
    chunks = split(data)[1]
    constant = re.search(r"(\d+) \+ V\(width\) .* \+ V\(each of the c steps\)", section(3))
    tiles = re.search(r"(\d+) \+ V\(length of `T`\) of each tile and (\d+) of `G`", section(3))
    assert constant
    assert tiles
    of_chunk, of_grid = int(tiles[1]), int(tiles[2])

    numbers = (mesh.width, mesh.height, mesh.n_vertices, *mesh.lattice.steps)
    counted = sum(len(varint(number)) for number in numbers)
    coded = [len(content) for tag, content in chunks if tag != b"G"]
    counted += sum(of_chunk + len(varint(length)) for length in coded)
    counted += (len(chunks) - len(coded)) * of_grid
    assert frame_of(data) == int(constant[1]) - of_chunk + (mesh.depth != 8) + counted


def test_the_examples_of_the_frame_are_as_stated() -> None:
    text = " ".join(section(3).split())
    black = corners_only(768, 512, [0, 0, 0, 0])
    levels = np.zeros((4, 3), dtype=np.int32)
    data = vmesh.dumps(black.replaced(levels=levels, lattice=ColorLattice((1, 1, 1))))
    assert f"these are {frame_of(data)} bytes; the whole file has {len(data)}" in text
    found = re.search(r"With ([\d,]+) vertices and ([\d,]+) bytes of mesh .* has (\d+) bytes", text)
    assert found
    n_vertices, length, frame = (whole(number) for number in found.groups())
    header = layout.Header(768, 512, 1, 0, n_vertices, steps=(8, 12, 10))
    assert len(layout.pack_file(header, [(b"M", bytes(length))])) - length == frame


def test_the_levels_that_a_byte_may_hold_are_as_many_as_the_probabilities_allow() -> None:
    least = min(-np.log2(1 - 64 / 65536), -np.log2(65472 / 65536))
    stated = re.search(r"no bit takes less than ([\d.]+) bits", section(4))
    assert stated
    assert 0.99 < float(stated[1]) / least < 1
    assert 8 / float(stated[1]) < 5700
    assert "5,700 for each byte" in section(4)


def test_the_contexts_are_as_many_as_stated() -> None:
    stated = {part: whole(text) for part, text in table(section(5), "Part")}

    assert stated == {
        "positions": positions.SPLIT_CONTEXTS,
        "colours": colors.COMPONENT_CONTEXTS,
        "flipped triangles": flips.FLIP_CONTEXTS,
        "listed triangles": 3 * triangle_list.NUMBER_CONTEXTS,
    }


def test_the_probabilities_at_the_start_are_as_stated() -> None:
    model = positions.initial_split_model()
    for count, stated in table(section(6), "Count"):
        shares = [int(share) for share in stated.split(", ")]
        assert shares == [SPEC["binomial_share"](int(count), i) for i in range(int(count))]
        for area in range(positions.N_AREA_CLASSES):
            first = (area * positions.N_SMALL + int(count)) * positions.N_SMALL
            own = model[first : first + int(count)]
            assert own[:, 0].tolist() == ([2048] * int(count) if area < 2 else shares)
            assert set(own[:, 1].tolist()) == {16}
    assert len(table(section(6), "Count")) == positions.N_SMALL - 1
    assert SPEC["SPREADS"] == colors.SPREADS
    assert SPEC["ANGLES"] == flips.ANGLES
    assert tuple(map(tuple, SPEC["MORE_THAN"])) == colors.LEVEL_PRIORS
    assert np.ravel(SPEC["FLIPPED"]).tolist() == list(flips.FLIP_PRIORS)


def test_no_number_is_larger_than_stated() -> None:
    sizes = {(section, name.split(",")[0]): bound for section, name, bound in widths()}
    far = 2**19
    square = [(0, 0), (far, 0), (far, far), (0, far)]
    cross, in_circle = SPEC["cross"], SPEC["in_circle"]
    # The centre of the largest circle is a corner's; nine parents, half of them at either end.
    largest = {
        ("6.1", "lattice sites of a box"): (far + 1) ** 2,
        ("6.2", "doubled area of three vertices"): cross(*square[:3]),
        ("6.2", "in-circle determinant"): abs(in_circle(*square[:3], (far // 2, far // 2))),
        ("7.3", "sum of the weights"): 9 * 4096,
        ("7.3", "sum of weight times level"): 9 * 4096 * 65_535,
        ("7.4", "sum of weight times deviation times deviation"): 9 * 4096 * 511**2,
        ("7.4", "numerator of the variance"): 1024 * 511**2 * (9 * 4096) ** 2,
        ("8.2", "cotangent in sixteenths"): 16 * 2 * far**2,
    }
    assert largest.keys() < sizes.keys()
    for key, value in largest.items():
        assert value < sizes[key], key


def widths() -> Iterator[tuple[str, str, int]]:
    """Section, name and bound of the quantities that need the most bits."""
    for number, name, bound in table(section(2), "Section"):
        power = re.search(r"2\*\*(\d+)$", bound)
        assert power
        yield number, name, 2 ** int(power[1])


def test_the_layers_hold_as_few_vertices_as_stated() -> None:
    mesh = mesh_of(40, 30, 1, n_vertices=300)
    vertices = [(int(x), int(y)) for x, y in mesh.vertices]
    sizes: list[int] = []
    triangulate = SPEC["delaunay"]

    def record(vertices: list[tuple[int, int]], *far: int) -> object:
        sizes.append(len(vertices))
        return triangulate(vertices, *far)

    implied = triangulate(vertices, 40, 30)
    SPEC["delaunay"] = record
    try:
        SPEC["hierarchy"](vertices, implied, 40, 30)
    finally:
        SPEC["delaunay"] = triangulate
    sizes.insert(0, len(vertices))
    assert all(b <= 4 + 19 * (a - 4) // 20 for a, b in pairwise(sizes))
    assert sizes[-1] == 4
    assert sum(sizes) < 4 * len(vertices)


def test_the_limits_are_as_stated() -> None:
    limits = {name: whole(value) for name, value in table(section(13), "Limit")}

    assert limits == {
        "pixels a side": MAX_SIDE,
        "subdivision": MAX_SUBDIVISION,
        "lattice units a side": MAX_LATTICE_SIDE,
        "bits of a sample": MAX_DEPTH,
        "colour step": (1 << MAX_DEPTH) - 1,
        "side of a tile": MAX_TILE_SIDE,
        "coded flips for each half-edge": flips.MAX_FLIPS,
        "bytes in a chunk": 2**31 - 1,
    }


def test_the_check_value_of_the_crc_is_right() -> None:
    assert f"{zlib.crc32(b'123456789'):08x}" in section(3)


def source_references() -> Iterator[tuple[str, int]]:
    """Sections of the specification that the sources name."""
    for path in (_ROOT / "vmesh").rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        for found in re.findall(r"spec, sections? ([\d, and to]+)\)", text):
            yield from ((path.name, int(number)) for number in re.findall(r"\d+", found))


def test_the_sections_that_the_sources_name_are_there() -> None:
    assert set(source_references()) >= {("layout.py", 3), ("layout.py", 4), ("mesh_coder.py", 8)}
    for _, number in source_references():
        assert section(number)


def test_the_code_blocks_import_the_standard_library_only() -> None:
    imported = re.findall(r"^(?:import|from) (\w+)", "\n".join(blocks("python")), re.MULTILINE)

    assert set(imported) == {"struct", "zlib", "collections", "math"}
