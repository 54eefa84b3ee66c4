"""``vmesh batch``: many photographs -> meshes and other formats."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from dataclasses import asdict
from itertools import chain
from pathlib import Path
from typing import Any

import click

from vmesh.batch.cluster import run_on_cluster
from vmesh.batch.plan import make_plan
from vmesh.batch.processes import run_in_processes
from vmesh.batch.sources import PICTURES, PICTURES_AND_MESHES, find_sources
from vmesh.batch.task import Outcome, Recipe
from vmesh.cli.failures import end_with
from vmesh.cli.limits import limit_options, take_limits
from vmesh.cli.options import (
    mesh_options,
    picture_options,
    quiet_option,
    strip_option,
    take_picture_options,
    take_settings,
)
from vmesh.cli.progress import show_files
from vmesh.cli.streams import STANDARD, make_folder, tell
from vmesh.codec.layout import FILE_SUFFIX
from vmesh.formats.metadata.privacy import Strip
from vmesh.formats.registry import FORMATS
from vmesh.progress import Progress

_SUFFIXES = (FILE_SUFFIX, *FORMATS)


class SuffixesType(click.ParamType[tuple[str, ...]]):
    """Formats by the endings of their names, with commas between them."""

    name = "vmesh,svg,..."

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[str, ...]:
        """The endings of a text, each once."""
        suffixes = tuple(dict.fromkeys(f".{name.strip().lower()}" for name in value.split(",")))
        for suffix in suffixes:
            if suffix not in _SUFFIXES:
                known = ", ".join(name.removeprefix(".") for name in _SUFFIXES)
                self.fail(f"expected some of {known}, got {value!r}", param, ctx)
        return suffixes


@click.command("batch")
@click.argument("sources", metavar="SRC...", nargs=-1, required=True)
@click.option(
    "-o",
    "--output",
    metavar="DIR",
    required=True,
    type=click.Path(file_okay=False),
    help="Folder for the outputs, made if there is none.",
)
@click.option(
    "--to",
    "suffixes",
    type=SuffixesType(),
    default="vmesh",
    show_default=True,
    help="What to make of each source.",
)
@click.option(
    "-j",
    "--jobs",
    type=click.IntRange(1),
    help="Most sources worked on at once, each by a process with one thread; as many as there are "
    "processors unless given.",
)
@click.option(
    "--scheduler",
    metavar="ADDRESS",
    help="Work on the Dask cluster of this scheduler instead, which sees the same files.",
)
@click.option("--force", is_flag=True, help="Make outputs also if they are as new as their source.")
@picture_options
@strip_option("private for SVG, PDF and HTML, else none")
@mesh_options
@limit_options
@click.option("--json", "as_json", is_flag=True, help="Print a line of JSON for each source.")
@quiet_option
def command(
    sources: tuple[str, ...],
    output: str,
    suffixes: tuple[str, ...],
    jobs: int | None,
    scheduler: str | None,
    force: bool,
    strip: Strip | None,
    as_json: bool,
    quiet: bool,
    **options: Any,
) -> None:
    """Encode many photographs, and turn them into other formats.

    SRC is a photograph, a .vmesh file, a folder or a pattern in quotes such as "photos/**/*.jpg".
    Folders are searched for photographs with all the folders below them, whose tree is kept in DIR.

    Outputs that are as new as their source are not made again, so that a batch that was stopped
    goes on where it was; settings are not compared. What cannot be read is told at the end, the
    other sources are done all the same, and the status is 1.
    """
    options["threads"] = 1
    recipe = Recipe(
        take_settings(options), take_picture_options(options), strip, take_limits(options)
    )
    if STANDARD in sources:
        raise click.UsageError("batch reads files, not standard input")
    if scheduler is not None:
        if jobs is not None:
            raise click.UsageError("-j is for this machine, --scheduler for others")
        # The workers run in other folders.
        sources, output = tuple(map(absolute, sources)), absolute(output)
    kind = PICTURES if FILE_SUFFIX in suffixes else PICTURES_AND_MESHES
    found = find_sources(sources, output, kind)
    tasks, skipped = make_plan(found, output, suffixes, recipe, force=force)
    make_folder(output)
    if scheduler is None:
        outcomes = run_in_processes(tasks, jobs or os.cpu_count() or 1)
    else:
        outcomes = run_on_cluster(tasks, scheduler)
    with show_files("batch", len(tasks), quiet=quiet) as report:
        failed = show_outcomes(chain(skipped, outcomes), report, as_json=as_json)
    end_with((outcome.source, outcome.error or "") for outcome in failed)


def absolute(path: str) -> str:
    """The path from the root."""
    return str(Path(path).absolute())


def show_outcomes(outcomes: Iterable[Outcome], report: Progress, *, as_json: bool) -> list[Outcome]:
    """Tell outcomes as they come; returns those that failed."""
    failed = []
    for outcome in outcomes:
        if as_json:
            tell(json.dumps(asdict(outcome)))
        if outcome.status != "skipped":
            report(Path(outcome.source).name)
        if outcome.status == "failed":
            failed.append(outcome)
    return failed
