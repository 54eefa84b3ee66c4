"""Bytes of a .vmesh file -> Mesh; written for hostile files."""

from __future__ import annotations

import warnings
from collections import Counter
from typing import NamedTuple

from vmesh.codec.container import Container, read_file
from vmesh.codec.layout import SIGNATURE
from vmesh.codec.mesh_coder import decode_mesh
from vmesh.codec.metadata import read_metadata
from vmesh.codec.policy import Partial, Policy, Strict
from vmesh.codec.tiles import fill, join
from vmesh.errors import FormatError, PartialFileWarning
from vmesh.grid import Grid
from vmesh.limits import DEFAULT_LIMITS, Limits
from vmesh.mesh import Mesh


def loads(
    data: bytes | bytearray | memoryview,
    *,
    limits: Limits = DEFAULT_LIMITS,
    allow_partial: bool = False,
) -> Mesh:
    """Mesh of the bytes of a ``.vmesh`` file, in canonical order.

    Parameters
    ----------
    data : bytes-like
        A whole file.
    limits : Limits
        What the file may ask for; checked before anything is allocated.
    allow_partial : bool
        Whether to take a file that was cut off, if all positions are there: some 40 % of it. The
        colours that are missing are predicted from those that came before, which is a whole
        picture, but a coarser one, and a :class:`PartialFileWarning` says so. Of a file in tiles
        one tile has to be there: those that are missing or damaged are filled in from what is
        around them.

    Raises
    ------
    FormatError
        If the bytes are not a conforming file; `code` and `offset` say what and where.
    LimitError
        If they are, but ask for more than `limits` allow.
    """
    reading = read(data, Partial() if allow_partial else Strict(), limits=limits)
    for error in reading.errors[:1]:
        is_tiled = reading.mesh.tile is not None
        what = "tiles that are lost are filled in" if is_tiled else "what is missing is predicted"
        warnings.warn(PartialFileWarning(f"{error.message}: {what}"), stacklevel=2)
    return reading.mesh


class Reading(NamedTuple):
    """Reading of a file: its mesh, the bytes of its parts, and errors that were no obstacle.

    Attributes
    ----------
    mesh : Mesh
        In canonical order.
    sizes : dict
        Bytes of ``positions``, of ``colors``, and of ``triangles`` if they are not implied, over
        all tiles. They share a stream: a byte on the bound between two parts belongs to one of
        them.
    errors : list of FormatError
        Errors that the policy noted instead of raising them.
    """

    mesh: Mesh
    sizes: dict[str, int]
    errors: list[FormatError]


def read(
    data: bytes | bytearray | memoryview,
    policy: Policy | None = None,
    *,
    limits: Limits = DEFAULT_LIMITS,
) -> Reading:
    """Mesh of the bytes of a ``.vmesh`` file, by a policy on what is damaged.

    Parameters
    ----------
    data : bytes-like
        A whole file.
    policy : Policy, optional
        :class:`vmesh.codec.policy.Strict` unless given. Its errors are at hand also if the reading
        ends with an exception.
    limits : Limits
        What the file may ask for.

    Raises
    ------
    FormatError
        If the policy raises it, or nothing can be read after it.
    LimitError
        If the file asks for more than `limits` allow.
    """
    chosen = policy or Strict()
    mesh, sizes = _decode(read_file(bytes(memoryview(data)), chosen), limits, chosen)
    return Reading(mesh, sizes, chosen.errors)


def _decode(container: Container, limits: Limits, policy: Policy) -> tuple[Mesh, dict[str, int]]:
    """Mesh of the chunks of a file, and the bytes of its parts."""
    header, found = container.header, container.found
    limits.check_pixels(header.width, header.height)
    limits.check_vertices(header.n_vertices)
    n_vertices = sum(own.n_vertices for own, _ in found)
    limits.check_vertices(n_vertices)
    limits.check_density(n_vertices, sum(len(chunk.content) for _, chunk in found))
    metadata = read_metadata(container.ancillary, limits, policy)
    if container.grid is None:
        ((own, chunk),) = found
        mesh, sizes = decode_mesh(chunk, own)
    else:
        limits.check_tiles(container.grid.n_tiles)
        mesh, sizes = _decode_tiles(container, container.grid, policy)
    return mesh.replaced(metadata=metadata), sizes


def _decode_tiles(container: Container, grid: Grid, policy: Policy) -> tuple[Mesh, dict[str, int]]:
    """Mesh of the tiles, those that are lost filled in, and the bytes of its parts."""
    pieces: list[Mesh | None] = [None] * grid.n_tiles
    sizes: Counter[str] = Counter()
    for number, coded in enumerate(container.coded):
        if coded is not None:
            try:
                pieces[number], parts = decode_mesh(coded.chunk, coded.header)
                sizes.update(parts)
            except FormatError as error:
                policy.lose(error)
    if not any(pieces):
        raise FormatError("tiles", "no tile of the file can be read", 0)
    mesh = join(container, grid, pieces)
    if not all(pieces):
        tiles = zip(grid.tiles(), pieces, strict=True)
        whole = [piece or fill(mesh, tile) for tile, piece in tiles]
        return join(container, grid, whole), dict(sizes)
    if mesh.n_vertices != container.header.n_vertices:
        text = f"expected {container.header.n_vertices} vertices, the tiles hold {mesh.n_vertices}"
        raise FormatError("tiles", text, len(SIGNATURE))
    return mesh, dict(sizes)
