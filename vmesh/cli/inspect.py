"""``vmesh inspect``: the stages of an encoding as a picture."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import click

from vmesh.batch.sources import PICTURES
from vmesh.cli.jobs import Job, Making, job_arguments, take_jobs
from vmesh.cli.limits import limit_options, take_limits
from vmesh.cli.options import (
    checked_by,
    encoder_options,
    mask_option,
    picture_options,
    quiet_option,
    take_picture_options,
    take_settings,
)
from vmesh.cli.progress import show_progress
from vmesh.cli.streams import STANDARD, read_photograph, read_weights
from vmesh.inspection.sheet import SHEET_SUFFIXES

if TYPE_CHECKING:
    from vmesh.inspection.region import Region

_MAKING: Final = Making(PICTURES, SHEET_SUFFIXES)

VIEWS = ("original", "salience", "points", "mesh", "render", "error", "sheet")


def _region_of(text: str) -> Region:
    """The region that an option names."""
    from vmesh.inspection.region import Region

    return Region.parse(text)


@click.command("inspect")
@job_arguments("INPUT", "OUTPUT", has_folder=False)
@click.option(
    "--show",
    type=click.Choice(VIEWS),
    default="sheet",
    show_default=True,
    help="Which stage; a sheet has all of them, with captions and figures.",
)
@click.option(
    "--zoom",
    metavar="X,Y,W,H",
    callback=checked_by(_region_of),
    help="Only this region of the picture; a sheet then shows the mesh beside enlarged pixels.",
)
@click.option(
    "--scale",
    type=click.FloatRange(0, min_open=True),
    help="Pixels of a drawing for each of the picture; unless given, what suits a screen.",
)
@picture_options
@mask_option
@encoder_options
@limit_options
@quiet_option
def command(
    show: str,
    zoom: str | None,
    scale: float | None,
    mask: str | None,
    quiet: bool,
    **options: Any,
) -> None:
    """Draw the stages of the encoding of a photograph, and what stays sharp when it is enlarged.

    OUTPUT is an image, SVG or PDF, in which the mesh, its edges and points are drawn as such.
    """
    region = None if zoom is None else _region_of(zoom)
    settings, limits = take_settings(options), take_limits(options)
    reading = take_picture_options(options)
    jobs = take_jobs(options, _MAKING)
    from vmesh.encoder.pipeline import count_steps
    from vmesh.inspection.sheet.files import write_sheet
    from vmesh.inspection.sheets import stages_sheet, view_sheet
    from vmesh.inspection.stages import inspect_encoding

    def work(job: Job) -> None:
        suffix = ".png" if job.target == STANDARD else Path(job.target).suffix.lower()
        with show_progress("inspecting", count_steps(settings) + 2, quiet=quiet) as report:
            report("reading")
            picture = read_photograph(job.source, reading, limits)
            if region is not None:
                region.check_within(picture.array.shape[1], picture.array.shape[0])
            found = inspect_encoding(
                picture.array,
                settings,
                weights=read_weights(mask, picture, limits),
                metadata=picture.metadata,
                limits=limits,
                progress=report,
            )
            report("drawing")
            if show == "sheet":
                title = "photograph" if job.source == STANDARD else Path(job.source).name
                sheet = stages_sheet(found, title, region, scale)
            else:
                sheet = view_sheet(found, show, region, scale)
            job.write(lambda stream: write_sheet(sheet, stream, suffix, limits=limits))

    jobs.run(work)
