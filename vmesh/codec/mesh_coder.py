"""The coded mesh: positions, colours and triangles in one stream (spec, sections 5 to 8)."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from math import log2
from typing import Final, NamedTuple

import numpy as np

from vmesh.arrays import Int32Array, Int64Array, UInt8Array
from vmesh.codec.hierarchy import Hierarchy, build_hierarchy, find_corners
from vmesh.codec.layout import FLIPPED_TRIANGLES, LISTED_TRIANGLES, Chunk, Header
from vmesh.color_lattice import ColorLattice
from vmesh.errors import FormatError
from vmesh.kernels.coding import range_coder
from vmesh.kernels.coding.colors import code_levels, initial_level_model
from vmesh.kernels.coding.flips import MAX_FLIPS, code_flips, initial_flip_model
from vmesh.kernels.coding.positions import code_positions, initial_split_model
from vmesh.kernels.coding.range_coder import OK, even_model
from vmesh.kernels.coding.triangle_list import NUMBER_CONTEXTS, code_triangles
from vmesh.kernels.delaunay import delaunay, flip_to_delaunay
from vmesh.kernels.half_edges import find_twins, sort_triangles
from vmesh.mesh import Mesh
from vmesh.mesh.canonical_order import raster_keys

# Zero bytes that a writer may cut off the end: as many as the coder holds in advance. So what a
# stream can hold is bounded by its length.
_CUT_BYTES: Final = 4
# Flips for each vertex, beyond which a list of the triangles is the shorter way.
_MAX_FLIPS: Final = 4
# Setting these up takes longer than reading a small file: copies of them are used.
_split_model = cache(initial_split_model)
_level_model = cache(initial_level_model)


class Flips(NamedTuple):
    """Flips that turn the canonical Delaunay triangles into those of a mesh, by the removed edges.

    Attributes
    ----------
    removed, created : ndarray
        Shape (k,), int64: edges as two vertices of 32 bits, the lower one first; `removed` ascends.
    """

    removed: Int64Array
    created: Int64Array


def find_flips(mesh: Mesh) -> Flips | None:
    """Flips from the Delaunay triangles to those of a canonical mesh that passed its check.

    None if they are too many for flips to be a good way of coding.
    """
    # A copy: for the mesh's own arrays, which are read-only, kernels would be compiled once more.
    twins = find_twins(mesh.triangles.copy(), mesh.n_vertices)
    origin = mesh.triangles.ravel().astype(np.int64)
    capacity = min(_MAX_FLIPS * mesh.n_vertices, MAX_FLIPS * origin.size)
    created, removed = np.zeros((2, capacity), dtype=np.int64)
    count = flip_to_delaunay(mesh.vertices.astype(np.int64), origin, twins, created, removed)
    if count < 0:
        return None
    # Read backwards: the edge that was created goes.
    order = np.argsort(created[:count])
    return Flips(created[:count][order], removed[:count][order])


def encode_mesh(mesh: Mesh, header: Header, flips: Flips | None) -> bytes:
    """Content of the mesh chunk: a mesh that passed its check, in canonical order."""
    implied = delaunay(mesh.vertices)

    def write(encoder: Encoder) -> None:
        encoder.positions(mesh.vertices, header.columns, header.rows)
        encoder.levels(mesh.levels, build_hierarchy(mesh.vertices, implied), mesh.lattice)
        if header.connectivity == FLIPPED_TRIANGLES and flips is not None:
            encoder.flips(flips, implied, mesh)
        elif header.connectivity == LISTED_TRIANGLES:
            encoder.triangles(mesh.triangles, mesh.n_vertices)

    return encode(write)


def decode_mesh(chunk: Chunk, header: Header) -> tuple[Mesh, dict[str, int]]:
    """The mesh of a chunk, and the bytes of its parts.

    If the file ends within the chunk, colours that are missing follow from those that are there,
    as their predictions, and triangles stay those of Delaunay.

    Raises
    ------
    FormatError
        With the code ``positions``, ``geometry``, ``colors`` or ``triangles``.
    """
    decoder = Decoder(chunk.content, chunk.content_offset, is_whole=chunk.is_whole)
    vertices = decoder.positions(header.n_vertices, header.columns, header.rows)
    far = (header.columns - 1, header.rows - 1)
    if np.count_nonzero(find_corners(vertices, far)) != 4:
        raise FormatError("geometry", "a corner of the canvas is no vertex", chunk.content_offset)
    lattice = ColorLattice(header.steps, header.depth)
    triangles = delaunay(vertices)
    levels = decoder.levels(build_hierarchy(vertices, triangles), lattice)
    is_listed = header.connectivity == LISTED_TRIANGLES and chunk.is_whole
    if header.connectivity == FLIPPED_TRIANGLES:
        triangles = decoder.flips(vertices, triangles, levels)
    elif is_listed:
        triangles = decoder.triangles(_n_triangles(vertices, header), header.n_vertices)
    mesh = Mesh(
        header.width, header.height, vertices, triangles, levels, lattice, header.subdivision
    )
    if is_listed:
        # Delaunay triangles cover a canvas whose corners are vertices, and a flip changes nothing.
        try:
            mesh.check()
        except ValueError as error:
            raise FormatError("geometry", str(error), chunk.content_offset) from None
    return mesh, decoder.finish()


def _n_triangles(vertices: Int32Array, header: Header) -> int:
    """Number of triangles that cover the canvas: Euler's formula leaves no choice."""
    on_border = (vertices == 0) | (vertices == [header.columns - 1, header.rows - 1])
    return 2 * len(vertices) - 2 - int(on_border.any(axis=1).sum())


