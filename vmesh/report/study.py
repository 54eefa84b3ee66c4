"""A photograph, its mesh, and what was measured on both."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any, Final

import numpy.typing as npt

from vmesh.arrays import SampleArray, UInt8Array
from vmesh.codec.reader import loads
from vmesh.codec.summary import describe
from vmesh.codec.writer import dumps
from vmesh.encoder.image import as_image
from vmesh.encoder.pipeline import count_steps, encode_with
from vmesh.encoder.settings import (
    DEFAULT_EFFORT,
    ColorMode,
    Diffusion,
    Method,
    Sampler,
    Settings,
)
from vmesh.formats.color.conversion import to_srgb
from vmesh.formats.picture.conversion import flatten
from vmesh.formats.raster.rendering import render
from vmesh.limits import DEFAULT_LIMITS, Limits
from vmesh.mesh import Mesh, Metadata
from vmesh.metrics import compare
from vmesh.progress import Progress, silent
from vmesh.report.mesh_curve import SHARES, mesh_curve
from vmesh.report.rivals import RIVALS, Curve

_SAMPLE_SIDE: Final = 32


@dataclass(frozen=True, slots=True)
class Study:
    """Study of a photograph: its mesh, and what was measured on both.

    Parameters
    ----------
    name : str
        Of the photograph's file.
    original : ndarray
        Shape (h, w, 3), uint8: the photograph in 8 bits of sRGB on white.
    mesh : Mesh
    data : bytes
        Its ``.vmesh`` file.
    figures : dict
        What ``vmesh info --parts`` says of the file.
    closeness : dict
        What :func:`vmesh.metrics.compare` says of the mesh, in sRGB.
    seconds : dict
        Stage -> how long it took, without the compilation of a first run.
    curves : tuple of Curve
        All of files without metadata. That of vmesh comes first; the others' files are each the
        largest that is no larger than one of its.
    """

    name: str
    original: UInt8Array = field(repr=False)
    mesh: Mesh
    data: bytes = field(repr=False)
    figures: dict[str, Any] = field(repr=False)
    closeness: dict[str, float]
    seconds: dict[str, float]
    curves: tuple[Curve, ...]

    def _repr_html_(self) -> str:
        """The page on the photograph, for notebooks."""
        from vmesh.report.page import frame_of

        return frame_of(self)


def study(
    photograph: npt.ArrayLike,
    *,
    name: str = "photograph",
    metadata: Metadata | None = None,
    limits: Limits = DEFAULT_LIMITS,
    method: Method = "adaptive",
    quality: int | None = None,
    target_size: int | None = None,
    target_psnr: float | None = None,
    vertices: int | None = None,
    density: float | None = None,
    effort: int = DEFAULT_EFFORT,
    gamma: float = 1.0,
    sampler: Sampler = "multiclass",
    diffusion: Diffusion = "zhou-fang",
    colors: ColorMode = "fitted",
    color_step: int | None = None,
    tile: int | None = None,
    seed: int = 0,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Study:
    """Study of a photograph: encoded at the size asked for, at others, and by other codecs.

    A notebook shows the result as the page of ``vmesh report``, for which matplotlib is needed.

    Parameters
    ----------
    photograph : array_like
        As :func:`vmesh.encode` takes it.
    name : str
        Heading of its figures.
    metadata : Metadata, optional
        Metadata that travel with the picture.
    limits : Limits
        Limits on the mesh.
    method, quality, target_size, target_psnr, vertices, density, effort, gamma, sampler, \
diffusion, colors, color_step, tile, seed, threads
        As for :func:`vmesh.encode`.
    progress : callable, optional
        Called with the name of each stage as it begins, and again as it goes on.

    Returns
    -------
    Study

    Raises
    ------
    ValueError, TypeError, LimitError
        If the array or a setting is not as described, the size or PSNR asked for cannot be met, or
        the mesh is more than `limits` allow.
    """
    settings = Settings(
        method=method,
        quality=quality,
        target_size=target_size,
        target_psnr=target_psnr,
        vertices=vertices,
        density=density,
        effort=effort,
        gamma=gamma,
        sampler=sampler,
        diffusion=diffusion,
        colors=colors,
        color_step=color_step,
        tile=tile,
        seed=seed,
        threads=threads,
    )
    return study_with(
        photograph, settings, name=name, metadata=metadata, limits=limits, progress=progress
    )


def study_with(
    photograph: npt.ArrayLike,
    settings: Settings,
    *,
    name: str = "photograph",
    metadata: Metadata | None = None,
    limits: Limits = DEFAULT_LIMITS,
    progress: Progress | None = None,
) -> Study:
    """Study of a photograph by settings that are made already; the rest is as for `study`."""
    array, report = as_image(photograph), progress or silent
    profile = b"" if metadata is None else metadata.icc
    original = flatten(to_srgb(array, profile))
    _compile(array, settings, limits)
    seconds: dict[str, float] = {}
    with _timed(seconds, "encode"):
        mesh = encode_with(array, settings, metadata=metadata, progress=report)
    limits.check_vertices(mesh.n_vertices)
    with _timed(seconds, "write"):
        data = dumps(mesh)
    with _timed(seconds, "read"):
        loads(data, limits=limits)
    with _timed(seconds, "render"):
        rendered = render(mesh, limits=limits)
    shown = flatten(to_srgb(rendered, profile, mesh.depth), mesh.depth)
    closeness = compare(original, shown)
    own = mesh_curve(array, original, mesh, settings, limits, report)
    curves = (own, *_rivals_of(own, original, report))
    figures = describe(data, by_parts=True, limits=limits)
    return Study(name, original, mesh, data, figures, closeness, seconds, curves)


def count_study_steps(settings: Settings) -> int:
    """Approximate number of progress reports of a study with these settings."""
    return len(SHARES) * count_steps(settings) + len(RIVALS)


def _compile(array: SampleArray, settings: Settings, limits: Limits) -> None:
    """Run every stage on a corner of the picture: compiling, once, is no part of its timings."""
    corner = array[:_SAMPLE_SIDE, :_SAMPLE_SIDE]
    mesh = encode_with(corner, settings.with_goal())
    render(loads(dumps(mesh), limits=limits), limits=limits)


@contextmanager
def _timed(seconds: dict[str, float], stage: str) -> Iterator[None]:
    """Note how long the block takes."""
    started = time.perf_counter()
    yield
    seconds[stage] = time.perf_counter() - started


def _rivals_of(own: Curve, original: UInt8Array, progress: Progress) -> Iterator[Curve]:
    """Curves of other codecs, at the sizes of a curve's files."""
    budgets = [point.n_bytes for point in own.points]
    for rival in RIVALS:
        progress(rival.name)
        yield rival.curve_of(original, budgets)
