"""Conversion to a vector format, common to ``vmesh to-svg``, ``to-pdf`` and ``to-html``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Unpack

from vmesh.cli.jobs import Job
from vmesh.cli.progress import show_progress
from vmesh.cli.streams import read_mesh_or_photograph, read_weights
from vmesh.encoder.settings import Settings
from vmesh.formats.picture.options import PictureOptions
from vmesh.formats.registry import ExportOptions, Format, write_mesh
from vmesh.limits import Limits

if TYPE_CHECKING:
    from vmesh.formats.picture.picture import Picture
    from vmesh.mesh import Mesh
    from vmesh.progress import Progress


def convert(
    job: Job,
    wanted: Format,
    settings: Settings,
    reading: PictureOptions,
    limits: Limits,
    *,
    quiet: bool,
    mask: str | None = None,
    n_stages: int = 0,
    fit_to: Picture | None = None,
    **options: Unpack[ExportOptions],
) -> None:
    """Write a .vmesh file, or a photograph encoded on the way, in a vector format.

    `mask` names a picture that says what matters in a photograph. `n_stages` is how many the writer
    reports; 0 for one that reports none. `fit_to` is a photograph, in whatever space, for the
    option `fit`. Other options are those of the format.
    """
    from vmesh.encoder.pipeline import count_steps
    from vmesh.formats.color.conversion import mesh_in_srgb, to_srgb
    from vmesh.mesh import Mesh

    given = read_mesh_or_photograph(job.source, reading, limits)
    n_steps = 1 if isinstance(given, Mesh) else 1 + count_steps(settings)
    with show_progress(f"converting{job.place}", n_steps + n_stages, quiet=quiet) as report:
        mesh = mesh_of(given, settings, mask, limits, report)
        if fit_to is not None:
            mesh = mesh_in_srgb(mesh)
            options["fit"] = to_srgb(fit_to.array, fit_to.metadata.icc)
        report("writing")
        if n_stages:
            options["progress"] = report
        job.write(lambda stream: write_mesh(mesh, stream, wanted, limits=limits, **options))


def mesh_of(
    given: Mesh | Picture, settings: Settings, mask: str | None, limits: Limits, report: Progress
) -> Mesh:
    """A mesh as it is, or that of a photograph, in which a mask may say what matters."""
    from vmesh.encoder.pipeline import encode_with
    from vmesh.mesh import Mesh

    if isinstance(given, Mesh):
        return given
    weights = read_weights(mask, given, limits)
    return encode_with(
        given.array, settings, weights=weights, metadata=given.metadata, progress=report
    )
