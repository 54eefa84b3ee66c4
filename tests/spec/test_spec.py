"""The specification, executed: its decoder, its dumps and its tables against the library."""

from __future__ import annotations

import re
import struct
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import vmesh
from vmesh.codec import layout
from vmesh.codec.payloads import encode_triangles
from vmesh.color_lattice import MAX_STEP
from vmesh.kernels import entropy
from vmesh.kernels.delaunay import delaunay
from vmesh.kernels.scanline import SUBPIXEL, cover, fill
from vmesh.mesh import MAX_LATTICE_SIDE, MAX_SIDE, MAX_SUBDIVISION, Mesh, Metadata

_ROOT: Final = Path(__file__).parents[2]
_TEXT: Final = (_ROOT / "spec" / "vmesh.md").read_text(encoding="utf-8")

Decoded = dict[str, Any]
Chunks = list[tuple[bytes, bytes]]


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


def mesh_of(
    width: int,
    height: int,
    n_components: int,
    *,
    n_vertices: int = 4,
    subdivision: int = 0,
    step: int = 1,
    metadata: Metadata | None = None,
) -> Mesh:
    """A Delaunay mesh with random vertices and colours."""
    random = np.random.default_rng(width + 100 * height + n_vertices)
    far_x, far_y = width << subdivision, height << subdivision
    sites = {(0, 0), (far_x, 0), (0, far_y), (far_x, far_y)}
    while len(sites) < n_vertices:
        sites.add((int(random.integers(far_x + 1)), int(random.integers(far_y + 1))))
    vertices = np.array(sorted(sites, key=lambda site: site[::-1]), dtype=np.int32)
    colors = random.integers(0, 256, (len(vertices), n_components))
    return Mesh.from_colors(
        width,
        height,
        vertices,
        delaunay(vertices),
        colors,
        step=step,
        subdivision=subdivision,
        metadata=metadata,
    )


def flipped(mesh: Mesh, n_flips: int) -> Mesh:
    """The mesh with the first inner edges of convex quads flipped, each in triangles of its own."""
    faces: list[tuple[int, ...]] = [tuple(face) for face in mesh.triangles.tolist()]
    owner = {}
    for t, (a, b, c) in enumerate(faces):
        owner[a, b], owner[b, c], owner[c, a] = (t, c), (t, a), (t, b)
    touched: set[int] = set()
    for (b, c), (t, a) in owner.items():
        u, d = owner.get((c, b), (t, a))
        if touched & {t, u} or t == u or len(touched) == 2 * n_flips:
            continue
        pair = mesh.replaced(triangles=np.array([(a, b, d), (a, d, c)], dtype=np.int32))
        if (pair.doubled_areas() > 0).all():
            faces[t], faces[u] = (a, b, d), (a, d, c)
            touched |= {t, u}
    assert len(touched) == 2 * n_flips
    return mesh.replaced(triangles=np.array(faces, dtype=np.int32)).canonical()


def picture(height: int, width: int, *components: int) -> Mesh:
    """What the encoder makes of noise."""
    noise = np.random.default_rng(1).integers(0, 256, (height, width, *components), dtype=np.uint8)
    return vmesh.encode(noise)


def grid(side: int) -> Mesh:
    """All sites of a square canvas: every circle holds four vertices."""
    return mesh_of(side, side, 1, n_vertices=(side + 1) ** 2)


_METADATA: Final = Metadata(
    icc=b"profile" * 40, exif=b"Exif\0\0", xmp=b"<x/>", unknown=((b"note", b""), (b"note", b"\0"))
)

