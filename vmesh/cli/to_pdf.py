"""``vmesh to-pdf``: a .vmesh file or a photograph -> PDF."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import click

from vmesh.batch.sources import PICTURES_AND_MESHES
from vmesh.cli.album import Pages, take_album
from vmesh.cli.jobs import Job, Making, job_arguments, take_jobs
from vmesh.cli.limits import limit_options, take_limits
from vmesh.cli.options import (
    checked_by,
    encoder_options,
    mask_option,
    picture_options,
    quiet_option,
    strip_option,
    take_picture_options,
    take_settings,
)
from vmesh.cli.progress import show_progress
from vmesh.cli.streams import read_mesh_or_photograph
from vmesh.cli.vector import convert, mesh_of
from vmesh.formats.metadata.privacy import Strip
from vmesh.formats.pdf.page_size import Layout, Orientation, points_of, sides_of
from vmesh.formats.registry import FORMATS

if TYPE_CHECKING:
    from vmesh.formats.pdf.document import Backend, Mode
    from vmesh.mesh import Mesh

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
    "--page-size",
    metavar="SIZE",
    callback=checked_by(sides_of),
    help="Paper: A0 to A10, B0 to B10, letter, legal, tabloid, or sides such as 210x297mm. The "
    "picture is in its middle, as large as it fits.",
)
@click.option(
    "--orientation",
    type=click.Choice(("portrait", "landscape")),
    help="How the paper stands; unless given, one of a name stands as each picture, and one of "
    "sides as it is given.",
)
@click.option("--margin", metavar="LENGTH", help="Room around the picture, such as 10mm; else 0.")
@click.option(
    "--backend",
    type=click.Choice(("native", "cairo")),
    default="native",
    show_default=True,
    help="What writes the page; cairo writes 30 times as much.",
)
@picture_options
@strip_option("private")
@mask_option
@encoder_options
@limit_options
@quiet_option
def command(
    mode: Mode,
    page_width: str | None,
    page_size: str | None,
    orientation: Orientation | None,
    margin: str | None,
    backend: Backend,
    strip: Strip | None,
    mask: str | None,
    quiet: bool,
    **options: Any,
) -> None:
    """Turn .vmesh files, or photographs, into PDF, a page each.

    Without OUTPUT it is named after INPUT, with .pdf at its end. With -o DIR there may be many
    INPUTs, also folders, and a file for each. With -o NAME.pdf all of them are pages of one file,
    with an outline of their names. The options of the encoder apply to photographs.
    """
    try:
        layout = Layout(page_width, page_size, orientation, margin)
    except ValueError as error:
        raise click.UsageError(str(error)) from None
    settings, limits = take_settings(options), take_limits(options)
    reading, album = take_picture_options(options), take_album(options, _MAKING)
    jobs = take_jobs(options, _MAKING) if album is None else None

    def work(job: Job) -> None:
        convert(
            job,
            FORMATS[".pdf"],
            settings,
            reading,
            limits,
            quiet=quiet,
            mask=mask,
            strip=strip,
            mode=mode,
            page_width=page_width,
            page_size=page_size,
            orientation=orientation,
            margin=margin,
            backend=backend,
        )

    def read(source: str, place: str) -> Mesh:
        from vmesh.encoder.pipeline import count_steps
        from vmesh.formats.metadata.privacy import stripped

        given = read_mesh_or_photograph(source, reading, limits)
        with show_progress(f"converting{place}", count_steps(settings), quiet=quiet) as report:
            mesh = mesh_of(given, settings, mask, limits, report)
        limits.check_vertices(mesh.n_vertices)
        return mesh.replaced(metadata=stripped(mesh.metadata, strip or "private"))

    def write(pages: Pages, job: Job) -> None:
        from vmesh.formats.pdf.document import write_album

        job.write(
            lambda stream: write_album(pages, stream, backend=backend, layout=layout, limits=limits)
        )

    if jobs is not None:
        jobs.run(work)
    elif album is not None:
        album.make(read, write)
