"""The coded payloads: positions, triangles and colours (spec, sections 6 to 8)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from vmesh.arrays import Int32Array, Int64Array, UInt8Array
from vmesh.color_lattice import ColorLattice
from vmesh.errors import FormatError
from vmesh.kernels import entropy
from vmesh.mesh import raster_keys

Code = Callable[[Int64Array, UInt8Array], int]
"""Codes one payload with a coder and its data, in either direction; returns a status."""


def encode_positions(vertices: Int32Array, columns: int, rows: int) -> bytes:
    """Payload of VERT: distinct vertices of shape (n, 2), int32, in any order."""
    points = vertices[np.argsort(_halving_keys(vertices, columns, rows))]
    return _encode(lambda coder, data: _code_positions(coder, data, points, columns, rows))


def decode_positions(payload: bytes, offset: int, n: int, columns: int, rows: int) -> Int32Array:
    """Vertices of a VERT payload in raster order, shape (n, 2), int32, distinct."""
    points = np.zeros((n, 2), dtype=np.int32)

    def code(coder: Int64Array, data: UInt8Array) -> int:
        return _code_positions(coder, data, points, columns, rows)

    _decode(payload, offset, "positions", code)
    result: Int32Array = points[np.argsort(raster_keys(points))]
    return result


def encode_triangles(triangles: Int32Array, n_vertices: int) -> bytes:
    """Payload of TRIS: triangles of shape (m, 3), int32, in canonical order."""
    canonical = np.array(triangles, dtype=np.int32)
    return _encode(lambda coder, data: _code_triangles(coder, data, canonical, n_vertices))


def decode_triangles(payload: bytes, offset: int, m: int, n_vertices: int) -> Int32Array:
    """Triangles of a TRIS payload, shape (m, 3), int32, indices below `n_vertices`."""
    triangles = np.zeros((m, 3), dtype=np.int32)

    def code(coder: Int64Array, data: UInt8Array) -> int:
        return _code_triangles(coder, data, triangles, n_vertices)

    _decode(payload, offset, "triangles", code)
    return triangles


def encode_levels(
    levels: Int32Array, vertices: Int32Array, triangles: Int32Array, lattice: ColorLattice
) -> bytes:
    """Payload of COLR: levels of shape (n, c), int32, for vertices in raster order."""
    own = np.array(levels, dtype=np.int32)
    return _encode(lambda coder, data: _code_levels(coder, data, vertices, triangles, own, lattice))


def decode_levels(
    payload: bytes,
    offset: int,
    vertices: Int32Array,
    triangles: Int32Array,
    lattice: ColorLattice,
) -> Int32Array:
    """Levels of a COLR payload, shape (n, c), int32, within the lattice's bounds.

    The mesh of `vertices` and `triangles` has to have passed its check.
    """
    levels = np.zeros((len(vertices), lattice.n_components), dtype=np.int32)

    def code(coder: Int64Array, data: UInt8Array) -> int:
        return _code_levels(coder, data, vertices, triangles, levels, lattice)

    _decode(payload, offset, "colors", code)
    return levels


def _encode(code: Code) -> bytes:
    """Bytes that a coding function writes; where there is too little room it writes twice."""
    room = 1 << 16
    while True:
        coder = np.zeros(entropy.N_FIELDS, dtype=np.int64)
        data = np.zeros(room, dtype=np.uint8)
        entropy.start(coder, data, 0)
        status = code(coder, data)
        assert status == entropy.OK, "a checked mesh is always coded"
        length = entropy.finish(coder, data)
        if coder[entropy.POSITION] <= room:
            return data[:length].tobytes()
        room = int(coder[entropy.POSITION])


def _decode(payload: bytes, offset: int, name: str, code: Code) -> None:
    """Let a coding function read a payload to its end."""
    coder = np.zeros(entropy.N_FIELDS, dtype=np.int64)
    data = np.frombuffer(bytearray(payload), dtype=np.uint8)
    entropy.start(coder, data, 1)
    status = code(coder, data)
    read = int(coder[entropy.POSITION])
    if status != entropy.OK:
        where = offset + min(read, len(payload))
        raise FormatError(name, f"the coded {name} hold a number out of range", where)
    if read < len(payload):
        unused = len(payload) - read
        raise FormatError(name, f"{unused} bytes follow the coded {name}", offset + read)


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