class Encoder:
    """Writes the parts of a mesh into one stream, one after the other.

    Parameters
    ----------
    capacity : int
        Bytes that are kept; more are only counted.
    """

    def __init__(self, capacity: int) -> None:
        self.coder = np.zeros(range_coder.N_FIELDS, dtype=np.int64)
        self.data = np.zeros(capacity, dtype=np.uint8)
        range_coder.start(self.coder, self.data, 0)

    def positions(self, vertices: Int32Array, columns: int, rows: int) -> None:
        """Write distinct vertices of shape (n, 2), int32, in any order."""
        points = vertices[np.argsort(_kd_tree_keys(vertices, columns, rows))]
        _code_positions(self.coder, self.data, points, columns, rows)

    def triangles(self, triangles: Int32Array, n_vertices: int) -> None:
        """Write triangles of shape (m, 3), int32, in canonical order."""
        own = np.array(triangles, dtype=np.int32)
        status = _code_triangles(self.coder, self.data, own, n_vertices)
        assert status == OK, "a checked mesh is always coded"

    def levels(self, levels: Int32Array, hierarchy: Hierarchy, lattice: ColorLattice) -> None:
        """Write levels of shape (n, c), int32, of vertices in raster order."""
        own = np.array(levels, dtype=np.int32)
        status = _code_levels(self.coder, self.data, own, hierarchy, lattice)
        assert status == OK, "a checked mesh is always coded"

    def flips(self, flips: Flips, implied: Int32Array, mesh: Mesh) -> None:
        """Write the flips that lead from the Delaunay triangles to those of a mesh."""
        status, _ = _code_flips(self.coder, self.data, mesh.vertices, implied, mesh.levels, flips)
        assert status == OK, "flips that were found are always coded"

    def finish(self) -> bytes:
        """Bytes that were written, up to the capacity, without the zeros that may be cut off."""
        length = range_coder.finish(self.coder, self.data)
        return self.data[: max(length, self.n_bytes - _CUT_BYTES)].tobytes()

    @property
    def n_bytes(self) -> int:
        """Number of bytes written so far, also beyond the capacity."""
        return int(self.coder[range_coder.POSITION])


def encode(write: Callable[[Encoder], None]) -> bytes:
    """Bytes that `write` lets an encoder write; it is called again if they exceed the capacity."""
    capacity = 1 << 16
    while True:
        encoder = Encoder(capacity)
        write(encoder)
        content = encoder.finish()
        if encoder.n_bytes <= capacity:
            return content
        capacity = encoder.n_bytes


