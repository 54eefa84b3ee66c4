"""One photograph of a batch: plain data and a plain function, for any process or machine."""

from __future__ import annotations

import io
import threading
import time
from dataclasses import asdict, dataclass, fields, is_dataclass
from hashlib import blake2b
from pathlib import Path
from typing import Any, Final, Literal

from vmesh.codec.layout import FILE_SUFFIX, is_vmesh
from vmesh.encoder.settings import Settings
from vmesh.errors import ImageError, describe
from vmesh.files import Times, atomic_output
from vmesh.formats.metadata.privacy import Strip
from vmesh.formats.picture.options import DEFAULT_OPTIONS, PictureOptions
from vmesh.limits import DEFAULT_LIMITS, Limits
from vmesh.mesh import Mesh

WRITING: Final = threading.Lock()
"""Held while a file is written: no time to end the process."""


@dataclass(frozen=True, slots=True)
class Recipe:
    """Recipe of a batch: how every source is worked on.

    Parameters
    ----------
    settings : Settings
        Of the encoder.
    reading : PictureOptions
        How photographs are read.
    strip : {"none", "private", "all"}, optional
        Metadata that are left out; unless given, what suits each format.
    limits : Limits
        On the sources and on their meshes.
    """

    settings: Settings
    reading: PictureOptions = DEFAULT_OPTIONS
    strip: Strip | None = None
    limits: Limits = DEFAULT_LIMITS

    def digest(self, *, of_mesh: bool) -> str:
        """Digest of what decides on the outputs of a photograph, or of a mesh.

        What is as by default does not count, so that an option that is new changes nothing.
        """
        default = Recipe(Settings())
        deciding = [item.name for item in fields(self) if item.name != "limits"]
        parts = ["strip"] if of_mesh else deciding
        chosen = {
            f"{part}.{name}": value
            for part in parts
            for name, value in _values(getattr(self, part)).items()
            if value != _values(getattr(default, part)).get(name) and name != "threads"
        }
        return blake2b(repr(sorted(chosen.items())).encode(), digest_size=8).hexdigest()


def _values(part: Any) -> dict[str, Any]:
    """Values of the fields of a part of a recipe."""
    return asdict(part) if is_dataclass(part) and not isinstance(part, type) else {"": part}


@dataclass(frozen=True, slots=True)
class Task:
    """A source and what is to be made of it.

    Parameters
    ----------
    source : str
        Path of a photograph or of a ``.vmesh`` file.
    targets : tuple of str
        Paths to be written, each in the format that its ending names.
    recipe : Recipe
    mesh : str, optional
        Path of the mesh of the source, where there is one already.
    replace : bool
        Whether what has been written under those paths meanwhile gives way.
    times : tuple of int, optional
        Times that the outputs get.
    """

    source: str
    targets: tuple[str, ...]
    recipe: Recipe
    mesh: str | None = None
    replace: bool = True
    times: Times | None = None


@dataclass(frozen=True, slots=True)
class Outcome:
    """Outcome of a task: what became of its source.

    Parameters
    ----------
    source : str
        Its path.
    status : {"done", "skipped", "failed"}
        Skipped is what has all its outputs already.
    outputs : tuple of str
        Paths that were written.
    bytes : int
        Their size together.
    seconds : float
        The time it took.
    error : str, optional
        What went wrong, in one sentence.
    notes : tuple of str
        What is to be told of the source though it was read.
    trouble : str, optional
        What hindered the process that worked on it, in one sentence.
    """

    source: str
    status: Literal["done", "skipped", "failed"]
    outputs: tuple[str, ...] = ()
    bytes: int = 0
    seconds: float = 0.0
    error: str | None = None
    notes: tuple[str, ...] = ()
    trouble: str | None = None


def run(task: Task) -> Outcome:
    """Make what a task asks for; what goes wrong is told in the outcome and not raised."""
    from vmesh.kernels.jit import take_trouble

    started = time.perf_counter()
    written: list[str] = []
    notes: list[str] = []
    error = None
    try:
        mesh = _mesh_of(task, notes)
        for target in task.targets:
            _write(mesh, target, task)
            written.append(target)
    except Exception as problem:
        # Whatever it is, the other files of the batch have nothing to do with it.
        error = describe(problem)
    return Outcome(
        task.source,
        "done" if error is None else "failed",
        tuple(written),
        sum(Path(path).stat().st_size for path in written),
        round(time.perf_counter() - started, 3),
        error,
        tuple(notes),
        take_trouble(),
    )


def _mesh_of(task: Task, notes: list[str]) -> Mesh:
    """The mesh of the source: encoded, or read where there is one. Adds what is to be told."""
    if task.mesh is not None:
        return _load(Path(task.mesh).read_bytes(), task.recipe.limits)
    data = Path(task.source).read_bytes()
    if not is_vmesh(data) and Path(task.source).suffix.lower() != FILE_SUFFIX:
        return _encode(data, task.recipe, notes)
    if any(Path(target).suffix == FILE_SUFFIX for target in task.targets):
        raise ImageError("this is a .vmesh file, a photograph is needed")
    return _load(data, task.recipe.limits)


def _load(data: bytes, limits: Limits) -> Mesh:
    from vmesh.codec.reader import loads

    return loads(data, limits=limits)


def _encode(data: bytes, recipe: Recipe, notes: list[str]) -> Mesh:
    from vmesh.encoder.pipeline import encode_with
    from vmesh.formats.metadata.privacy import stripped
    from vmesh.formats.picture.picture import read_picture

    if not data:
        raise ImageError("the file is empty")
    picture = read_picture(io.BytesIO(data), options=recipe.reading, limits=recipe.limits)
    notes += picture.notes
    metadata = stripped(picture.metadata, recipe.strip or "none")
    mesh = encode_with(picture.array, recipe.settings, metadata=metadata)
    recipe.limits.check_vertices(mesh.n_vertices)
    return mesh


def _write(mesh: Mesh, target: str, task: Task) -> None:
    """Write a mesh in the format that the ending of a path names, with its folders."""
    from vmesh.codec.stream import dump
    from vmesh.formats.registry import format_of, write_mesh

    path, content, recipe = Path(target), io.BytesIO(), task.recipe
    if path.suffix == FILE_SUFFIX:
        dump(mesh, content)
    else:
        write_mesh(mesh, content, format_of(path), limits=recipe.limits, strip=recipe.strip)
    path.parent.mkdir(parents=True, exist_ok=True)
    with WRITING, atomic_output(path, replace=task.replace, times=task.times) as stream:
        stream.write(content.getbuffer())
