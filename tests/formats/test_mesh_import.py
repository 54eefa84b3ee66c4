"""Meshes that other programs wrote, and files that are damaged, hostile or no such mesh."""

from __future__ import annotations

import json
import struct
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest

import vmesh
from tests.codec import samples
from vmesh.codec.text import mesh_text

Rows = Sequence[Sequence[object]]

SQUARE: Final[Rows] = [
    (0, 0, 0, 10, 20, 30),
    (4, 0, 0, 10, 20, 30),
    (0, 4, 0, 99, 99, 99),
    (4, 4, 0, 255, 0, 0),
]
HALVES: Final[Rows] = [(0, 1, 2), (1, 3, 2)]
COLORS: Final = "".join(f"property uchar {name}\n" for name in ("red", "green", "blue"))


def ply(
    vertices: Rows = SQUARE,
    faces: Rows = HALVES,
    *,
    n_vertices: int | None = None,
    n_faces: int | None = None,
    colors: str = COLORS,
    kind: str = "ascii",
) -> bytes:
    """A PLY file with text for its body, unless it is cut off here."""
    header = (
        f"ply\nformat {kind} 1.0\ncomment by another program\n"
        f"element vertex {len(vertices) if n_vertices is None else n_vertices}\n"
        "property float x\nproperty float y\nproperty float z\n"
        f"{colors}element face {len(faces) if n_faces is None else n_faces}\n"
        "property list uchar int vertex_indices\nend_header\n"
    )
    if kind != "ascii":
        return header.encode("ascii")
    rows = [*vertices, *((len(face), *face) for face in faces)]
    return (header + "".join(" ".join(map(str, row)) + "\n" for row in rows)).encode("ascii")


def binary_ply(order: str, faces: Rows = HALVES, n_vertices: int | None = None) -> bytes:
    """A binary PLY file, little-endian for "<" and big-endian for ">"."""
    kind = {"<": "binary_little_endian", ">": "binary_big_endian"}[order]
    body = b"".join(struct.pack(f"{order}3f3B", *vertex) for vertex in SQUARE)
    body += b"".join(struct.pack(f"{order}B3i", 3, *face) for face in faces)
    return ply(faces=faces, n_vertices=n_vertices, kind=kind) + body


def obj(vertices: Rows = SQUARE, faces: Rows = ((1, 2, 3), (2, 4, 3)), more: str = "") -> bytes:
    """An OBJ file with colours from 0 to 1."""
    lines = [(*v[:3], *(float(str(x)) / 255 for x in v[3:])) for v in vertices]
    text = "".join("v " + " ".join(map(str, line)) + "\n" for line in lines) + more
    return (text + "".join("f " + " ".join(map(str, face)) + "\n" for face in faces)).encode()


def glb(folder: Path, change: Callable[[dict[str, Any]], object] = lambda tree: None) -> bytes:
    """A glTF file of ours with a change of its JSON."""
    path = folder / "ours.glb"
    vmesh.export(read(folder, "square.ply", ply()), path)
    data = path.read_bytes()
    (size,) = struct.unpack_from("<I", data, 12)
    tree = json.loads(data[20 : 20 + size])
    change(tree)
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    rest = data[20 + size :]
    head = struct.pack("<II4s", 20 + len(text) + len(rest), len(text), b"JSON")
    return data[:8] + head + text + rest


def read(folder: Path, name: str, data: bytes, **options: Any) -> vmesh.Mesh:
    """What is imported of a file with these bytes."""
    (folder / name).write_bytes(data)
    return vmesh.import_mesh(folder / name, **options)


@pytest.fixture
def square(tmp_path: Path) -> vmesh.Mesh:
    return read(tmp_path, "square.ply", ply())


