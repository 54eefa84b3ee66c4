"""A photograph, its mesh, and what was measured on both."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from typing import Any, Final

from vmesh.arrays import SampleArray, UInt8Array
from vmesh.codec.contents import describe
from vmesh.codec.reader import loads
from vmesh.codec.writer import dumps
from vmesh.encoder.pipeline import count_steps, encode
from vmesh.encoder.settings import Settings
from vmesh.formats.picture import Picture, flatten
from vmesh.formats.raster import render
from vmesh.limits import Limits
from vmesh.mesh import Mesh
from vmesh.metrics import compare
from vmesh.progress import Progress
from vmesh.report.mesh_curve import SHARES, mesh_curve, without_goal
from vmesh.report.rivals import RIVALS, Curve

_SAMPLE_SIDE: Final = 32


@dataclass(frozen=True, slots=True)
class Study:
    """What a report says of a photograph.

    Parameters
    ----------
    name : str
        Of the photograph's file.
    original : ndarray
        Shape (h, w, 3), uint8: the photograph in 8 bits on white.
    mesh : Mesh
    data : bytes
        Its ``.vmesh`` file.
    figures : dict
        What ``vmesh info --parts`` says of the file.
    closeness : dict
        What :func:`vmesh.metrics.compare` says of the mesh.
    seconds : dict
        Stage -> how long it took, without the compilation of a first run.
    curves : tuple of Curve
        All of files without metadata. That of vmesh comes first; the others' files are each the
        largest that is no larger than one of its.
    """

    name: str
    original: UInt8Array
    mesh: Mesh
    data: bytes
    figures: dict[str, Any]
    closeness: dict[str, float]
    seconds: dict[str, float]
    curves: tuple[Curve, ...]


def study(
    name: str,
    picture: Picture,
    settings: Settings,
    *,
    limits: Limits,
    progress: Progress,
) -> Study:
    """Encode a photograph at the size asked for and at others, and by other codecs.

    Raises
    ------
    ValueError, LimitError
        If the size or PSNR asked for cannot be met, or the mesh is more than `limits` allow.
    """
    array, original = picture.array, flatten(picture.array)
    _compile(array, settings, limits)
    seconds: dict[str, float] = {}
    with _timed(seconds, "encode"):
        mesh = encode(array, metadata=picture.metadata, progress=progress, **asdict(settings))
    limits.check_vertices(mesh.n_vertices)
    with _timed(seconds, "write"):
        data = dumps(mesh)
    with _timed(seconds, "read"):
        loads(data, limits=limits)
    with _timed(seconds, "render"):
        rendered = render(mesh, limits=limits)
    closeness = compare(original, flatten(rendered, mesh.depth))
    own = mesh_curve(array, original, mesh, settings, limits, progress)
    curves = (own, *_rivals_of(own, original, progress))
    figures = describe(data, by_parts=True, limits=limits)
    return Study(name, original, mesh, data, figures, closeness, seconds, curves)


def count_study_steps(settings: Settings) -> int:
    """About how often a study with these settings reports progress."""
    return len(SHARES) * count_steps(settings) + len(RIVALS)


def _compile(array: SampleArray, settings: Settings, limits: Limits) -> None:
    """Run every stage on a corner of the picture: compiling, once, is no part of its timings."""
    corner = array[:_SAMPLE_SIDE, :_SAMPLE_SIDE]
    mesh = encode(corner, **asdict(without_goal(settings)))
    render(loads(dumps(mesh), limits=limits), limits=limits)


@contextmanager
def _timed(seconds: dict[str, float], stage: str) -> Iterator[None]:
    """Note how long the block takes."""
    started = time.perf_counter()
    yield
    seconds[stage] = time.perf_counter() - started


def _rivals_of(own: Curve, original: UInt8Array, progress: Progress) -> Iterator[Curve]:
    """What other codecs make of the bytes of a curve's files."""
    budgets = [point.n_bytes for point in own.points]
    for rival in RIVALS:
        progress(rival.name)
        yield rival.curve_of(original, budgets)
