"""``vmesh encode``: a photograph -> a .vmesh file."""

from __future__ import annotations

import json
import time
from typing import TYPE_CHECKING, Any, Final

import click

from vmesh.batch.sources import PICTURES
from vmesh.cli.jobs import Job, Making, job_arguments, take_jobs
from vmesh.cli.limits import limit_options, take_limits
from vmesh.cli.options import (
    encoder_options,
    json_option,
    mask_option,
    picture_options,
    quiet_option,
    strip_option,
    take_reading,
    take_settings,
)
from vmesh.cli.progress import show_progress
from vmesh.cli.streams import STANDARD, Reading, read_photograph, remark, tell
from vmesh.codec.layout import FILE_SUFFIX
from vmesh.formats.metadata.privacy import Strip

if TYPE_CHECKING:
    from vmesh.encoder.settings import Settings
    from vmesh.limits import Limits


_MAKING: Final = Making(PICTURES, (FILE_SUFFIX,), FILE_SUFFIX)


@click.command("encode")
@job_arguments("INPUT", "OUTPUT.vmesh")
@picture_options
@mask_option
@strip_option("none")
@encoder_options
@limit_options
@json_option
@quiet_option
def command(strip: Strip | None, as_json: bool, quiet: bool, **options: Any) -> None:
    """Turn photographs into .vmesh files.

    Without OUTPUT it is named after INPUT, with .vmesh at its end. With -o DIR there may be many
    INPUTs, also folders, which are searched for photographs; see also batch, which works on many
    at once.
    """
    settings, limits = take_settings(options), take_limits(options)
    reading, jobs = take_reading(options), take_jobs(options, _MAKING)
    if as_json and any(job.target == STANDARD for job in jobs.jobs):
        raise click.UsageError("--json and the file cannot both go to standard output")

    def work(job: Job) -> None:
        figures = encode(job, settings, reading, limits, strip, quiet=quiet)
        if as_json:
            tell(json.dumps({"source": job.source} | figures if jobs.are_many else figures))

    jobs.run(work)


def encode(
    job: Job,
    settings: Settings,
    reading: Reading,
    limits: Limits,
    strip: Strip | None,
    *,
    quiet: bool,
) -> dict[str, Any]:
    """Encode one photograph; returns figures about its file."""
    from vmesh.codec.writer import dumps, metadata_size
    from vmesh.encoder.pipeline import count_steps, encode_with
    from vmesh.formats.metadata.privacy import stripped

    started = time.perf_counter()
    with show_progress(f"encoding{job.place}", count_steps(settings) + 2, quiet=quiet) as report:
        report("reading")
        picture = read_photograph(job.source, reading, limits)
        metadata = stripped(picture.metadata, strip or "none")
        try:
            mesh = encode_with(
                picture.array, settings, weights=picture.weights, metadata=metadata, progress=report
            )
        except ValueError as error:
            if settings.target_size is None or strip == "all" or not metadata_size(metadata):
                raise
            raise ValueError(f"{error} (--strip leaves them out)") from None
        limits.check_vertices(mesh.n_vertices)
        report("writing")
        data = dumps(mesh)
        job.write(lambda stream: stream.write(data))
    wanted = settings.n_vertices(mesh.width, mesh.height) or mesh.n_vertices
    if settings.method == "adaptive" and wanted != mesh.n_vertices:
        bound = "at least" if mesh.n_vertices > wanted else "at most"
        remark(f"{job.source}: a mesh of it has {bound} {mesh.n_vertices} vertices, not {wanted}")
    return {
        "width": mesh.width,
        "height": mesh.height,
        "vertices": mesh.n_vertices,
        "triangles": mesh.n_triangles,
        "bytes": len(data),
        "bits_per_vertex": round(8 * len(data) / mesh.n_vertices, 3),
        "seconds": round(time.perf_counter() - started, 3),
    }