def test_y_points_up_and_triangles_may_turn_either_way(tmp_path: Path) -> None:
    mesh = read(tmp_path, "mesh.ply", ply(faces=[(0, 1, 2), (2, 3, 1)]))
    assert (mesh.width, mesh.height, mesh.subdivision) == (4, 4, 0)
    assert mesh.vertices.tolist() == [[0, 0], [4, 0], [0, 4], [4, 4]]
    assert mesh.colors.tolist() == [[99, 99, 99], [255, 0, 0], [10, 20, 30], [10, 20, 30]]


@pytest.mark.parametrize(
    ("name", "data"),
    [
        ("little-endian.ply", binary_ply("<")),
        ("big-endian.ply", binary_ply(">")),
        ("quad.ply", ply(faces=[(0, 1, 3, 2)])),
        ("plain.obj", obj()),
        ("quad.obj", obj(faces=[(1, 2, 4, 3)])),
        ("from-the-end.obj", obj(faces=[(-4, -3, -2), (-3, -1, -2)])),
        ("normals.obj", obj(faces=[("1//1", "2//1", "3//1"), ("2//2", "4//2", "3//2")],
                            more="vn 0 0 1\nvn 0 0.1 1\n")),
        ("other-letters.obj", b"# caf\xe9\nmtllib /etc/hostname\n" + obj()),
    ],
)  # fmt: skip
def test_what_other_programs_write_is_the_same_mesh(
    name: str, data: bytes, square: vmesh.Mesh, tmp_path: Path
) -> None:
    mesh = read(tmp_path, name, data)
    assert mesh.n_triangles == 2  # of which a quad has one diagonal or the other
    assert (mesh.vertices == square.vertices).all()
    assert (mesh.colors == square.colors).all()


def test_a_size_or_a_scale_says_how_large_a_unit_is(tmp_path: Path) -> None:
    small = [(float(str(x)) / 8 - 7, float(str(y)) / 16 + 3, *rest) for x, y, *rest in SQUARE]
    for options, size in (
        ({"scale": 100}, (50, 25)),
        ({"width": 300}, (300, 150)),
        ({"height": 300}, (600, 300)),
        ({"width": 30, "height": 40}, (30, 40)),
        ({}, (1, 1)),
    ):
        mesh = read(tmp_path, "small.ply", ply(small), **options)
        assert (mesh.width, mesh.height) == size
        assert mesh.subdivision == 0
        assert mesh.covers_canvas


def test_vertices_come_on_the_coarsest_lattice_that_has_them_or_the_finest(tmp_path: Path) -> None:
    for x, subdivision in ((2, 0), (2.5, 1), (2.0625, 4), (2.1, 8)):
        middle = [*SQUARE, (x, 2, 0, 1, 2, 3)]
        faces = [(0, 1, 4), (1, 3, 4), (3, 2, 4), (2, 0, 4)]
        mesh = read(tmp_path, "mesh.ply", ply(middle, faces))
        assert mesh.subdivision == subdivision
        assert abs(mesh.points[2, 0] - x) <= 1 / 512


def test_vertices_that_agree_are_one(square: vmesh.Mesh, tmp_path: Path) -> None:
    split = [SQUARE[i] for i in (0, 1, 2, 1, 3, 2)]
    assert read(tmp_path, "split.ply", ply(split, [(0, 1, 2), (3, 4, 5)])) == square


def test_a_step_rounds_the_colours(tmp_path: Path) -> None:
    mesh = read(tmp_path, "mesh.ply", ply(), step=8)
    assert mesh.lattice == vmesh.ColorLattice.uniform(3, 8)


def test_a_scene_places_its_surfaces(square: vmesh.Mesh, tmp_path: Path) -> None:
    def put_two_side_by_side(tree: dict[str, Any]) -> None:
        tree["nodes"] = [{"mesh": 0, "scale": [1, 2, 1]}, {"mesh": 0, "matrix": MOVED}]
        tree["scenes"] = [{"nodes": [0, 1]}]

    MOVED = [-1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1, 0, 8, 0, 0, 1]  # mirrored, at x = 8
    mesh = read(tmp_path, "two.glb", glb(tmp_path, put_two_side_by_side))
    assert (mesh.width, mesh.height, mesh.n_vertices, mesh.n_triangles) == (8, 8, 6, 4)