MESHES: Final[dict[str, Callable[[], Mesh]]] = {
    "one pixel": lambda: picture(1, 1, 3),
    "one grey pixel": lambda: picture(1, 1),
    "two by three": lambda: picture(3, 2, 3),
    "rgb": lambda: picture(12, 16, 3),
    "grey": lambda: picture(12, 16),
    "rgba": lambda: picture(12, 16, 4),
    "four corners": lambda: mesh_of(5, 3, 3),
    "delaunay": lambda: mesh_of(16, 12, 3, n_vertices=70),
    "many ties": lambda: grid(9),
    "large counts": lambda: mesh_of(40, 30, 1, n_vertices=300),
    "no subdivision": lambda: mesh_of(16, 12, 4, n_vertices=40),
    "subdivision 1": lambda: mesh_of(16, 12, 4, n_vertices=40, subdivision=1),
    "subdivision 8": lambda: mesh_of(11, 13, 1, n_vertices=40, subdivision=8),
    "step 8": lambda: mesh_of(16, 12, 4, n_vertices=40, step=8),
    "step 255": lambda: mesh_of(8, 8, 3, n_vertices=30, step=255),
    "wide and flat": lambda: mesh_of(300, 1, 3, n_vertices=50, subdivision=2),
    "listed": lambda: flipped(mesh_of(16, 12, 3, n_vertices=70), 12),
    "listed, two triangles": lambda: flipped(mesh_of(5, 3, 1), 1),
    "metadata": lambda: mesh_of(4, 4, 3, n_vertices=9, metadata=_METADATA),
}


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
    known = ("iccp", mesh.metadata.icc), ("exif", mesh.metadata.exif), ("xmpp", mesh.metadata.xmp)
    unknown = [(tag.decode(), content) for tag, content in mesh.metadata.unknown]
    assert decoded["metadata"] == [(tag, block) for tag, block in known if block] + unknown


@pytest.mark.parametrize("name", MESHES)
def test_the_decoder_of_the_specification_agrees_with_the_library(name: str) -> None:
    data = vmesh.dumps(MESHES[name]())

    assert_same_mesh(decode(data), vmesh.loads(data))


