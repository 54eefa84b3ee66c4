"""The coded mesh: positions, triangles and colours in one stream (spec, sections 5 to 8)."""

from __future__ import annotations

from collections.abc import Callable
from math import log2
from typing import Final

import numpy as np

from vmesh.arrays import Int32Array, Int64Array, UInt8Array
from vmesh.codec.layout import LISTED_TRIANGLES, Header
from vmesh.color_lattice import ColorLattice
from vmesh.errors import FormatError
from vmesh.kernels import entropy
from vmesh.kernels.delaunay import delaunay
from vmesh.mesh import Mesh, raster_keys

# Zero bytes that a writer may cut off the end: as many as the coder holds in advance. So what a
# stream can hold is bounded by its length.
_CUT_BYTES: Final = 4


def encode_mesh(mesh: Mesh, header: Header) -> bytes:
    """Content of the mesh chunk: a mesh that passed its check, in canonical order."""

    def write(encoder: Encoder) -> None:
        encoder.positions(mesh.vertices, header.columns, header.rows)
        if header.connectivity == LISTED_TRIANGLES:
            encoder.triangles(mesh.triangles, mesh.n_vertices)
        encoder.levels(mesh.levels, mesh.vertices, mesh.triangles, mesh.lattice)

    return encode(write)


def decode_mesh(content: bytes, offset: int, header: Header) -> tuple[Mesh, dict[str, int]]:
    """The mesh of a content that starts at an offset of the file, and the bytes of its parts.

    Raises
    ------
    FormatError
        With the code ``positions``, ``triangles``, ``geometry`` or ``colors``.
    """
    decoder = Decoder(content, offset)
    vertices = decoder.positions(header.n_vertices, header.columns, header.rows)
    if header.connectivity == LISTED_TRIANGLES:
        triangles = decoder.triangles(_n_triangles(vertices, header), header.n_vertices)
    else:
        triangles = delaunay(vertices)
    bare = Mesh(
        header.width,
        header.height,
        vertices,
        triangles,
        np.zeros((header.n_vertices, header.n_components), dtype=np.int32),
        ColorLattice(header.steps),
        header.subdivision,
    )
    try:
        bare.check()
    except ValueError as error:
        raise FormatError("geometry", str(error), offset) from None
    levels = decoder.levels(bare.vertices, bare.triangles, bare.lattice)
    return bare.replaced(levels=levels), decoder.finish()


def _n_triangles(vertices: Int32Array, header: Header) -> int:
    """How many triangles cover the canvas: Euler's formula leaves no choice."""
    on_border = (vertices == 0) | (vertices == [header.columns - 1, header.rows - 1])
    return 2 * len(vertices) - 2 - int(on_border.any(axis=1).sum())


class Encoder:
    """Writes the parts of a mesh into one stream, one after the other.

    Parameters
    ----------
    room : int
        Bytes for which there is room; more are counted, but not kept.
    """

    def __init__(self, room: int) -> None:
        self.coder = np.zeros(entropy.N_FIELDS, dtype=np.int64)
        self.data = np.zeros(room, dtype=np.uint8)
        entropy.start(self.coder, self.data, 0)

    def positions(self, vertices: Int32Array, columns: int, rows: int) -> None:
        """Write distinct vertices of shape (n, 2), int32, in any order."""
        points = vertices[np.argsort(_halving_keys(vertices, columns, rows))]
        _code_positions(self.coder, self.data, points, columns, rows)

    def triangles(self, triangles: Int32Array, n_vertices: int) -> None:
        """Write triangles of shape (m, 3), int32, in canonical order."""
        own = np.array(triangles, dtype=np.int32)
        status = _code_triangles(self.coder, self.data, own, n_vertices)
        assert status == entropy.OK, "a checked mesh is always coded"

    def levels(
        self,
        levels: Int32Array,
        vertices: Int32Array,
        triangles: Int32Array,
        lattice: ColorLattice,
    ) -> None:
        """Write levels of shape (n, c), int32, of vertices in raster order."""
        own = np.array(levels, dtype=np.int32)
        status = _code_levels(self.coder, self.data, vertices, triangles, own, lattice)
        assert status == entropy.OK, "a checked mesh is always coded"

    def finish(self) -> bytes:
        """What was written, zeros cut off at the end, and cut short where there was no room."""
        length = entropy.finish(self.coder, self.data)
        return self.data[: max(length, self.n_bytes - _CUT_BYTES)].tobytes()

    @property
    def n_bytes(self) -> int:
        """Number of bytes written so far, whether there was room for them or not."""
        return int(self.coder[entropy.POSITION])