@pytest.mark.parametrize("kind", ["<f4", "<u1", "<u2"])
def test_colours_of_gltf_may_be_of_any_kind(kind: str, tmp_path: Path) -> None:
    linear = np.array([[0, 0, 0, 1], [1, 1, 1, 1], [0.5, 0, 0, 1], [0.2, 0, 0, 1]])
    largest = 1.0 if kind == "<f4" else float(np.iinfo(kind).max)
    values = (linear * largest).round(4 if kind == "<f4" else 0).astype(kind)

    def replace(tree: dict[str, Any]) -> None:
        index = tree["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"]
        codes = {"<f4": 5126, "<u1": 5121, "<u2": 5123}
        tree["accessors"][index] |= {
            "componentType": codes[kind], "bufferView": len(tree["bufferViews"])
        }  # fmt: skip
        tree["bufferViews"].append(
            {
                "buffer": 0,
                "byteOffset": tree["buffers"][0]["byteLength"],
                "byteLength": values.nbytes,
            }
        )

    data = glb(tmp_path, replace) + values.tobytes()
    (size,) = struct.unpack_from("<I", data, 12)
    start = 20 + size  # of the binary chunk, which grows
    (length,) = struct.unpack_from("<I", data, start)
    data = data[:start] + struct.pack("<I", length + values.nbytes) + data[start + 4 :]
    reds = sorted(read(tmp_path, "mesh.glb", data).colors[:, 0].tolist())
    assert reds[0] == 0
    assert reds[3] == 255
    assert np.abs(np.array(reds[1:3]) - [124, 188]).max() <= 1


PALETTE: Final = [(10, 20, 30), (255, 0, 128), (0, 0, 0), (1, 250, 99)]
CODES: Final = {"uchar": "B", "ushort": "H", "short": "h", "int": "i", "float": "f", "double": "d"}


def coloured_ply(
    order: str,
    kind: str,
    largest: float,
    *,
    names: Sequence[str] = ("red", "green", "blue"),
    alpha: tuple[str, float] | None = None,
) -> bytes:
    """A PLY file with the palette in a type and a range; binary if it has an order."""
    kinds = ["float"] * 3 + [kind] * 3 + ([alpha[0]] if alpha else [])
    properties = [*"xyz", *names, *(["alpha"] if alpha else [])]
    form = {"": "ascii", "<": "binary_little_endian", ">": "binary_big_endian"}[order]
    header = f"ply\nformat {form} 1.0\nelement vertex 4\n"
    header += "".join(f"property {k} {p}\n" for k, p in zip(kinds, properties, strict=True))
    header += "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
    rows = []
    for (x, y, z, *_), color in zip(SQUARE, PALETTE, strict=True):
        values = [c / 255 * largest for c in color]
        values += [0.5 * alpha[1]] if alpha else []
        cells = zip(kinds[3:], values, strict=True)
        rows.append([x, y, z, *(v if k in ("float", "double") else round(v) for k, v in cells)])
    faces = [[3, *face] for face in HALVES]
    if not order:
        return (header + "".join(" ".join(map(str, row)) + "\n" for row in rows + faces)).encode()
    vertex = order + "".join(CODES[k] for k in kinds)
    body = b"".join(struct.pack(vertex, *row) for row in rows)
    return header.encode() + body + b"".join(struct.pack(f"{order}B3i", *row) for row in faces)


def palette_of(mesh: vmesh.Mesh) -> list[tuple[int, ...]]:
    """Red, green and blue of the corners, in the order of `SQUARE`."""
    # In the file y points up.
    return [tuple(mesh.plain_colors[i, :3].tolist()) for i in (2, 3, 0, 1)]


