"""Jobs of a command: inputs, the outputs that are made of them, and what these may replace."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, BinaryIO, Final, TypeVar

import click

from vmesh.batch.sources import MESHES, Kind, Source, find_sources
from vmesh.batch.targets import check_targets
from vmesh.cli.failures import run_all
from vmesh.cli.streams import STANDARD, check_folder, make_folder, write_output
from vmesh.errors import shown
from vmesh.files import Times, check_replaceable, times_of

Command = TypeVar("Command", bound=Callable[..., Any])


@dataclass(frozen=True, slots=True)
class Making:
    """What a command makes of what.

    Parameters
    ----------
    inputs : Kind
        Files that it takes from folders.
    suffixes : tuple of str
        Endings that its outputs may have.
    suffix : str, optional
        Ending of an output that is named after its input; without one, outputs are always named.
    """

    inputs: Kind
    suffixes: tuple[str, ...]
    suffix: str | None = None


@dataclass(frozen=True, slots=True)
class Job:
    """An output, and the input that it is made of.

    Parameters
    ----------
    source, target : str
        Their paths, or ``-``.
    overwrite : bool, optional
        Whether the output replaces what is there: everything or nothing. Unless given, it does if
        it was named, and what is there is not protected from writing.
    is_named : bool
        Whether the user named the output, as against one that is named after the input.
    times : tuple of int, optional
        Times that the output gets.
    place : str
        Which of how many it is, such as " 2/5"; empty of a single one.
    """

    source: str
    target: str
    overwrite: bool | None = None
    is_named: bool = True
    times: Times | None = None
    place: str = ""

    def check(self) -> None:
        """Refuse an output that stays as it is, or that cannot be written, before any work."""
        if self.target != STANDARD:
            check_replaceable(self.target, overwrite=self.overwrite, is_named=self.is_named)
            if self.is_named and not Path(self.target).exists():
                check_folder(str(Path(self.target).parent))

    def write(self, fill: Callable[[BinaryIO], object]) -> None:
        """Let `fill` write the output."""
        if self.target != STANDARD and not self.is_named:
            make_folder(str(Path(self.target).parent))
        may_replace = self.overwrite is True or (self.is_named and self.overwrite is None)
        write_output(self.target, fill, replace=may_replace, times=self.times)


@dataclass(frozen=True, slots=True)
class Jobs:
    """Jobs of a command.

    Parameters
    ----------
    jobs : sequence of Job
    are_many : bool
        Whether the user asked for many, as by a folder, though that may hold but one.
    """

    jobs: Sequence[Job]
    are_many: bool

    def run(self, work: Callable[[Job], object]) -> None:
        """Check and do each; of many, those that fail are told at the end, with status 1."""

        def begin(job: Job) -> None:
            job.check()
            work(job)

        run_all([(job.source, partial(begin, job)) for job in self.jobs], are_many=self.are_many)


def job_arguments(
    source: str, output: str, *, is_required: bool = True, has_folder: bool = True
) -> Callable[[Command], Command]:
    """Arguments and options of a command that makes outputs of inputs, by their names in its help.

    Without `has_folder` it takes one input, and the name of its output.
    """
    metavar = f"{source}... [{output}]" if has_folder else f"{source} {output}"

    def give(command: Command) -> Command:
        command = overwrite_option(preserve_option(command))
        if has_folder:
            command = _FOLDER_OPTION(command)
        return click.argument("paths", metavar=metavar, nargs=-1, required=is_required)(command)

    return give


_FOLDER_OPTION: Final = click.option(
    "-o",
    "--output",
    metavar="DIR",
    help="Folder for the outputs of any number of inputs, made if there is none. Folders among the "
    "inputs are searched, and their tree is kept.",
)


def overwrite_option(command: Command) -> Command:
    """Give a command the option on what its outputs replace."""
    return click.option(
        "--overwrite/--no-overwrite",
        default=None,
        help="Replace whatever is there, or nothing. Unless given, an output that is named is "
        "replaced if it is not write-protected, and one that is named after its input is not.",
    )(command)


def preserve_option(command: Command) -> Command:
    """Give a command the option on the times of its outputs."""
    return click.option("--preserve", is_flag=True, help="Give outputs the times of inputs.")(
        command
    )


def take_jobs(options: dict[str, Any], making: Making) -> Jobs:
    """Jobs of a command's arguments and options, which lose what `job_arguments` gave.

    Raises
    ------
    click.UsageError
        If they say no jobs.
    OSError
        If a folder cannot be read or made.
    ValueError
        If there is nothing in the folders, if outputs would have a name in common, or if one would
        replace an input.
    """
    paths: tuple[str, ...] = options.pop("paths")
    output: str | None = options.pop("output", None)
    overwrite, preserve = options.pop("overwrite"), options.pop("preserve")
    folder = None if output is None or is_one_output(output, making) else output
    if folder is None:
        pairs = [_single(paths, output, making)]
        is_named, are_many = output is not None or len(paths) > 1, False
    else:
        pairs = _in_folder(paths, folder, making)
        is_named, are_many = False, len(pairs) > 1 or Path(paths[0]).is_dir()
    check_targets((source, [] if target == STANDARD else [target]) for source, target in pairs)
    if folder is not None:
        make_folder(folder)
    jobs = [Job(source, target, overwrite, is_named) for source, target in pairs]
    if preserve:
        if any(STANDARD in pair for pair in pairs):
            raise click.UsageError(
                "--preserve is for files: standard input and output have no times"
            )
        jobs = [replace(job, times=times_of(job.source)) for job in jobs]
    if are_many:
        jobs = [replace(job, place=f" {n}/{len(jobs)}") for n, job in enumerate(jobs, 1)]
    return Jobs(jobs, are_many)


def is_one_output(output: str, making: Making) -> bool:
    """Check of ``-o``: true if it names an output, and not a folder for many."""
    if output == STANDARD:
        return True
    return Path(output).suffix.lower() in making.suffixes and not Path(output).is_dir()


def check_no_file(folder: str) -> None:
    """Refuse a folder for outputs that is a file."""
    if Path(folder).is_file():
        raise click.UsageError(f"{shown(folder)}: a folder is needed, and this is a file")


def find_inputs(paths: Iterable[str], output: str | None, kind: Kind) -> list[Source]:
    """Inputs that some arguments name, or that are in folders that they name, but not in `output`.

    Raises
    ------
    click.UsageError
        If standard input is one of many.
    OSError, ValueError
        If a folder cannot be read, or if there is nothing in any.
    """
    named = list(paths)
    if STANDARD in named and len(named) > 1:
        raise click.UsageError("standard input is one input, and cannot be among others")
    return find_sources(named, output, kind).sources


def _single(paths: tuple[str, ...], output: str | None, making: Making) -> tuple[str, str]:
    """The input and the output of a command that makes one."""
    if len(paths) > (2 if output is None else 1):
        raise click.UsageError("several inputs need a folder for their outputs: -o DIR")
    source = paths[0]
    target = output if output is not None else paths[1] if len(paths) > 1 else None
    if target is None:
        return source, _named_after(source, making)
    if target != STANDARD and Path(target).suffix.lower() not in making.suffixes:
        endings = ", ".join(making.suffixes)
        raise click.UsageError(
            f"{shown(target)}: expected a name that ends in {endings}"
            + ("; several inputs need -o DIR" if making.suffix else "")
        )
    return source, target


def _named_after(source: str, making: Making) -> str:
    """Name of the output of an input, beside it."""
    if making.suffix is None:
        raise click.UsageError("expected a name for the output: its ending says the format")
    if source == STANDARD:
        raise click.UsageError("expected a name for the output: standard input has none")
    if Path(source).is_dir():
        raise click.UsageError(f"{shown(source)}: a folder needs one for its outputs: -o DIR")
    return str(Path(source).with_suffix(making.suffix))


def _in_folder(paths: tuple[str, ...], output: str, making: Making) -> list[tuple[str, str]]:
    """Inputs, and their outputs in a folder."""
    if making.suffix is None:
        raise click.UsageError("expected a name for the output: its ending says the format")
    if STANDARD in paths:
        raise click.UsageError("expected a name for the output: standard input has none")
    check_no_file(output)
    return [
        (str(source.path), str(Path(output, source.name).with_suffix(making.suffix)))
        for source in find_inputs(paths, output, making.inputs)
    ]


def run_inputs(paths: Sequence[str], work: Callable[[str, str], object]) -> None:
    """Do some work on each of some meshes, in files or in folders that are named.

    Parameters
    ----------
    paths : sequence of str
        What the user named.
    work : callable
        Gets a path, and the heading of what it prints; that is empty if it is about the only one.
    """
    is_one = len(paths) == 1 and not Path(paths[0]).is_dir()
    found = list(paths) if is_one else [str(s.path) for s in find_inputs(paths, None, MESHES)]
    headings = [f"{chr(10) if number else ''}{shown(path)}:\n" for number, path in enumerate(found)]
    works = [
        (path, partial(work, path, "" if is_one else heading))
        for path, heading in zip(found, headings, strict=True)
    ]
    run_all(works, are_many=not is_one)
