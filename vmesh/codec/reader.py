"""Bytes of a .vmesh file -> Mesh; written for hostile files."""

from __future__ import annotations

import warnings

from vmesh.codec import layout
from vmesh.codec.layout import Chunk, Header
from vmesh.codec.metadata import read_metadata
from vmesh.codec.payloads import decode_mesh
from vmesh.errors import FormatError, PartialFileWarning
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
        picture, but a coarser one, and a :class:`PartialFileWarning` says so.

    Raises
    ------
    FormatError
        If the bytes are not a conforming file; `code` and `offset` say what and where.
    LimitError
        If they are, but ask for more than `limits` allow.
    """
    if not allow_partial:
        return measure(data, limits=limits)[0]
    cuts: list[FormatError] = []

    def pass_over(error: FormatError) -> None:
        """Note that the file was cut off; all else is an error."""
        if error.code != "truncated":
            raise error
        cuts.append(error)

    mesh, _ = measure(data, limits=limits, complain=pass_over)
    for cut in cuts:
        text = f"{cut.message}: what is missing is predicted"
        warnings.warn(PartialFileWarning(text), stacklevel=2)
    return mesh


def measure(
    data: bytes | bytearray | memoryview,
    *,
    limits: Limits = DEFAULT_LIMITS,
    complain: layout.Complain = layout.refuse,
) -> tuple[Mesh, dict[str, int]]:
    """Mesh of the bytes of a ``.vmesh`` file, and how many of them its parts take.

    Parameters and errors are those of :func:`loads`; `complain` is that of `layout.read_file`.

    Returns
    -------
    Mesh
    dict
        Bytes of ``positions``, of ``colors``, and of ``triangles`` if they are not implied. They
        share one stream: a byte on the bound between two parts belongs to one of them.
    """
    return read_chunks(*layout.read_file(bytes(memoryview(data)), complain), limits, complain)


def read_chunks(
    header: Header, chunks: list[Chunk], limits: Limits, complain: layout.Complain
) -> tuple[Mesh, dict[str, int]]:
    """Mesh of the header and the chunks of a file, and the bytes of its parts, as `measure`."""
    limits.check_pixels(header.width, header.height)
    limits.check_vertices(header.n_vertices)
    *ancillary, coded = chunks
    limits.check_density(header.n_vertices, len(coded.content))
    metadata = read_metadata(ancillary, limits, complain)
    mesh, sizes = decode_mesh(coded, header)
    return mesh.replaced(metadata=metadata), sizes