@pytest.mark.parametrize("order", ["", "<", ">"])
@pytest.mark.parametrize(
    ("kind", "largest"),
    [
        ("uchar", 255), ("ushort", 255), ("ushort", 65535), ("short", 255), ("int", 255),
        ("float", 1), ("float", 255), ("double", 1), ("double", 255),
    ],
)  # fmt: skip
@pytest.mark.parametrize("alpha", [None, ("uchar", 255), ("float", 1), ("ushort", 65535)])
def test_the_range_of_colours_in_ply_is_found(
    order: str, kind: str, largest: float, alpha: tuple[str, float] | None, tmp_path: Path
) -> None:
    mesh = read(tmp_path, "mesh.ply", coloured_ply(order, kind, largest, alpha=alpha))
    assert palette_of(mesh) == PALETTE
    assert mesh.n_components == (4 if alpha else 3)
    if alpha:
        assert np.abs(mesh.plain_colors[:, 3].astype(int) - 127).max() <= 1


@pytest.mark.parametrize("order", ["", "<", ">"])
@pytest.mark.parametrize("names", [("diffuse_red", "diffuse_green", "diffuse_blue"), tuple("rgb")])
def test_colours_in_ply_have_names_of_several_kinds(
    order: str, names: Sequence[str], tmp_path: Path
) -> None:
    mesh = read(tmp_path, "mesh.ply", coloured_ply(order, "uchar", 255, names=names))
    assert palette_of(mesh) == PALETTE


@pytest.mark.parametrize("order", ["", "<", ">"])
@pytest.mark.parametrize("n_tags", [0, 2])
def test_faces_of_ply_may_have_several_numbers_of_corners(
    order: str, n_tags: int, tmp_path: Path
) -> None:
    ring = [(0, 0), (2, 0), (3, 0), (4, 0), (4, 4), (0, 4), (3, 1)]
    rows = [(x, y, 0, 10 * x, 10 * y, 0) for x, y in ring]
    # A pentagon, a quad and triangles; the pentagon's first corner sees all others.
    faces = [(6, 3, 4), (5, 0, 1, 6), (6, 4, 5), (1, 2, 6), (2, 3, 6)]
    if not order:
        text = ply(rows, faces)
        assert read(tmp_path, "mesh.ply", text).n_triangles == 6
        return
    header = ply(rows, faces, kind="binary").decode()
    header = header.replace(
        "binary", {"<": "binary_little_endian", ">": "binary_big_endian"}[order]
    )
    header = header.replace(
        "end_header", "".join(f"property uchar t{i}\n" for i in range(n_tags)) + "end_header"
    )
    vertices = b"".join(struct.pack(f"{order}3f3B", *row) for row in rows)
    body = b"".join(
        struct.pack(f"{order}B{len(f)}i{n_tags}B", len(f), *f, *[1] * n_tags) for f in faces
    )
    mesh = read(tmp_path, "mesh.ply", header.encode() + vertices + body)
    assert mesh == read(tmp_path, "text.ply", ply(rows, faces))
    with pytest.raises(vmesh.MeshError, match="damaged"):
        read(tmp_path, "cut.ply", header.encode() + vertices + body[:-6])


@pytest.mark.parametrize("largest", [1, 255])
@pytest.mark.parametrize("separator", [" ", "\t", "  "])
@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_the_range_of_colours_in_obj_is_found(
    largest: int, separator: str, end: str, tmp_path: Path
) -> None:
    lines = [
        separator.join(map(str, ("v", x, y, z, *(c if largest == 255 else c / 255 for c in color))))
        for (x, y, z, *_), color in zip(SQUARE, PALETTE, strict=True)
    ]
    text = end.join([*lines, "f 1 2 3", "f -3 -1 -2", ""])
    assert palette_of(read(tmp_path, "mesh.obj", text.encode())) == PALETTE


