"""``vmesh decode``: a .vmesh file -> pixels."""

from __future__ import annotations

from typing import Any, Final

import click

from vmesh.batch.sources import MESHES
from vmesh.cli.jobs import Job, Making, job_arguments, take_jobs
from vmesh.cli.limits import limit_options, take_limits
from vmesh.cli.options import quiet_option, strip_option
from vmesh.cli.progress import show_progress
from vmesh.cli.streams import STANDARD, read_mesh
from vmesh.formats.metadata.privacy import Strip
from vmesh.formats.registry import FORMATS, RASTER_SUFFIXES, ExportOptions, format_of, write_mesh
from vmesh.limits import MAX_SIDE, Limits


class MatrixType(click.ParamType[tuple[float, ...]]):
    """Six numbers with commas between them."""

    name = "a,b,c,d,e,f"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[float, ...]:
        """The numbers of a text."""
        try:
            numbers = tuple(float(part) for part in value.split(","))
        except ValueError:
            numbers = ()
        if len(numbers) != 6:
            self.fail(f"expected six numbers such as 1,0,0,1,0,0, got {value!r}", param, ctx)
        return numbers


_MAKING: Final = Making(MESHES, RASTER_SUFFIXES, ".png")


@click.command("decode")
@job_arguments("INPUT.vmesh", "OUTPUT")
@click.option("--scale", type=click.FloatRange(0, min_open=True), help="Pixels per canvas pixel.")
@click.option("--width", type=click.IntRange(1, MAX_SIDE), help="Width of the result in pixels.")
@click.option("--height", type=click.IntRange(1, MAX_SIDE), help="Height of the result in pixels.")
@click.option(
    "--longest-side", type=click.IntRange(1, MAX_SIDE), help="The larger of both, in pixels."
)
@click.option(
    "--transform",
    type=MatrixType(),
    help="Affine map in SVG's order: x' = a x + c y + e, y' = b x + d y + f.",
)
@click.option(
    "--supersample",
    type=click.IntRange(1, 16),
    default=1,
    show_default=True,
    help="Samples per pixel and direction; for small results.",
)
@click.option(
    "--allow-partial",
    is_flag=True,
    help="Draw what there is of a file that was cut off, if at least its positions are there, or "
    "of one in tiles, if one of them is whole.",
)
@strip_option("none")
@limit_options
@quiet_option
def command(
    scale: float | None,
    width: int | None,
    height: int | None,
    longest_side: int | None,
    transform: tuple[float, ...] | None,
    supersample: int,
    allow_partial: bool,
    strip: Strip | None,
    quiet: bool,
    **options: Any,
) -> None:
    """Turn .vmesh files into pixels: PNG, JPEG, WebP, TIFF or PAM, by the name of OUTPUT.

    Without OUTPUT it is named after INPUT, with .png at its end. With -o DIR there may be many
    INPUTs, also folders, and each becomes a PNG there. Standard output gets a PNG.

    The size is that of the photograph, or --scale, --width, --height, --longest-side say it; one
    side keeps the proportions.
    """
    limits = take_limits(options)
    if sum(value is not None for value in (scale, width or height, longest_side)) > 1:
        raise click.UsageError("expected --scale, --longest-side or a size, not several of them")
    if longest_side and transform:
        raise click.UsageError("expected no --transform with --longest-side")
    chosen: ExportOptions = {
        "scale": scale,
        "width": width,
        "height": height,
        "transform": transform,
        "supersample": supersample,
        "strip": strip,
    }

    def work(job: Job) -> None:
        decode(job, limits, longest_side, chosen, allow_partial=allow_partial, quiet=quiet)

    take_jobs(options, _MAKING).run(work)


def decode(
    job: Job,
    limits: Limits,
    longest_side: int | None,
    options: ExportOptions,
    *,
    allow_partial: bool,
    quiet: bool,
) -> None:
    """Draw one mesh."""
    wanted = FORMATS[".png"] if job.target == STANDARD else format_of(job.target)
    with show_progress(f"decoding{job.place}", 2, quiet=quiet) as report:
        report("reading")
        mesh = read_mesh(job.source, limits, allow_partial=allow_partial)
        chosen = options.copy()
        if longest_side:
            chosen["width" if mesh.width >= mesh.height else "height"] = longest_side
        report("drawing")
        job.write(lambda stream: write_mesh(mesh, stream, wanted, limits=limits, **chosen))
