"""``vmesh to-pdf``: a .vmesh file or a photograph -> PDF."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import click

from vmesh.batch.sources import PICTURES_AND_MESHES
from vmesh.cli.jobs import Job, Making, job_arguments, take_jobs
from vmesh.cli.limits import limit_options, take_limits
from vmesh.cli.options import (
    checked_by,
    encoder_options,
    picture_options,
    quiet_option,
    strip_option,
    take_picture_options,
    take_settings,
)
from vmesh.cli.vector import convert
from vmesh.formats.metadata.privacy import Strip
from vmesh.formats.pdf.page_size import points_of
from vmesh.formats.registry import FORMATS

if TYPE_CHECKING:
    from vmesh.formats.pdf.document import Backend, Mode


_MAKING: Final = Making(PICTURES_AND_MESHES, (".pdf",), ".pdf")


@click.command("to-pdf")
@job_arguments("INPUT", "OUTPUT")
@click.option(
    "--mode",
    type=click.Choice(("exact",)),
    default="exact",
    show_default=True,
    help="What fills a triangle: PDF holds its colours as they are.",
)
@click.option(
    "--page-width",
    metavar="LENGTH",
    callback=checked_by(points_of),
    help="Such as 210mm, 8.5in or 400pt; else by the picture's EXIF, else a pixel is 1/72 inch.",
)
@click.option(
    "--backend",
    type=click.Choice(("native", "cairo")),
    default="native",
    show_default=True,
    help="What writes the page; cairo writes 30 times as much.",
)
@picture_options
@strip_option("private")
@encoder_options
@limit_options
@quiet_option
def command(
    mode: Mode,
    page_width: str | None,
    backend: Backend,
    strip: Strip | None,
    quiet: bool,
    **options: Any,
) -> None:
    """Turn .vmesh files, or photographs, into PDF, a page each.

    Without OUTPUT it is named after INPUT, with .pdf at its end. With -o DIR there may be many
    INPUTs, also folders. The options of the encoder apply to photographs.
    """
    settings, limits = take_settings(options), take_limits(options)
    reading, jobs = take_picture_options(options), take_jobs(options, _MAKING)

    def work(job: Job) -> None:
        convert(
            job,
            FORMATS[".pdf"],
            settings,
            reading,
            limits,
            quiet=quiet,
            strip=strip,
            mode=mode,
            page_width=page_width,
            backend=backend,
        )

    jobs.run(work)