def of_gltf(folder: Path, factor: float) -> vmesh.Mesh:
    """What is imported of a glTF file whose white is another number."""
    ours = vmesh.Mesh.from_colors(
        4,
        4,
        [(0, 0), (4, 0), (0, 4), (4, 4)],
        [(0, 1, 2), (1, 3, 2)],
        np.full((4, 3), 255, np.uint8),
    )
    vmesh.export(ours, folder / "white.glb")
    data = (folder / "white.glb").read_bytes()
    (size,) = struct.unpack_from("<I", data, 12)
    tree = json.loads(data[20 : 20 + size])
    index = tree["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"]
    values = np.full((4, 4), factor, "<f4").tobytes()
    length = tree["buffers"][0]["byteLength"]
    tree["accessors"][index] |= {"componentType": 5126, "bufferView": len(tree["bufferViews"])}
    tree["bufferViews"].append({"buffer": 0, "byteOffset": length, "byteLength": len(values)})
    tree["buffers"][0]["byteLength"] += len(values)
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    rest = data[28 + size :] + values
    head = struct.pack("<4sII I4s", b"glTF", 2, 28 + len(text) + len(rest), len(text), b"JSON")
    return read(folder, "mesh.glb", head + text + struct.pack("<I4s", len(rest), b"BIN\0") + rest)


def test_colours_of_gltf_go_from_0_to_1(tmp_path: Path) -> None:
    assert (of_gltf(tmp_path, 1.01).plain_colors == 255).all()
    with pytest.raises(vmesh.MeshError, match="expected colours from 0 to 1, got 0 to 255"):
        of_gltf(tmp_path, 255)


@pytest.mark.parametrize("color", [(102, 102, 102), (255, 255, 255), (255, 0, 0), (0, 0, 0)])
@pytest.mark.parametrize("suffix", ["ply", "obj", "glb"])
def test_one_colour_in_all_of_a_mesh_comes_back(
    color: tuple[int, int, int], suffix: str, tmp_path: Path
) -> None:
    square = [(0, 0), (4, 0), (0, 4), (4, 4)]
    mesh = vmesh.Mesh.from_colors(4, 4, square, [(0, 1, 2), (1, 3, 2)], np.array([color] * 4))
    path = tmp_path / f"mesh.{suffix}"
    vmesh.export(mesh, path)
    back = vmesh.import_mesh(path).plain_colors
    assert (np.broadcast_to(back, (4, 3)) == color).all()


def of_floats(*values: float) -> bytes:
    rows = [(*v[:3], *([value] * 3)) for v, value in zip(SQUARE, values, strict=True)]
    return ply(rows, colors=COLORS.replace("uchar", "float"))


