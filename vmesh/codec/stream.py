"""Meshes from and to paths and open files."""

from __future__ import annotations

import os
from pathlib import Path
from typing import BinaryIO

from vmesh.codec.reader import loads
from vmesh.codec.writer import dumps
from vmesh.files import atomic_output
from vmesh.limits import DEFAULT_LIMITS, Limits
from vmesh.mesh import Mesh

Source = str | os.PathLike[str] | BinaryIO


def load(source: Source, *, limits: Limits = DEFAULT_LIMITS, allow_partial: bool = False) -> Mesh:
    """Mesh of a ``.vmesh`` file, given by its path or as an open binary file.

    Raises
    ------
    FormatError, LimitError
        As :func:`vmesh.loads`.
    OSError
        If the file cannot be read.
    """
    return loads(_read(source), limits=limits, allow_partial=allow_partial)


def _read(source: Source) -> bytes:
    """All bytes of a path or of an open binary file."""
    if isinstance(source, str | os.PathLike):
        return Path(source).read_bytes()
    return source.read()


def dump(mesh: Mesh, target: Source) -> None:
    """Write the ``.vmesh`` file of a mesh to a path or into an open binary file.

    A file at that path is replaced only when the new one is complete.

    Raises
    ------
    ValueError
        As :func:`vmesh.dumps`.
    OSError
        If the file cannot be written.
    """
    data = dumps(mesh)
    if isinstance(target, str | os.PathLike):
        with atomic_output(target) as stream:
            stream.write(data)
    else:
        target.write(data)
