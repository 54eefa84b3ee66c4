"""``vmesh to-html``: a .vmesh file or a photograph -> a page that shows it."""

from __future__ import annotations

from typing import Any, Final

import click

from vmesh.batch.sources import PICTURES_AND_MESHES
from vmesh.cli.jobs import Job, Making, job_arguments, take_jobs
from vmesh.cli.limits import limit_options, take_limits
from vmesh.cli.options import (
    encoder_options,
    mask_option,
    picture_options,
    quiet_option,
    strip_option,
    take_picture_options,
    take_settings,
)
from vmesh.cli.streams import check_suffix
from vmesh.cli.vector import convert
from vmesh.formats.metadata.privacy import Strip
from vmesh.formats.registry import FORMATS

_MAKING: Final = Making(PICTURES_AND_MESHES, (".html", ".htm"), ".html")


@click.command("to-html")
@job_arguments("INPUT", "OUTPUT.html", is_required=False)
@click.option(
    "--element",
    metavar="FILE.js",
    help="Write the script of <vmesh-image src=...> for pages of your own; it needs no INPUT.",
)
@picture_options
@strip_option("private")
@mask_option
@encoder_options
@limit_options
@quiet_option
def command(
    element: str | None,
    strip: Strip | None,
    mask: str | None,
    quiet: bool,
    **options: Any,
) -> None:
    """Turn .vmesh files, or photographs, into HTML files that show them in a browser, each alone.

    Without OUTPUT.html it is named after INPUT, with .html at its end. With -o DIR there may be
    many INPUTs, also folders. The options of the encoder apply to photographs.
    """
    settings, limits = take_settings(options), take_limits(options)
    reading = take_picture_options(options)
    if element is not None:
        write_element(element, options["overwrite"])
        if not options["paths"] and options["output"] is None:
            return
    if not options["paths"]:
        raise click.UsageError("expected INPUT and OUTPUT.html, or --element FILE.js")

    def work(job: Job) -> None:
        html = FORMATS[".html"]
        convert(job, html, settings, reading, limits, quiet=quiet, mask=mask, strip=strip)

    take_jobs(options, _MAKING).run(work)


def write_element(target: str, overwrite: bool | None) -> None:
    """Write the script of the custom element."""
    check_suffix(target, (".js", ".mjs"))
    from vmesh.formats.html.document import element_script

    job = Job("", target, overwrite)
    job.check()
    job.write(lambda stream: stream.write(element_script().encode()))
