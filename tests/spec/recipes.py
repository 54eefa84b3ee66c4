"""Meshes and files that the specification is tried on, and the conformance files are made of."""

from __future__ import annotations

import zlib
from collections.abc import Callable
from typing import Final

import numpy as np

import vmesh
from tests.codec.damage import (
    SIGNATURE,
    checked,
    chunk_of,
    file_of,
    header_fields,
    padded,
    split,
    varint,
    with_content,
    with_header,
)
from tests.tiled import tiled
from vmesh.codec.hierarchy import build_hierarchy
from vmesh.codec.mesh_coder import Encoder, encode
from vmesh.codec.reader import read
from vmesh.encoder.settings import Method
from vmesh.kernels.coding import range_coder
from vmesh.kernels.delaunay import delaunay
from vmesh.mesh import Mesh, Metadata


def mesh_of(
    width: int,
    height: int,
    n_components: int,
    *,
    n_vertices: int = 4,
    subdivision: int = 0,
    step: int = 1,
    depth: int = 8,
    metadata: Metadata | None = None,
) -> Mesh:
    """A Delaunay mesh with random vertices and colours."""
    random = np.random.default_rng(width + 100 * height + n_vertices)
    far_x, far_y = width << subdivision, height << subdivision
    sites = {(0, 0), (far_x, 0), (0, far_y), (far_x, far_y)}
    while len(sites) < n_vertices:
        sites.add((int(random.integers(far_x + 1)), int(random.integers(far_y + 1))))
    vertices = np.array(sorted(sites, key=lambda site: site[::-1]), dtype=np.int32)
    colors = random.integers(0, 1 << depth, (len(vertices), n_components))
    return Mesh.from_colors(
        width,
        height,
        vertices,
        delaunay(vertices),
        colors,
        step=step,
        depth=depth,
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


def askew(width: int) -> Mesh:
    """Two rows of vertices, the upper ones all joined to one of the lower: far from Delaunay."""
    vertices = np.array([(x, y) for y in (0, 1) for x in range(width + 1)], dtype=np.int32)
    triangles = [(x, x + 1, width + 1) for x in range(width)]
    triangles += [(width, width + 2 + x, width + 1 + x) for x in range(width)]
    colors = np.random.default_rng(width).integers(0, 256, (len(vertices), 3))
    return Mesh.from_colors(width, 1, vertices, np.array(triangles), colors).canonical()


def as_askew(piece: Mesh) -> Mesh:
    """The piece, with a vertex on each site of two rows, with triangles far from Delaunay."""
    return piece.replaced(triangles=askew(piece.width).triangles)


def picture(height: int, width: int, *components: int, method: Method = "blue-noise") -> Mesh:
    """What the encoder makes of noise."""
    noise = np.random.default_rng(1).integers(0, 256, (height, width, *components), dtype=np.uint8)
    return vmesh.encode(noise, method=method)


def gradient(height: int, width: int) -> Mesh:
    """What the adaptive encoder makes of a soft slanted edge."""
    y, x = np.mgrid[:height, :width]
    level = np.clip(128 + 12 * (x + 3 * y - width - height), 0, 255)
    planes = np.stack([level, 255 - level, level // 2], axis=2).astype(np.uint8)
    return vmesh.encode(planes, vertices=60)


def grid(side: int) -> Mesh:
    """All sites of a square canvas: every circle holds four vertices."""
    return mesh_of(side, side, 1, n_vertices=(side + 1) ** 2)


METADATA: Final = Metadata(
    icc=b"profile" * 40, exif=b"II*\0", xmp=b"<x/>", unknown=((b"n", b""), (b"n", b"\0"))
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
    "9 bits": lambda: mesh_of(8, 8, 3, n_vertices=30, depth=9),
    "12 bits, grey": lambda: mesh_of(16, 12, 1, n_vertices=40, subdivision=1, depth=12),
    "flipped, 16 bits": lambda: flipped(mesh_of(11, 13, 4, n_vertices=40, depth=16), 5),
    "16 bits, extremes": lambda: corners_only(3, 2, [0, 65535, 65535, 0], depth=16),
    "16 bits, step 1000": lambda: mesh_of(16, 12, 3, n_vertices=60, step=1000, depth=16),
    "16 bits, step 65535": lambda: mesh_of(8, 8, 4, n_vertices=30, step=65535, depth=16),
    "16 bits, a large triangle": lambda: corners_only(9000, 20, [1, 65534, 7, 65535], depth=16),
    "16 bits, subdivision 8": lambda: mesh_of(700, 700, 1, subdivision=8, depth=16),
    "wide and flat": lambda: mesh_of(300, 1, 3, n_vertices=50, subdivision=2),
    "flipped": lambda: flipped(mesh_of(16, 12, 3, n_vertices=70), 12),
    "flipped, ties": lambda: flipped(grid(8), 20),
    "flipped, two triangles": lambda: flipped(mesh_of(5, 3, 1), 1),
    "flipped, subdivision 8": lambda: flipped(mesh_of(11, 13, 4, n_vertices=40, subdivision=8), 7),
    "flipped, adaptive": lambda: gradient(24, 32),
    "listed": lambda: askew(24),
    "metadata": lambda: mesh_of(4, 4, 3, n_vertices=9, metadata=METADATA),
    "tiles": lambda: tiled(20, 13, 6, 3, n_vertices=90),
    "tiles, flipped": lambda: tiled(
        20, 13, 6, 4, n_vertices=150, subdivision=1, change=lambda piece: flipped(piece, 1)
    ),
    "tiles, a single one": lambda: tiled(7, 5, 9, 1, n_vertices=20),
    "tiles of a pixel": lambda: tiled(5, 4, 1, 3, subdivision=2, n_vertices=60),
    "tiles of 4096 lattice units": lambda: tiled(33, 20, 16, 1, n_vertices=40, subdivision=8),
    "tiles, listed, 16 bits": lambda: tiled(
        48, 1, 24, 3, n_vertices=3000, depth=16, change=as_askew
    ).replaced(metadata=METADATA),
}


def corners_only(width: int, height: int, colors: list[int], *, depth: int = 8) -> Mesh:
    """A grey mesh of the corners of its canvas."""
    vertices = np.array([(0, 0), (width, 0), (0, height), (width, height)], dtype=np.int32)
    grey = np.array(colors)[:, np.newaxis]
    return Mesh.from_colors(width, height, vertices, delaunay(vertices), grey, depth=depth)


TWO_TILES: Final = tiled(2, 1, 1, 1).replaced(
    levels=np.array([[0], [128], [255], [0], [128], [255]], dtype=np.int32)
)
TWO_PIXELS: Final = corners_only(2, 1, [0, 255, 0, 255])
DUMPED: Final = [
    TWO_PIXELS,
    TWO_PIXELS.replaced(triangles=np.array([(0, 1, 2), (1, 3, 2)], dtype=np.int32)),
    corners_only(1, 1, [0, 0, 0, 0]),
    TWO_TILES,
]


# Small files that conform, but ask for a lot.


def count_bomb() -> Mesh:
    """All sites of a canvas in one colour: next to no bits for a vertex."""
    mesh = grid(300)
    return mesh.replaced(levels=np.zeros_like(mesh.levels))


def slivers() -> Mesh:
    """Two fans over a column of pixels, whose triangles span a quarter of its rows on average."""
    height = 65_535
    left = [(0, 0), (0, height)]
    vertices = np.array(left + [(1, y) for y in range(height + 1)], dtype=np.int32)
    vertices = vertices[np.lexsort(vertices.T)]
    return Mesh.from_colors(
        1, height, vertices, delaunay(vertices), np.zeros((len(vertices), 1), dtype=np.uint8)
    )


def largest_canvas() -> Mesh:
    """The largest canvas, with nothing on it."""
    return corners_only(65_535, 65_535, [0, 80, 160, 240])


# Files that break a rule.

VALID: Final = vmesh.dumps(flipped(mesh_of(6, 5, 3, n_vertices=15, metadata=METADATA), 2))
HEADER, CHUNKS = split(VALID)
MESH: Final = CHUNKS[-1]
SIZES: Final = read(VALID).sizes
START: Final = checked(SIGNATURE + HEADER)


def with_mesh(content: bytes) -> bytes:
    """The valid file with another content of M."""
    return file_of(HEADER, [*CHUNKS[:-1], (b"M", content)])


def with_chunks(*chunks: tuple[bytes, bytes]) -> bytes:
    """The valid file with other chunks before M."""
    return file_of(HEADER, [*chunks, MESH])


def with_numbers(*numbers: bytes) -> bytes:
    """The valid file with other width, height and number of vertices."""
    return file_of(HEADER[:2] + b"".join(numbers) + HEADER[-3:], CHUNKS)


def with_depth(depth: int, n_steps: int) -> bytes:
    """The valid file with a byte of components and depth, and as many steps."""
    form = bytes([HEADER[0], HEADER[1] & ~3 | 1, depth])
    return file_of(form + HEADER[2:-3] + b"\1" * n_steps, CHUNKS)


def without_triangles(encoder: Encoder, mesh: Mesh) -> None:
    """Write positions and colours of a mesh."""
    columns, rows = (side * mesh.unit + 1 for side in (mesh.width, mesh.height))
    encoder.positions(mesh.vertices, columns, rows)
    hierarchy = build_hierarchy(mesh.vertices, delaunay(mesh.vertices))
    encoder.levels(mesh.levels, hierarchy, mesh.lattice)


def listed(mesh: Mesh, *triangles: tuple[int, int, int]) -> bytes:
    """A file of the mesh with listed triangles that need not make sense."""

    def write(encoder: Encoder) -> None:
        without_triangles(encoder, mesh)
        encoder.triangles(np.array(triangles, dtype=np.int32), n_vertices=1000)

    header, _ = split(with_header(vmesh.dumps(mesh), connectivity=1))
    return file_of(header, [(b"M", encode(write))])


def flipped_for_ever(mesh: Mesh) -> bytes:
    """A file of the mesh in which every edge that can be flipped is flipped."""

    def write(encoder: Encoder) -> None:
        without_triangles(encoder, mesh)
        model = range_coder.even_model(64)
        for context in range(64):  # Zeros that follow many ones are read as ones.
            range_coder.code_bit(encoder.coder, encoder.data, model, context, 1)

    header, _ = split(with_header(vmesh.dumps(mesh), connectivity=2))
    return file_of(header, [(b"M", encode(write) + bytes(400))])


def misplaced(width: int, height: int, *vertices: tuple[int, int]) -> bytes:
    """A file of a canvas with other vertices than its corners, and colours of no bits."""
    points = np.array(vertices, dtype=np.int32)
    content = encode(lambda encoder: encoder.positions(points, width + 1, height + 1))
    header = bytes([0x10, 0, width, height, len(points), 1])
    return file_of(header, [(b"M", content)])


def fan(side: int, x: int, y: int) -> Mesh:
    """The corners of a square canvas, 0, 1, 3, 4, around the vertex 2 at x, y."""
    vertices = np.array([(0, 0), (side, 0), (x, y), (0, side), (side, side)], dtype=np.int32)
    triangles = np.array([(0, 1, 2), (0, 2, 3), (1, 4, 2), (2, 4, 3)], dtype=np.int32)
    return Mesh.from_colors(side, side, vertices, triangles, [[5], [90], [200], [40], [250]])


def overdrawn(side: int) -> bytes:
    """A file of triangles that lie over one another, with two corners of the canvas in each."""
    mesh = mesh_of(side, side, 1, n_vertices=90)
    last = mesh.n_vertices - 1
    triangles = [(a, b, last) for a in (0, 1) for b in range(a + 1, last)]
    return listed(mesh, *triangles[: mesh.n_triangles])


def cut(data: bytes, n_bytes: int) -> bytes:
    """The file without some bytes at the end of its mesh."""
    return with_content(data, b"M", split(data)[1][-1][1][:-n_bytes])


TILED: Final = vmesh.dumps(tiled(12, 10, 8, 3, n_vertices=60))
TILED_HEADER, (GRID, *TILES) = split(TILED)


def with_tiles(*chunks: tuple[bytes, bytes]) -> bytes:
    """The valid file in tiles with other chunks."""
    return file_of(TILED_HEADER, chunks)


def with_tile(content: bytes) -> bytes:
    """The valid file in tiles with another content of the second of them."""
    return with_tiles(GRID, TILES[0], (b"T", content), *TILES[2:])


def with_two_tiles(left: Mesh, right: Mesh) -> bytes:
    """A file of two grey squares side by side, whether they fit or not."""
    side = left.width
    header, (grid, *_) = split(vmesh.dumps(tiled(2 * side, side, side, 1)))
    meshes = (split(vmesh.dumps(mesh))[1][-1][1] for mesh in (left, right))
    counts = (varint(mesh.n_vertices) for mesh in (left, right))
    tiles = [(b"T", count + content) for count, content in zip(counts, meshes, strict=True)]
    return file_of(header, [grid, *tiles])


IMPLIED: Final = vmesh.dumps(mesh_of(6, 5, 3, n_vertices=15))
LIST: Final = vmesh.dumps(askew(20))
FLIPPED: Final = vmesh.dumps(flipped(mesh_of(16, 12, 3, n_vertices=70), 12))

DAMAGED: Final[dict[str, tuple[str, bytes]]] = {
    "nothing": ("truncated", b""),
    "a photograph": ("signature", b"\x89PNG\r\n\x1a\n" + bytes(40)),
    "draft 0": ("signature", b"\x8bVMS\r\n\x1a\n" + bytes(40)),
    "line ends converted": ("signature", VALID.replace(b"\r\n", b"\n")),
    "half a signature": ("truncated", VALID[:3]),
    "only a signature": ("truncated", VALID[:5]),
    "half a header": ("truncated", VALID[:9]),
    "no chunk": ("truncated", START),
    "no mesh": ("truncated", file_of(HEADER, CHUNKS[:-1])),
    "no last byte": ("truncated", VALID[:-1]),
    "a byte more": ("trailing", VALID + b"\0"),
    "two meshes": ("trailing", VALID + chunk_of(*MESH)),
    "a note too late": ("trailing", VALID + chunk_of(b"n", b"")),
    "a flipped bit": ("checksum", VALID[:30] + bytes([VALID[30] ^ 1]) + VALID[31:]),
    "a flipped bit of a step": ("checksum", VALID[:10] + bytes([VALID[10] ^ 1]) + VALID[11:]),
    "a flipped bit of a tag": ("checksum", START + b"m" + chunk_of(*MESH)[1:]),
    "version 0.0": ("version", with_header(VALID, version=0x00)),
    "version 0.1": ("version", with_header(VALID, version=0x01)),
    "version 2.0": ("version", with_header(VALID, version=0x20)),
    "a version alone": ("version", VALID[:5] + b"\x20"),
    "no width": ("header", with_header(VALID, width=0)),
    "no height": ("header", with_header(VALID, height=0)),
    "too wide": ("header", with_header(VALID, width=65_536)),
    "too high": ("header", with_header(VALID, height=65_536)),
    "subdivision 9": ("header", with_header(VALID, subdivision=9)),
    "a huge lattice": ("header", with_header(VALID, height=65_535, subdivision=4)),
    "two components": ("header", with_depth(0b000101, 2)),
    "a depth of 8 told apart": ("header", with_depth(0b000010, 3)),
    "17 bits": ("header", with_depth(0b100110, 3)),
    "a reserved bit of the depth": ("header", with_depth(0b1000110, 3)),
    "half a depth": ("truncated", VALID[:6] + b"\1"),
    "unknown connectivity": ("header", with_header(VALID, connectivity=3)),
    "three vertices": ("header", with_header(VALID, n_vertices=3)),
    "too many vertices": ("header", with_header(VALID, n_vertices=43)),
    "more vertices than bytes": (
        "header",
        with_header(VALID, width=2000, height=2000, n_vertices=1900 * (len(MESH[1]) + 1) + 1),
    ),
    "step 0": ("header", with_header(VALID, b"\1\0\1")),
    "step 256 of 8 bits": ("header", with_header(VALID, b"\1\1" + varint(256))),
    "a long step": ("header", with_header(VALID, b"\1\1" + padded(1))),
    "a long width": ("header", with_numbers(padded(6), varint(5), varint(15))),
    "a long height": ("header", with_numbers(varint(6), padded(5), varint(15))),
    "a long count": ("header", with_numbers(varint(6), varint(5), padded(15))),
    "a number without end": ("header", with_numbers(b"\x80" * 9)),
    "a number of 32 bits": ("header", with_numbers(varint(6), varint(5), varint(2**31))),
    "a digit as a tag": ("chunk", with_chunks((b"1", b""))),
    "a tag that is not ASCII": ("chunk", with_chunks((b"\xe9", b""))),
    "a long length": ("chunk", START + b"M" + padded(len(MESH[1])) + MESH[1]),
    "a length of 32 bits": ("chunk", START + b"M" + varint(2**31) + MESH[1]),
    "a length without end": ("chunk", START + b"M" + b"\xff" * 9),
    "two profiles": ("chunk", with_chunks(CHUNKS[0], (b"n", b""), CHUNKS[0])),
    "unknown and critical": ("chunk", with_chunks((b"C", b""))),
    "not deflated": ("metadata", with_chunks((b"i", b"profile"))),
    "half a stream": ("metadata", with_chunks((b"e", zlib.compress(b"profile" * 9)[:-5]))),
    "two streams": ("metadata", with_chunks((b"x", 2 * zlib.compress(b"profile")))),
    "an empty profile": ("metadata", with_chunks((b"i", zlib.compress(b"")))),
    "no positions": ("positions", with_mesh(b"")),
    "half of the positions": ("positions", with_mesh(MESH[1][:2])),
    "other positions": ("geometry", misplaced(3, 3, (1, 1), (2, 1), (1, 2), (2, 2))),
    "three corners": ("geometry", misplaced(3, 3, (0, 0), (3, 0), (0, 3), (2, 3))),
    "half of the colours": ("colors", with_mesh(MESH[1][: SIZES["positions"] + 12])),
    "more colours": ("colors", with_header(FLIPPED, connectivity=0)),
    "half of the flips": ("triangles", cut(FLIPPED, 6)),
    "more flips": ("triangles", with_mesh(MESH[1] + bytes(9))),
    "flips without end": ("triangles", flipped_for_ever(mesh_of(6, 5, 1, n_vertices=15))),
    "half of a list": ("triangles", cut(LIST, 20)),
    "corners missing though triangles are listed": (
        "geometry",
        with_header(misplaced(3, 3, (1, 1), (2, 1), (1, 2), (2, 2)), connectivity=1),
    ),
    "an unknown third vertex": (
        "triangles",
        listed(fan(2, 1, 1), (0, 1, 4), (0, 2, 3), (0, 4, 5), (2, 4, 3)),
    ),
    "an unknown second vertex": (
        "triangles",
        listed(fan(2, 1, 1), (0, 1, 4), (0, 2, 3), (0, 5, 4), (2, 4, 3)),
    ),
    "an unknown first vertex": (
        "triangles",
        listed(fan(2, 1, 1), (0, 1, 4), (0, 2, 3), (0, 4, 2), (5, 6, 7)),
    ),
    "a gap and an overlap of the same size": (
        "geometry",
        listed(mesh_of(2, 1, 1, n_vertices=6), (0, 1, 3), (0, 4, 3), (1, 2, 4), (1, 5, 4)),
    ),
    "overdraw": ("geometry", overdrawn(40)),
    "an overlap": ("geometry", listed(DUMPED[1], (0, 1, 3), (1, 3, 2))),
    "a fold": ("geometry", listed(fan(3, 2, 1), (0, 1, 4), (0, 2, 3), (0, 4, 2), (2, 4, 3))),
    "a grid without a side": ("tiles", with_tiles((b"G", b""), *TILES)),
    "tiles of no pixels": ("tiles", with_tiles((b"G", b"\0"), *TILES)),
    "tiles of 4097 lattice units": ("tiles", with_tiles((b"G", varint(4097)), *TILES)),
    "tiles of 4096 pixels, subdivided": (
        "tiles",
        with_header(with_tiles((b"G", varint(4096)), *TILES), subdivision=1),
    ),
    "a long side": ("tiles", with_tiles((b"G", padded(8)), *TILES)),
    "a side without end": ("tiles", with_tiles((b"G", b"\x88"), *TILES)),
    "a byte after the side": ("tiles", with_tiles((b"G", varint(8) + b"\0"), *TILES)),
    "fewer vertices than corners of tiles": ("tiles", with_header(TILED, n_vertices=8)),
    "a tile without a grid": ("chunk", with_tiles(*TILES)),
    "two grids": ("chunk", with_tiles(GRID, GRID, *TILES)),
    "a grid and a mesh": ("chunk", with_tiles(GRID, MESH)),
    "a note between tiles": ("chunk", with_tiles(GRID, TILES[0], (b"n", b""), *TILES[1:])),
    "a tile missing": ("truncated", with_tiles(GRID, *TILES[:-1])),
    "a tile too many": ("trailing", with_tiles(GRID, *TILES, TILES[0])),
    "a flipped bit of a tile": ("checksum", TILED[:60] + bytes([TILED[60] ^ 1]) + TILED[61:]),
    "a tile of nothing": ("tiles", with_tile(b"")),
    "a long number of vertices in a tile": (
        "tiles",
        with_tile(padded(TILES[1][1][0]) + TILES[1][1][1:]),
    ),
    "a tile of three vertices": ("tiles", with_tile(b"\3" + TILES[1][1][1:])),
    "more vertices in a tile than sites": ("tiles", with_tile(varint(46) + TILES[1][1][1:])),
    "more vertices in a tile than bytes": (
        "tiles",
        with_header(
            with_tiles((b"G", varint(100)), (b"T", varint(9000)), *TILES[1:]),
            width=101,
            height=101,
        ),
    ),
    "half of the positions of a tile": ("positions", with_tile(TILES[1][1][:2])),
    "half of the colours of a tile": ("colors", with_tile(TILES[1][1][:-12])),
    "more colours in a tile": ("colors", with_tile(TILES[1][1] + bytes(9))),
    "another number of vertices in all": (
        "tiles",
        with_header(TILED, n_vertices=header_fields(TILED)["n_vertices"] + 1),
    ),
    "neighbours with other vertices": (
        "tiles",
        with_two_tiles(mesh_of(3, 3, 1, n_vertices=16), mesh_of(3, 3, 1)),
    ),
    "neighbours of other colours": (
        "tiles",
        with_two_tiles(corners_only(1, 1, [0, 9, 0, 9]), corners_only(1, 1, [9, 0, 8, 0])),
    ),
    "a line": ("geometry", listed(fan(2, 1, 1), (0, 1, 4), (0, 2, 3), (0, 4, 2), (2, 4, 3))),
}