DAMAGED: Final[dict[str, tuple[bytes, str]]] = {
    "an empty file.ply": (b"", "damaged"),
    "another file.ply": (b"\x89PNG\r\n" * 9, "damaged"),
    "half a header.ply": (ply()[:120], "damaged"),
    "cut off.ply": (ply()[:-8], "do not cover"),
    "cut off in the vertices.ply": (ply()[:-40], "damaged|found none|expected|vertex"),
    "cut off, binary.ply": (binary_ply("<")[:-1], "damaged"),
    "one byte more, binary.ply": (binary_ply("<") + b"\0", "damaged"),
    "a count without end.ply": (ply(n_vertices=10**15), "damaged|found none"),
    "a count without end, binary.ply": (binary_ply("<", n_vertices=10**15), "damaged"),
    "a negative count.ply": (ply(n_vertices=-1), "damaged|found none"),
    "no vertices.ply": (ply([], []), "found none|damaged"),
    "lines.ply": (ply(faces=[(0, 1), (1, 2)]), "expected a mesh of triangles"),
    "no colours.ply": (ply([v[:3] for v in SQUARE], colors=""), "colour at every vertex"),
    "not a number.ply": (ply([("nan", *SQUARE[0][1:]), *SQUARE[1:]]), "not a finite number"),
    "without end.ply": (ply([("inf", *SQUARE[0][1:]), *SQUARE[1:]]), "not a finite number"),
    "a negative index.ply": (ply(faces=[(0, 1, -2), HALVES[1]]), "vertex that does not exist"),
    "a large index.ply": (binary_ply("<", [(0, 1, 2**31 - 1), HALVES[1]]), "does not exist"),
    "a third dimension.ply": (ply([(0, 0, 3, 1, 2, 3), *SQUARE[1:]]), "flat mesh, its z spans 3"),
    "a line.ply": (ply([(v[0], 0, *v[2:]) for v in SQUARE]), "has no area"),
    "a hole.ply": (ply(faces=HALVES[:1]), "do not cover the canvas"),
    "an overlap.ply": (ply(faces=[*HALVES, HALVES[0]]), "do not cover the canvas"),
    "three on an edge.ply": (
        ply([*SQUARE, (1, 1, 0, 0, 0, 0)], [HALVES[0], (0, 1, 4)]),
        "do not cover|same side",
    ),
    "an overlap that makes up for a hole.ply": (
        ply(
            [*SQUARE, (2, 2, 0, 0, 0, 0)],
            [(0, 1, 4), (1, 3, 4), (3, 2, 4), (1, 3, 4)],
        ),
        "same side of an edge",
    ),
    "two colours in one place.ply": (
        ply([*SQUARE, (4, 0, 0, 0, 0, 0)], [(0, 1, 2), (4, 3, 2)]),
        "two vertices share a position",
    ),
    "a vertex in no triangle.ply": (ply([*SQUARE, (1, 1, 0, 0, 0, 0)]), "belongs to no triangle"),
    "far apart.ply": (ply([(*(1e30 * float(str(x)) for x in v[:3]), *v[3:]) for v in SQUARE]),
                      "e\\+30 pixels is over 65535"),
    "an empty file.obj": (b"", "found none"),
    "not text.obj": (bytes(range(256)) * 9, "found none|damaged"),
    "cut off.obj": (obj()[:-7], "do not cover|damaged"),
    "a word.obj": (obj([("x", *SQUARE[0][1:]), *SQUARE[1:]]), "damaged"),
    "not a number.obj": (obj([("nan", *SQUARE[0][1:]), *SQUARE[1:]]), "not a finite number"),
    "a large index.obj": (obj(faces=[(1, 2, 30), (2, 4, 3)]), "damaged"),
    "a negative index.obj": (obj(faces=[(-9, 2, 3), (2, 4, 3)]), "damaged"),
    "index 0.obj": (obj(faces=[(0, 1, 2), (2, 4, 3)]), "no area|cover"),
    "colours of 16 bits.obj": (
        obj([(*v[:3], *[65535 * 255] * 3) for v in SQUARE]), "to 255, or 16-bit integers"
    ),
    "an opacity or a weight.obj": (
        obj(SQUARE).replace(b"v 0 0 0", b"v 0 0 0 1.0", 1), "more than x y z and red green blue"
    ),
    "light beyond white.ply": (of_floats(0, 0.5, 1, 3.5), "from 0 to 1, or to 255"),
    "colours beyond all ranges.ply": (of_floats(0, 0.5, 1, 1023), "from 0 to 1, or to 255"),
    "a negative colour.ply": (of_floats(-3, 0, 100, 255), "from 0 to 1, or to 255"),
    "a colour that is no number.ply": (of_floats(0, 0, float("nan"), 1), "not a number"),
    "no colours.obj": (obj([v[:3] for v in SQUARE]), "colour at every vertex"),
    "colours for some.obj": (obj([*SQUARE[:3], SQUARE[3][:3]]), "colour at every vertex"),
    "an empty file.glb": (b"", "header of a .glb file"),
    "another file.glb": (b"\x89PNG\r\n" * 9, "header of a .glb file"),
    "brackets.glb": (struct.pack("<4sIII4s", b"glTF", 2, 9, 10**5, b"JSON") + b"[" * 10**5, "dam"),
    "an empty file.txt": (b"", "line 1: expected 'vmesh 1.0'"),
    "not text.txt": (b"\xff\xfe", "in ASCII"),
}  # fmt: skip


