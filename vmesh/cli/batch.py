"""``vmesh batch``: many photographs -> meshes and other formats."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from dataclasses import asdict
from itertools import chain
from pathlib import Path
from typing import Any, Final

import click

from vmesh.batch.cluster import run_on_cluster
from vmesh.batch.journal import Journal
from vmesh.batch.plan import Plan, Rules, make_plan
from vmesh.batch.processes import run_in_processes
from vmesh.batch.sources import PICTURES, PICTURES_AND_MESHES, find_sources
from vmesh.batch.task import Outcome, Recipe
from vmesh.cli.failures import end_with, tell_trouble
from vmesh.cli.jobs import check_no_file, preserve_option
from vmesh.cli.limits import limit_options, take_limits
from vmesh.cli.options import (
    mesh_options,
    picture_options,
    quiet_option,
    strip_option,
    take_reading,
    take_settings,
)
from vmesh.cli.progress import show_files
from vmesh.cli.streams import STANDARD, make_folder, remark, tell
from vmesh.codec.layout import FILE_SUFFIX
from vmesh.errors import shown
from vmesh.formats.metadata.privacy import Strip
from vmesh.formats.registry import FORMATS
from vmesh.processors import count_processors
from vmesh.progress import Progress

_N_NAMED: Final = 5  # files that are passed over; the others are counted
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
@click.option("--force", is_flag=True, help="Make outputs also if they are up to date.")
@click.option(
    "--overwrite/--no-overwrite",
    default=None,
    help="Replace outputs that are not up to date also if they are write-protected, or replace "
    "none.",
)
@preserve_option
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
    overwrite: bool | None,
    preserve: bool,
    strip: Strip | None,
    as_json: bool,
    quiet: bool,
    **options: Any,
) -> None:
    """Encode many photographs, and turn them into other formats.

    SRC is a photograph, a .vmesh file, a folder or a pattern in quotes such as "photos/**/*.jpg".
    Folders are searched for photographs with all the folders below them, whose tree is kept in DIR.
    If --to names no vmesh, they are also searched for .vmesh files, but for one beside the
    photograph of the same name.

    Outputs that are up to date are not made again, so that a batch that was stopped goes on where
    it was: those that were made of a source of this size and time, by these settings, which DIR
    keeps in .vmesh-batch.jsonl; others if they are as new as their source. How many sources were
    skipped, and what was passed over in folders, is told at the end, unless --quiet is given.

    What cannot be read is told at the end, the other sources are done all the same, and the status
    is 1.
    """
    options["threads"] = 1
    recipe = Recipe(
        take_settings(options), take_reading(options).options, strip, take_limits(options)
    )
    if STANDARD in sources:
        raise click.UsageError("batch reads files, not standard input")
    check_no_file(output)
    if scheduler is not None:
        if jobs is not None:
            raise click.UsageError("-j is for this machine, --scheduler for others")
        # The workers run in other folders.
        sources, output = tuple(map(absolute, sources)), absolute(output)
    if force and overwrite is False:
        raise click.UsageError("--force replaces outputs, --no-overwrite none")
    kind = PICTURES if FILE_SUFFIX in suffixes else PICTURES_AND_MESHES
    found, journal = find_sources(sources, output, kind), Journal(output)
    rules = Rules(force, overwrite, preserve)
    plan = make_plan(found.sources, output, suffixes, recipe, journal, rules)
    make_folder(output)
    journal.add(plan.adopted)
    if scheduler is None:
        outcomes = run_in_processes(plan.tasks, jobs or count_processors())
    else:
        outcomes = run_on_cluster(plan.tasks, scheduler)
    with show_files("batch", len(plan.tasks), quiet=quiet) as report:
        done = show_outcomes(
            noted(chain(outcomes, plan.settled), plan, journal), report, as_json=as_json
        )
    if not quiet:
        tell_what_was_left(done, found.passed_over)
    tell_trouble(next((outcome.trouble for outcome in done if outcome.trouble), None))
    end_with(
        (outcome.source, outcome.error or "") for outcome in done if outcome.status == "failed"
    )


def absolute(path: str) -> str:
    """The path from the root."""
    return str(Path(path).absolute())


def noted(outcomes: Iterable[Outcome], plan: Plan, journal: Journal) -> Iterator[Outcome]:
    """Outcomes, as they come; what they wrote is noted in the journal."""
    for outcome in outcomes:
        written = [path for path in map(Path, outcome.outputs) if path in plan.origins]
        journal.add({path: plan.origins[path] for path in written})
        yield outcome


def show_outcomes(outcomes: Iterable[Outcome], report: Progress, *, as_json: bool) -> list[Outcome]:
    """Tell outcomes as they come; returns them."""
    done = []
    for outcome in outcomes:
        if as_json:
            figures = asdict(outcome)
            del figures["trouble"]
            tell(json.dumps(figures))
        for note in outcome.notes:
            remark(f"{outcome.source}: {note}")
        if outcome.status != "skipped":
            report(shown(Path(outcome.source).name))
        done.append(outcome)
    return done


def tell_what_was_left(outcomes: list[Outcome], passed_over: list[Path]) -> None:
    """Say how many sources were skipped, and what in the folders was no source."""
    n_skipped = sum(outcome.status == "skipped" for outcome in outcomes)
    if n_skipped:
        remark(f"{n_skipped} of {len(outcomes)} skipped: their outputs are there")
    if passed_over:
        names = ", ".join(shown(path.name) for path in passed_over[:_N_NAMED])
        more = len(passed_over) - _N_NAMED
        rest = f" and {more} more" if more > 0 else ""
        remark(f"passed over in folders: {names}{rest}")