class Decoder:
    """Reads the parts of a mesh from one stream, in the order in which they were written.

    Parameters
    ----------
    content : bytes
        The whole stream.
    offset : int
        Where it starts in the file, for the errors.
    is_whole : bool
        Whether the stream must be complete. Otherwise it was cut off: the positions must be there,
        and what follows is read as far as it goes.
    """

    def __init__(self, content: bytes, offset: int, *, is_whole: bool = True) -> None:
        self.coder = np.zeros(range_coder.N_FIELDS, dtype=np.int64)
        self.data = np.frombuffer(bytearray(content), dtype=np.uint8)
        self.offset = offset
        self.is_whole = is_whole
        self.sizes: dict[str, int] = {}
        range_coder.start(self.coder, self.data, 1)
        if not is_whole:
            self.coder[range_coder.LIMIT] = len(content)

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

    def levels(self, hierarchy: Hierarchy, lattice: ColorLattice) -> Int32Array:
        """Levels of shape (n, c), int32, within the lattice's bounds."""
        levels = np.zeros((len(hierarchy.order), lattice.n_components), dtype=np.int32)
        self._end("colors", _code_levels(self.coder, self.data, levels, hierarchy, lattice))
        return levels

    def flips(self, vertices: Int32Array, implied: Int32Array, levels: Int32Array) -> Int32Array:
        """Triangles of shape (m, 3), int32, in canonical order."""
        none = Flips(np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64))
        status, triangles = _code_flips(self.coder, self.data, vertices, implied, levels, none)
        self._end("triangles", status)
        return sort_triangles(triangles, len(vertices))

    def finish(self) -> dict[str, int]:
        """Bytes of each part, rounded so that they add up to the content, which must end here."""
        read, length = int(self.coder[range_coder.POSITION]), len(self.data)
        if read < length:
            part = list(self.sizes)[-1]
            unused = f"{length - read} bytes follow the coded {part}"
            raise FormatError(part, unused, self.offset + read)
        self.sizes[list(self.sizes)[-1]] += length - sum(self.sizes.values())
        return self.sizes

    def _end(self, part: str, status: int) -> None:
        """Refuse a part that ends too early or holds a bad number, and note its size."""
        read, length = int(self.coder[range_coder.POSITION]), len(self.data)
        missing = read - length - (_CUT_BYTES if self.is_whole else 0)
        if missing > 0 and (self.is_whole or part == "positions"):
            raise FormatError(part, f"the mesh ends within the {part}", self.offset + length)
        if status != OK:
            where = self.offset + min(read, length)
            raise FormatError(part, f"the coded {part} hold a number out of range", where)
        # What the coder has narrowed its range by since the start is what the parts took so far.
        so_far = read - log2(self.coder[range_coder.RANGE]) / 8
        self.sizes[part] = min(round(so_far), length) - sum(self.sizes.values())


def _code_positions(
    coder: Int64Array, data: UInt8Array, points: Int32Array, columns: int, rows: int
) -> int:
    model = _split_model().copy()
    code_positions(coder, data, model, points, columns, rows)
    return OK


def _code_triangles(
    coder: Int64Array, data: UInt8Array, triangles: Int32Array, n_vertices: int
) -> int:
    model = even_model(3 * NUMBER_CONTEXTS)
    return code_triangles(coder, data, model, triangles, n_vertices)


def _code_levels(
    coder: Int64Array,
    data: UInt8Array,
    levels: Int32Array,
    hierarchy: Hierarchy,
    lattice: ColorLattice,
) -> int:
    model = _level_model(lattice.n_components).copy()
    return code_levels(coder, data, model, *hierarchy, levels, *lattice.level_bounds())


def _code_flips(
    coder: Int64Array,
    data: UInt8Array,
    vertices: Int32Array,
    implied: Int32Array,
    levels: Int32Array,
    flips: Flips,
) -> tuple[int, Int32Array]:
    """Status of the coder, and the triangles that the flips lead to, shape (m, 3), int32."""
    model = initial_flip_model()
    points = vertices.astype(np.int64)
    twins = find_twins(implied, len(vertices))
    luma = np.ascontiguousarray(levels[:, 0])
    origin = implied.ravel().astype(np.int64)
    status = code_flips(coder, data, model, points, luma, origin, twins, *flips)
    return status, origin.reshape(-1, 3).astype(np.int32)


def _kd_tree_keys(vertices: Int32Array, columns: int, rows: int) -> Int64Array:
    """Integers that sort vertices in the order in which the kd-tree reaches them, (n,)."""
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