@pytest.mark.parametrize("name", MESHES)
def test_the_renderer_of_the_specification_agrees_with_the_library(name: str) -> None:
    data = vmesh.dumps(MESHES[name]())
    mesh = vmesh.loads(data)
    raster = np.zeros((mesh.height, mesh.width, mesh.n_components), dtype=np.uint8)
    scaled = mesh.vertices.astype(np.int64) * (SUBPIXEL // mesh.unit)
    fill(scaled, mesh.triangles, mesh.colors, raster)

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


def test_the_flipped_meshes_have_listed_triangles_and_the_others_do_not() -> None:
    for name, make in MESHES.items():
        tags = [chunk.tag for chunk in layout.read_chunks(vmesh.dumps(make()))]
        assert (layout.TRIANGLES_TAG in tags) == name.startswith("listed"), name


def test_the_encoder_of_the_specification_writes_the_bytes_of_the_library() -> None:
    random = np.random.default_rng(7)
    contexts = random.integers(0, 5, 3000).tolist()
    bits = (random.random(3000) < np.array([0.5, 0.99, 0.01, 0.9, 0.0])[contexts]).tolist()
    encoder = SPEC["RangeEncoder"]()
    coder = np.zeros(entropy.N_FIELDS, dtype=np.int64)
    data = np.zeros(4096, dtype=np.uint8)
    odds = entropy.fresh_odds(5)
    entropy.start(coder, data, 0)
    for context, bit in zip(contexts, bits, strict=True):
        encoder.bit(int(bit), context)
        entropy.code_bit(coder, data, odds, context, int(bit))
    payload = encoder.payload()

    assert payload == data[: entropy.finish(coder, data)].tobytes()
    decoder = SPEC["RangeDecoder"](payload, "bits")
    assert [decoder.bit(context) for context in contexts] == bits
    decoder.end()


# Section 15: the dumps.


def bytes_of_dump(dump: str) -> bytes:
    """Bytes of an annotated dump: pairs of hex digits, comments from # on."""
    return bytes.fromhex("".join(line.partition("#")[0] for line in dump.splitlines()))


def corners_only(width: int, height: int, colors: list[int]) -> Mesh:
    vertices = np.array([(0, 0), (width, 0), (0, height), (width, height)], dtype=np.int32)
    return Mesh.from_colors(
        width, height, vertices, delaunay(vertices), np.array(colors)[:, np.newaxis]
    )


DUMPED: Final = [corners_only(2, 1, [0, 255, 0, 255]), corners_only(1, 1, [0, 0, 0, 0])]


def test_every_dump_is_the_file_of_its_picture() -> None:
    dumps = [bytes_of_dump(dump) for dump in blocks("hex")]

    assert [dump.hex(" ") for dump in dumps] == [vmesh.dumps(mesh).hex(" ") for mesh in DUMPED]
    for dump, mesh in zip(dumps, DUMPED, strict=True):
        assert_same_mesh(decode(dump), mesh)
    assert f"has {len(dumps[1])} bytes" in section(15)


def test_every_line_of_the_dumps_is_explained() -> None:
    for dump in blocks("hex"):
        assert all(re.search(r"# +\S", line) for line in dump.splitlines())


def test_the_pixels_of_the_annotated_file_are_as_stated() -> None:
    stated = re.search(r"the two pixels are (\d+) and (\d+)", section(15))
    assert stated

    rows = SPEC["render"](decode(vmesh.dumps(DUMPED[0])))
    assert rows == [[(int(stated[1]),), (int(stated[2]),)]]


def test_the_bits_of_the_annotated_file_are_as_stated(monkeypatch: pytest.MonkeyPatch) -> None:
    bits = {"positions": "", "colors": ""}

    read_bit = SPEC["RangeDecoder"].bit

    def record(decoder: Any, *context: object) -> int:
        bit: int = read_bit(decoder, *context)
        bits[decoder.name] += str(bit)
        return bit

    monkeypatch.setattr(SPEC["RangeDecoder"], "bit", record)
    decode(vmesh.dumps(DUMPED[0]))

    def digits(rows: list[list[str]], column: int) -> str:
        return "".join(re.sub(r"\D", "", row[column]) for row in rows)

    assert bits["positions"] == digits(table(section(15), "Box"), 3)
    assert bits["colors"] == digits(table(section(15), "Vertex"), 5)


# Section 12: the error codes, and files that bring them about.


def test_the_error_codes_are_those_of_the_library() -> None:
    sources = "\n".join(
        path.read_text(encoding="utf-8") for path in (_ROOT / "vmesh" / "codec").glob("*.py")
    )
    raised = set(re.findall(r'FormatError\(\s*"(\w+)"', sources))
    raised |= set(re.findall(r'_decode\([^"]*"(\w+)"', sources))

    assert {code for code, _ in table(section(12), "Code")} == raised
    stated = "\n".join(blocks("python"))
    named = re.findall(r'(?:require|Invalid|RangeDecoder)\(.*?"(\w+)"\)', stated, re.DOTALL)
    assert raised <= {*named, *re.findall(r'Invalid\("(\w+)" if', stated)}


def chunks_of(data: bytes) -> Chunks:
    return [(chunk.tag, chunk.content) for chunk in layout.read_chunks(data)]


_VALID: Final = vmesh.dumps(flipped(mesh_of(6, 5, 3, n_vertices=15, metadata=_METADATA), 2))


def rebuilt(**contents: bytes) -> bytes:
    """The valid file with other contents of some chunks, and correct checksums."""
    return layout.pack_file(
        (tag, contents.get(tag.decode(), content)) for tag, content in chunks_of(_VALID)
    )


def with_header(offset: int, code: str, *values: int) -> bytes:
    """The valid file with some bytes of its header replaced."""
    content = bytearray(dict(chunks_of(_VALID))[b"HEAD"])
    struct.pack_into(f"<{code}", content, offset, *values)
    return rebuilt(HEAD=bytes(content))


def rearranged(*tags: bytes) -> bytes:
    content = {**dict(chunks_of(_VALID)), b"note": b"", b"Crit": b""}
    return layout.pack_file((tag, content[tag]) for tag in tags)


def listed(mesh: Mesh, *triangles: tuple[int, int, int]) -> bytes:
    """A file of the mesh with listed triangles that need not make sense."""
    header = layout.Header(
        major=0,
        minor=0,
        width=mesh.width,
        height=mesh.height,
        subdivision=mesh.subdivision,
        n_components=mesh.n_components,
        n_vertices=mesh.n_vertices,
        n_triangles=len(triangles),
        connectivity=layout.LISTED_TRIANGLES,
        steps=mesh.lattice.steps,
    )
    payload = encode_triangles(np.array(triangles, dtype=np.int32), n_vertices=1000)
    content = {**dict(chunks_of(vmesh.dumps(mesh))), b"HEAD": header.pack(), b"TRIS": payload}
    return layout.pack_file((tag, content[tag]) for tag in (b"HEAD", *_TAIL))


def miscounted(mesh: Mesh, n_triangles: int) -> bytes:
    """The file of a Delaunay mesh that claims another number of triangles."""
    content = dict(chunks_of(vmesh.dumps(mesh)))
    header = content[b"HEAD"]
    content[b"HEAD"] = header[:12] + struct.pack("<I", n_triangles) + header[16:]
    return layout.pack_file(content.items())


def fan(side: int, x: int, y: int) -> Mesh:
    """The corners of a square canvas, 0, 1, 3, 4, around the vertex 2 at x, y."""
    vertices = np.array([(0, 0), (side, 0), (x, y), (0, side), (side, side)], dtype=np.int32)
    triangles = np.array([(0, 1, 2), (0, 2, 3), (1, 4, 2), (2, 4, 3)], dtype=np.int32)
    return Mesh.from_colors(side, side, vertices, triangles, [[5], [90], [200], [40], [250]])


_TAIL: Final = (b"VERT", b"TRIS", b"COLR", b"DONE")

DAMAGED: Final[dict[str, tuple[str, bytes]]] = {
    "nothing": ("truncated", b""),
    "a photograph": ("signature", b"\x89PNG\r\n\x1a\n" + bytes(40)),
    "line ends converted": ("signature", _VALID.replace(b"\r\n", b"\n")),
    "half a signature": ("truncated", _VALID[:5]),
    "only a signature": ("truncated", _VALID[:8]),
    "no end": ("truncated", _VALID[:-12]),
    "no last byte": ("truncated", _VALID[:-1]),
    "a byte more": ("trailing", _VALID + b"\0"),
    "a flipped bit": ("checksum", _VALID[:20] + bytes([_VALID[20] ^ 1]) + _VALID[21:]),
    "a tag with a digit": ("chunk", _VALID[:8] + b"HEA0" + _VALID[12:]),
    "a long chunk": ("chunk", _VALID[:8] + b"HEAD\xff\xff\xff\xff" + _VALID[16:]),
    "no header": ("chunk", rearranged(*_TAIL)),
    "two headers": ("chunk", rearranged(b"HEAD", b"HEAD", *_TAIL)),
    "no colours": ("chunk", rearranged(b"HEAD", b"VERT", b"TRIS", b"DONE")),
    "misordered": ("chunk", rearranged(b"HEAD", b"TRIS", b"VERT", b"COLR", b"DONE")),
    "a note too early": ("chunk", rearranged(b"note", b"HEAD", *_TAIL)),
    "a note too late": ("chunk", rearranged(b"HEAD", b"VERT", b"note", b"COLR", b"DONE")),
    "two profiles": ("chunk", rearranged(b"HEAD", b"iccp", b"iccp", *_TAIL)),
    "unknown and critical": ("chunk", rearranged(b"HEAD", b"Crit", *_TAIL)),
    "a full end": ("chunk", rebuilt(DONE=b"\0")),
    "an empty header": ("chunk", rebuilt(HEAD=b"")),
    "a short header": ("header", rebuilt(HEAD=bytes(16))),
    "major version 1": ("version", with_header(0, "B", 1)),
    "minor version 1": ("version", with_header(1, "B", 1)),
    "a version alone": ("version", rebuilt(HEAD=b"\1\0")),
    "no width": ("header", with_header(2, "H", 0)),
    "no height": ("header", with_header(4, "H", 0)),
    "subdivision 9": ("header", with_header(6, "B", 9)),
    "a huge lattice": ("header", with_header(2, "HHB", 5, 65535, 4)),
    "two components": ("header", with_header(7, "B", 2)),
    "four components": ("header", with_header(7, "B", 4)),
    "three vertices": ("header", with_header(8, "I", 3)),
    "too many vertices": ("header", with_header(8, "I", 43)),
    "one triangle": ("header", with_header(12, "I", 1)),
    "too many triangles": ("header", with_header(12, "I", 25)),
    "implied but listed": ("header", with_header(16, "B", 0)),
    "unknown connectivity": ("header", with_header(16, "B", 2)),
    "step 0": ("header", with_header(17, "B", 0)),
    "listed but not there": ("header", rearranged(b"HEAD", b"VERT", b"COLR", b"DONE")),
    "not deflated": ("metadata", rebuilt(iccp=b"profile")),
    "half a stream": ("metadata", rebuilt(iccp=zlib.compress(b"profile" * 9)[:-5])),
    "two streams": ("metadata", rebuilt(iccp=2 * zlib.compress(b"profile"))),
    "an empty profile": ("metadata", rebuilt(iccp=zlib.compress(b""))),
    "more positions": ("positions", rebuilt(VERT=dict(chunks_of(_VALID))[b"VERT"] + bytes(9))),
    "more triangles": ("triangles", rebuilt(TRIS=dict(chunks_of(_VALID))[b"TRIS"] + bytes(9))),
    "more colours": ("colors", rebuilt(COLR=dict(chunks_of(_VALID))[b"COLR"] + bytes(9))),
    "other positions": ("geometry", rebuilt(VERT=b"\xaa")),
    "other triangles": ("triangles", rebuilt(TRIS=b"")),
    "other colours": ("colors", rebuilt(COLR=b"")),
    "an unknown third vertex": ("triangles", listed(fan(2, 1, 1), (0, 1, 4), (0, 4, 5))),
    "an unknown second vertex": ("triangles", listed(fan(2, 1, 1), (0, 1, 4), (0, 5, 4))),
    "an unknown first vertex": ("triangles", listed(fan(2, 1, 1), (0, 1, 4), (5, 6, 7))),
    "fewer triangles": ("geometry", miscounted(fan(2, 1, 1), 3)),
    "a gap": ("geometry", listed(fan(2, 1, 1), (0, 1, 2), (0, 2, 3), (1, 4, 2))),
    "an overlap": ("geometry", listed(DUMPED[1], (0, 1, 3), (1, 3, 2))),
    "a fold": ("geometry", listed(fan(3, 2, 1), (0, 1, 4), (0, 2, 3), (0, 4, 2), (2, 4, 3))),
    "a line": ("geometry", listed(fan(2, 1, 1), (0, 1, 4), (0, 2, 3), (0, 4, 2), (2, 4, 3))),
    "a vertex within an edge": ("geometry", listed(fan(2, 1, 1), (0, 1, 4), (0, 2, 3), (2, 4, 3))),
    "covered twice": (
        "geometry",
        listed(
            mesh_of(2, 1, 1, n_vertices=6), (0, 1, 3), (0, 2, 3), (1, 2, 5), (1, 5, 3), (2, 5, 3)
        ),
    ),
}


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


def test_a_vertex_without_triangles_is_invalid() -> None:
    triangles = np.array([(0, 1, 4), (0, 4, 3)], dtype=np.int32)
    mesh = fan(2, 1, 1).replaced(triangles=triangles)
    chunks = {chunk.tag: chunk.content for chunk in layout.read_chunks(vmesh.dumps(fan(2, 1, 1)))}
    head = bytearray(chunks[b"HEAD"])
    head[12:17] = struct.pack("<IB", 2, layout.LISTED_TRIANGLES)
    data = layout.pack_file(
        [
            (b"HEAD", bytes(head)),
            (b"VERT", chunks[b"VERT"]),
            (b"TRIS", encode_triangles(mesh.triangles, mesh.n_vertices)),
            (b"COLR", b""),
            (b"DONE", b""),
        ]
    )

    assert code_of(decode, data) == code_of(vmesh.loads, data) == "geometry"


def test_the_damaged_files_show_every_code() -> None:
    assert {code for code, _ in DAMAGED.values()} == {
        code for code, _ in table(section(12), "Code")
    }


def test_every_truncation_has_the_same_code_by_specification_and_library() -> None:
    for length in range(len(_VALID)):
        code = code_of(vmesh.loads, _VALID[:length])
        assert code == "truncated"
        assert code_of(decode, _VALID[:length]) == code


@settings(max_examples=150)
@given(st.sampled_from([b"VERT", b"TRIS", b"COLR"]), st.binary(max_size=40))
@example(b"COLR", bytes(40))
@example(b"COLR", b"\xff" * 40)
def test_any_payload_means_the_same_to_specification_and_library(
    tag: bytes, payload: bytes
) -> None:
    data = rebuilt(**{tag.decode(): payload})

    code = code_of(decode, data)
    assert code == code_of(vmesh.loads, data)
    if code is None:
        assert_same_mesh(decode(data), vmesh.loads(data))


# The numbers in the tables.


def test_the_table_of_the_signature_spells_the_signature() -> None:
    values = "".join(value for _, value, _ in table(section(3), "Byte"))

    assert bytes.fromhex(values) == layout.SIGNATURE == SPEC["SIGNATURE"]


def test_the_table_of_the_header_matches_the_bytes_that_are_packed() -> None:
    rows = table(section(4), "Offset")
    header = layout.Header(1, 2, 3, 4, 5, 6, 7, 8, 9, steps=(10, 11, 12))
    content = header.pack()
    sizes = {"u8": 1, "u16": 2, "u32": 4}
    fields: list[int] = []
    place = 0
    for offset, kind, _, _ in rows[:-1]:
        assert int(offset) == place
        fields.append(int.from_bytes(content[place : place + sizes[kind]], "little"))
        place += sizes[kind]

    assert fields == list(range(1, 10))
    assert int(rows[-1][0]) == place == len(content) - 3
    assert f"`HEAD` is {place} bytes" in section(4)


def test_the_contexts_are_as_many_as_stated() -> None:
    stated = {payload: whole(text) for payload, text in table(section(5), "Payload")}

    assert stated == {
        "VERT": entropy.SPLIT_CONTEXTS,
        "TRIS": 3 * entropy.NUMBER_CONTEXTS,
        "COLR": entropy.COMPONENT_CONTEXTS,
    }


def test_the_limits_are_as_stated() -> None:
    limits = {name: whole(value) for name, value in table(section(13), "Limit")}

    assert limits == {
        "pixels a side": MAX_SIDE,
        "subdivision": MAX_SUBDIVISION,
        "lattice units a side": MAX_LATTICE_SIDE,
        "colour step": MAX_STEP,
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
    assert set(source_references()) >= {("layout.py", 3), ("layout.py", 4), ("payloads.py", 8)}
    for _, number in source_references():
        assert section(number)


def test_the_code_blocks_import_the_standard_library_only() -> None:
    imported = re.findall(r"^(?:import|from) (\w+)", "\n".join(blocks("python")), re.MULTILINE)

    assert set(imported) == {"struct", "zlib", "collections"}