@pytest.mark.parametrize("name", DAMAGED)
def test_a_file_that_is_no_such_mesh_is_refused_in_one_sentence(
    name: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    data, pattern = DAMAGED[name]
    with pytest.raises(ValueError, match=pattern) as caught:
        read(tmp_path, name, data)
    assert "\n" not in str(caught.value).strip()
    assert len(str(caught.value)) < 200
    assert capfd.readouterr().err == ""


def set_count(index: int, count: int) -> Callable[[dict[str, Any]], object]:
    return lambda tree: tree["accessors"][index].update(count=count)


TREES: Final[dict[str, tuple[Callable[[dict[str, Any]], object], str]]] = {
    "other data": (lambda t: t["buffers"][0].update(uri="file:///etc/hostname"), "another file"),
    "a needed extension": (
        lambda t: t.update(extensionsRequired=["KHR_draco_mesh_compression"]),
        "KHR_draco_mesh_compression",
    ),
    "sparse data": (lambda t: t["accessors"][1].update(sparse={}), "sparse"),
    "zeros without data": (lambda t: t["accessors"][1].pop("bufferView"), "sparse"),
    "too many entries": (set_count(1, 10**12), "entries, but the limit"),
    "more entries than data": (set_count(1, 50), "damaged"),
    "fewer colours": (set_count(2, 3), "colour at every vertex"),
    "a negative count": (set_count(1, -1), "damaged|colour"),
    "no colours": (
        lambda t: t["meshes"][0]["primitives"][0]["attributes"].pop("COLOR_0"),
        "colour at every vertex",
    ),
    "lines": (lambda t: t["meshes"][0]["primitives"][0].update(mode=1), "found none"),
    "no meshes": (lambda t: t.pop("meshes"), "damaged"),
    "lists for objects": (lambda t: t.update(accessors=[[]]), "damaged|sparse"),
    "upright in space": (lambda t: t["nodes"][0].update(rotation=[0.7071, 0, 0, 0.7071]), "flat"),
    "nowhere": (lambda t: t["nodes"][0].update(translation=[float("nan"), 0, 0]), "finite|dam"),
}


@pytest.mark.parametrize("name", TREES)
def test_a_gltf_scene_that_is_no_such_mesh_is_refused(name: str, tmp_path: Path) -> None:
    change, pattern = TREES[name]
    with pytest.raises((ValueError, vmesh.LimitError), match=pattern):
        read(tmp_path, "changed.glb", glb(tmp_path, change))


def test_a_scene_that_holds_itself_ends(square: vmesh.Mesh, tmp_path: Path) -> None:
    def nest(tree: dict[str, Any]) -> None:
        tree["nodes"] = [{"mesh": 0, "children": [1]}, {"children": [0]}]

    assert read(tmp_path, "nested.glb", glb(tmp_path, nest)) == square


def test_many_copies_of_a_surface_count(tmp_path: Path) -> None:
    def repeat(tree: dict[str, Any]) -> None:
        tree["nodes"] = [{"mesh": 0}] * 1000
        tree["scenes"] = [{"nodes": list(range(1000))}]

    with pytest.raises(vmesh.LimitError, match="vertices, but the limit is 3000"):
        limits = vmesh.Limits(max_vertices=3000)
        read(tmp_path, "many.glb", glb(tmp_path, repeat), limits=limits)


@pytest.mark.parametrize("name", ["mesh.ply", "mesh.obj", "mesh.glb"])
def test_truncations_all_along_a_file_are_refused(name: str, tmp_path: Path) -> None:
    vmesh.export(samples.color(), tmp_path / name)
    data = (tmp_path / name).read_bytes()
    # The last character of an OBJ file is the end of a line, the last but one a digit.
    for length in range(0, len(data) - 2, 97):
        with pytest.raises(ValueError, match=r"damaged|expected|cover|triangle|vert"):
            read(tmp_path, name, data[:length])


def test_limits_hold_before_the_work_is_done(tmp_path: Path) -> None:
    for limits, options, pattern in (
        (vmesh.Limits(max_vertices=3), {}, "4 vertices, but the limit is 3"),
        (vmesh.Limits(max_pixels=9_999), {"width": 100}, "limit is 9999 pixels"),
    ):
        with pytest.raises(vmesh.LimitError, match=pattern):
            read(tmp_path, "mesh.ply", ply(), limits=limits, **options)
    with pytest.raises(vmesh.LimitError, match="bytes, but the limit"):
        read(tmp_path, "mesh.ply", ply() + b"\n" * 9000, limits=vmesh.Limits(max_vertices=8))


@pytest.mark.parametrize("options", [{"scale": 0}, {"scale": float("nan")}, {"width": 70_000}])
def test_a_size_that_no_canvas_has_is_refused(options: dict[str, Any], tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"expected a scale above 0|65535"):
        read(tmp_path, "mesh.ply", ply(), **options)


def test_a_name_has_to_say_the_format(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"ends in .ply, .obj, .glb, .txt, got .*mesh.stl"):
        read(tmp_path, "mesh.stl", ply())


def test_a_text_has_its_own_canvas(tmp_path: Path) -> None:
    text = mesh_text(samples.color()).encode()
    with pytest.raises(ValueError, match="expected no others"):
        read(tmp_path, "mesh.txt", text, width=9)


TEXTS: Final[dict[str, tuple[str, str, str]]] = {
    "another version": ("vmesh 1.0", "vmesh 2.0", "line 1: expected 'vmesh 1.0', got 'vmesh 2.0'"),
    "another word": ("canvas", "page", "line 2: expected 'canvas'"),
    "too few numbers": ("canvas 16 16", "canvas 16", "line 2: expected 'canvas' and 2 numbers"),
    "a fraction": ("canvas 16", "canvas 16.5", "line 2: expected whole numbers"),
    "other digits": ("canvas 16", "canvas ١٦", "in ASCII"),
    "a huge number": ("canvas 16", f"canvas {'9' * 5000}", "line 2: expected whole numbers"),
    "too few vertices": ("vertices 60", "vertices 59", "line 66: expected 'triangles'"),
    "too many vertices": ("vertices 60", "vertices 61", "expected 5 numbers"),
    "vertices without end": ("vertices 60", "vertices 999999999", "limit is 4194304"),
    "triangles without end": ("triangles 102", "triangles 999999999", "expected 3 numbers|early"),
    "no triangles": ("triangles 102", "triangles 0", "expected the end|'the end'"),
    "two spaces": ("canvas 16 16", "canvas 16  16", "line 2"),
    "other ends of lines": ("\n", "\r\n", "line 1"),
    "a step of 0": ("\nsteps 8", "\nsteps 0", "colour steps of 1 to 255"),
    "17 bits": ("depth 8", "depth 17", "8 to 16 bits"),
}


@pytest.mark.parametrize("name", TEXTS)
def test_a_text_that_is_wrong_is_refused_with_its_line(name: str, tmp_path: Path) -> None:
    text = mesh_text(samples.color())
    wanted, given, pattern = TEXTS[name]
    assert wanted in text
    with pytest.raises((ValueError, vmesh.LimitError), match=pattern) as caught:
        read(tmp_path, "mesh.txt", text.replace(wanted, given).encode())
    assert len(str(caught.value)) < 200


def test_every_truncated_text_is_refused(tmp_path: Path) -> None:
    text = mesh_text(samples.smallest()).encode()
    for length in range(len(text)):
        with pytest.raises(vmesh.MeshError):
            read(tmp_path, "mesh.txt", text[:length])