def encode(write: Callable[[Encoder], None]) -> bytes:
    """Bytes that `write` lets an encoder write; where there is too little room it writes twice."""
    room = 1 << 16
    while True:
        encoder = Encoder(room)
        write(encoder)
        content = encoder.finish()
        if encoder.n_bytes <= room:
            return content
        room = encoder.n_bytes


class Decoder:
    """Reads the parts of a mesh from one stream, in the order in which they were written.

    Parameters
    ----------
    content : bytes
        The whole stream.
    offset : int
        Where it starts in the file, for the errors.
    """

    def __init__(self, content: bytes, offset: int) -> None:
        self.coder = np.zeros(entropy.N_FIELDS, dtype=np.int64)
        self.data = np.frombuffer(bytearray(content), dtype=np.uint8)
        self.offset = offset
        self.sizes: dict[str, int] = {}
        entropy.start(self.coder, self.data, 1)

    def positions(self, n: int, columns: int, rows: int) -> Int32Array:
        """Vertices in raster order, shape (n, 2), int32, distinct."""
        points = np.zeros((n, 2), dtype=np.int32)
        self._end("positions", _code_positions(self.coder, self.data, points, columns, rows))
        result: Int32Array = points[np.argsort(raster_keys(points))]
        return result

    def triangles(self, m: int, n_vertices: int) -> Int32Array:
        """Triangles, shape (m, 3), int32, indices below `n_vertices`."""
        triangles = np.zeros((m, 3), dtype=np.int32)
        self._end("triangles", _code_triangles(self.coder, self.data, triangles, n_vertices))
        return triangles

    def levels(
        self, vertices: Int32Array, triangles: Int32Array, lattice: ColorLattice
    ) -> Int32Array:
        """Levels of shape (n, c), int32, within the lattice's bounds.

        The mesh of `vertices` and `triangles` has to have passed its check.
        """
        levels = np.zeros((len(vertices), lattice.n_components), dtype=np.int32)
        status = _code_levels(self.coder, self.data, vertices, triangles, levels, lattice)
        self._end("colors", status)
        return levels

    def finish(self) -> dict[str, int]:
        """Bytes of each part, rounded so that they add up to the content, which must end here."""
        read, length = int(self.coder[entropy.POSITION]), len(self.data)
        if read < length:
            unused = f"{length - read} bytes follow the coded colors"
            raise FormatError("colors", unused, self.offset + read)
        self.sizes["colors"] += length - sum(self.sizes.values())
        return self.sizes

    def _end(self, part: str, status: int) -> None:
        """Refuse what was no such part, and note its size."""
        read, length = int(self.coder[entropy.POSITION]), len(self.data)
        if read > length + _CUT_BYTES:
            raise FormatError(part, f"the mesh ends within the {part}", self.offset + length)
        if status != entropy.OK:
            where = self.offset + min(read, length)
            raise FormatError(part, f"the coded {part} hold a number out of range", where)
        # What the coder has narrowed its range by since the start is what the parts took so far.
        so_far = read - log2(self.coder[entropy.RANGE]) / 8
        self.sizes[part] = min(round(so_far), length) - sum(self.sizes.values())


def _code_positions(
    coder: Int64Array, data: UInt8Array, points: Int32Array, columns: int, rows: int
) -> int:
    odds = entropy.fresh_odds(entropy.SPLIT_CONTEXTS)
    entropy.code_positions(coder, data, odds, points, columns, rows)
    return entropy.OK


def _code_triangles(
    coder: Int64Array, data: UInt8Array, triangles: Int32Array, n_vertices: int
) -> int:
    odds = entropy.fresh_odds(3 * entropy.NUMBER_CONTEXTS)
    return entropy.code_triangles(coder, data, odds, triangles, n_vertices)


def _code_levels(
    coder: Int64Array,
    data: UInt8Array,
    vertices: Int32Array,
    triangles: Int32Array,
    levels: Int32Array,
    lattice: ColorLattice,
) -> int:
    odds = entropy.fresh_odds(lattice.n_components * entropy.COMPONENT_CONTEXTS)
    lowest, highest = lattice.level_bounds()
    return entropy.code_levels(coder, data, odds, vertices, triangles, levels, lowest, highest)


def _halving_keys(vertices: Int32Array, columns: int, rows: int) -> Int64Array:
    """Integers that sort vertices in the order in which halving boxes reaches them, (n,)."""
    across, down = (columns - 1).bit_length(), (rows - 1).bit_length()
    x, y = vertices[:, 0].astype(np.int64), vertices[:, 1].astype(np.int64)
    keys = np.zeros(len(vertices), dtype=np.int64)
    while across + down > 0:
        if across >= down:
            across -= 1
            bit = (x >> across) & 1
        else:
            down -= 1
            bit = (y >> down) & 1
        keys = (keys << 1) | bit
    return keys
