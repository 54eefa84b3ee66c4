"""``vmesh report``: photographs beside their meshes, with plots and figures, on one page."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from vmesh.batch.targets import check_targets
from vmesh.cli.failures import FAILURES, end_with
from vmesh.cli.jobs import Job, overwrite_option
from vmesh.cli.limits import limit_options, take_limits
from vmesh.cli.options import (
    encoder_options,
    picture_options,
    quiet_option,
    take_reading,
    take_settings,
)
from vmesh.cli.progress import show_progress
from vmesh.cli.streams import STANDARD, Reading, check_suffix, read_photograph
from vmesh.errors import describe
from vmesh.progress import Progress

if TYPE_CHECKING:
    from vmesh.encoder.settings import Settings
    from vmesh.limits import Limits


@click.command("report")
@click.argument("sources", metavar="INPUT...", nargs=-1, required=True)
@click.option("-o", "--output", "target", metavar="OUTPUT.html", required=True, help="The page.")
@overwrite_option
@picture_options
@encoder_options
@limit_options
@quiet_option
def command(
    sources: tuple[str, ...],
    target: str,
    overwrite: bool | None,
    quiet: bool,
    **options: Any,
) -> None:
    """Compare photographs with their meshes and with other codecs, on one page.

    The page needs nothing else: the photograph and its mesh side by side, a plot of PSNR over bytes
    against JPEG, WebP and AVIF, the bytes of each part, and times. Plots need matplotlib:
    pip install matplotlib.

    A photograph that fails is left out and told at the end, and the status is 1.
    """
    settings, limits = take_settings(options), take_limits(options)
    reading = take_reading(options)
    check_suffix(target, (".html", ".htm"))
    if target != STANDARD:
        check_targets([(sources[0], [target]), *((source, ()) for source in sources[1:])])
    page = Job(sources[0], target, overwrite)
    page.check()
    from vmesh.report.page import page_of
    from vmesh.report.plot import check_matplotlib
    from vmesh.report.study import count_study_steps

    check_matplotlib()
    n_steps = len(sources) * (1 + count_study_steps(settings)) + 1
    sections: list[str] = []
    failures: list[tuple[str, str]] = []
    with show_progress("reporting", n_steps, quiet=quiet) as report:
        for number, source in enumerate(sources):
            try:
                sections.append(make_section(source, number, settings, reading, limits, report))
            except FAILURES as error:
                failures.append((source, describe(error)))
        if sections:
            report("writing")
            page.write(lambda stream: stream.write(page_of(sections)))
    end_with(failures)


def make_section(
    source: str,
    number: int,
    settings: Settings,
    reading: Reading,
    limits: Limits,
    report: Progress,
) -> str:
    """The section of the page on one photograph."""
    from vmesh.report.page import section_of
    from vmesh.report.study import study_with

    report("reading")
    picture = read_photograph(source, reading, limits)
    name = "standard input" if source == STANDARD else Path(source).name
    found = study_with(
        picture.array,
        settings,
        name=name,
        metadata=picture.metadata,
        limits=limits,
        progress=report,
    )
    return section_of(found, number)
