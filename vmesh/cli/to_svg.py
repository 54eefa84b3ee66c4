"""``vmesh to-svg``: a .vmesh file or a photograph -> SVG."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Final

import click

from vmesh.batch.sources import PICTURES_AND_MESHES
from vmesh.cli.jobs import Job, Making, job_arguments, take_jobs
from vmesh.cli.limits import limit_options, take_limits
from vmesh.cli.options import (
    checked_by,
    encoder_options,
    mask_option,
    picture_options,
    quiet_option,
    strip_option,
    take_reading,
    take_settings,
)
from vmesh.cli.streams import STANDARD, read_photograph
from vmesh.cli.vector import convert
from vmesh.formats.metadata.privacy import Strip
from vmesh.formats.registry import DATA_URI, FORMATS, Format, format_of
from vmesh.formats.svg.size import parse_length
from vmesh.formats.svg.style import Mode, Seams, Style, check_id_prefix

_MAKING: Final = Making(PICTURES_AND_MESHES, (".svg", ".svgz"), ".svg")
_MAKING_OF_URIS: Final = Making(PICTURES_AND_MESHES, (".txt",), ".txt")


@click.command("to-svg")
@job_arguments("INPUT", "OUTPUT")
@click.option(
    "--mode",
    type=click.Choice(("gradient", "exact", "auto", "flat")),
    default="gradient",
    show_default=True,
    help="What fills a triangle. exact takes three times the bytes of gradient, and is about the "
    "picture in programs without mix-blend-mode, such as CairoSVG, Skia and Qt.",
)
@click.option(
    "--tolerance",
    type=click.FloatRange(0, 255, min_open=True),
    default=4.0,
    show_default=True,
    help="Largest error in mode auto, in levels.",
)
@click.option(
    "--merge",
    metavar="ERROR",
    type=click.FloatRange(0),
    default=0.0,
    help="In mode gradient, neighbours share one where that adds less squared error, such as 50.",
)
@click.option(
    "--seams",
    type=click.Choice(("crisp", "trapping")),
    default="crisp",
    show_default=True,
    help="How no seams show; trapping is for programs that smooth all edges: Inkscape, Qt, Skia, "
    "svglib, and others that know no shape-rendering.",
)
@click.option(
    "--id-prefix",
    metavar="TEXT",
    callback=checked_by(check_id_prefix),
    help="What ids begin with; else a digest of the drawing, so that several fit into one page.",
)
@click.option(
    "--fit",
    metavar="PHOTO",
    help="Fit the gradients to the pixels of this photograph, that the mesh was made of.",
)
@click.option(
    "--width",
    metavar="LENGTH",
    callback=checked_by(parse_length),
    help="Width at which it shows, such as 800, 210mm or 100%; unless given, that of the canvas.",
)
@click.option(
    "--height",
    metavar="LENGTH",
    callback=checked_by(parse_length),
    help="Height; one of the two alone keeps the proportions.",
)
@click.option(
    "--data-uri",
    is_flag=True,
    help="Write text for src=\"...\" or url('...'), in either quotes, to OUTPUT.txt or to -.",
)
@picture_options
@mask_option
@strip_option("private")
@encoder_options
@limit_options
@quiet_option
def command(
    mode: Mode,
    tolerance: float,
    merge: float,
    seams: Seams,
    id_prefix: str | None,
    data_uri: bool,
    fit: str | None,
    width: str | None,
    height: str | None,
    strip: Strip | None,
    quiet: bool,
    **options: Any,
) -> None:
    """Turn .vmesh files, or photographs, into SVG; compressed if OUTPUT ends in .svgz.

    Without OUTPUT it is named after INPUT, with .svg at its end. With -o DIR there may be many
    INPUTs, also folders. The options of the encoder apply to photographs.
    """
    settings, limits = take_settings(options), take_limits(options)
    making = _MAKING_OF_URIS if data_uri else _MAKING
    reading, jobs = take_reading(options), take_jobs(options, making)
    try:
        n_stages = Style(mode, tolerance, merge, seams).n_stages
    except ValueError as error:
        raise click.UsageError(str(error)) from None
    # Its pixels count alike: a mask says something of the encoding only.
    unmasked = replace(reading, mask=None)
    photograph = None if fit is None else read_photograph(fit, unmasked, limits)

    def format_for(target: str) -> Format:
        if data_uri:
            return DATA_URI
        return FORMATS[".svg"] if target == STANDARD else format_of(target)

    def work(job: Job) -> None:
        convert(
            job,
            format_for(job.target),
            settings,
            reading,
            limits,
            quiet=quiet,
            strip=strip,
            n_stages=n_stages,
            mode=mode,
            tolerance=tolerance,
            merge=merge,
            seams=seams,
            id_prefix=id_prefix,
            fit_to=photograph,
            width=width,
            height=height,
        )

    jobs.run(work)
