"""One hostile file tried: everything that has to hold whatever its bytes are."""

from __future__ import annotations

import hashlib
import warnings
from typing import Final, NamedTuple

from vmesh.codec.reader import loads
from vmesh.codec.writer import dumps
from vmesh.errors import FormatError, LimitError, PartialFileWarning
from vmesh.formats.raster.rendering import render
from vmesh.limits import Limits
from vmesh.mesh import Mesh

# A count of up to 2**31 vertices is a changed byte away: so a trial takes little time.
SMALL: Final = Limits(
    max_pixels=1 << 22, max_vertices=1 << 14, max_tiles=1 << 8, max_metadata=1 << 20
)
_MAX_DRAWN: Final = 1 << 12


class Outcome(NamedTuple):
    """What became of a file."""

    code: str
    """``loaded``, ``limit``, or the code of the error that refuses it."""
    detail: str
    """A digest of its mesh and picture, or what the error says."""


def try_file(data: bytes, *, allow_partial: bool = False) -> Outcome:
    """Read some bytes: an error of vmesh, or a mesh that is valid, stored again and drawn.

    Raises
    ------
    AssertionError, Exception
        If the reader breaks a promise.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", PartialFileWarning)
            mesh = loads(data, limits=SMALL, allow_partial=allow_partial)
    except FormatError as error:
        assert 0 <= error.offset <= len(data), "an error lies within the file"
        return Outcome(error.code, str(error))
    except LimitError as error:
        return Outcome("limit", str(error))
    mesh.check()
    assert loads(dumps(mesh)) == mesh, "a mesh that was read can be stored"
    return Outcome("loaded", _digest(mesh))


def _digest(mesh: Mesh) -> str:
    """A digest of a mesh, and of its picture if that is small."""
    drawn = render(mesh).tobytes() if mesh.width * mesh.height <= _MAX_DRAWN else b""
    parts = (mesh.vertices.tobytes(), mesh.triangles.tobytes(), mesh.levels.tobytes(), drawn)
    return hashlib.sha256(b"".join((*parts, repr(mesh.metadata).encode()))).hexdigest()
