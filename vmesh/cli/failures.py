"""Sources that failed, of a command that goes on with the others."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Sequence
from typing import Final

from vmesh.cli.streams import STANDARD_OUTPUT, remark
from vmesh.errors import VmeshError, describe, shown

# What the data, the system or the user can be the reason of.
FAILURES: Final = (VmeshError, OSError, ValueError, MemoryError)


def run_all(works: Sequence[tuple[str, Callable[[], object]]], *, are_many: bool) -> None:
    """Do some works, each on a source by its name.

    Of many, each is done whatever becomes of the others, and those that failed are told at the end,
    with status 1. The error of a single one is raised.
    """
    failed: list[tuple[str, str]] = []
    for source, work in works:
        try:
            work()
        except BrokenPipeError:
            raise
        except FAILURES as error:
            if not are_many or is_of_output(error):
                raise
            failed.append((source, describe(error)))
    end_with(failed)


def is_of_output(error: BaseException) -> bool:
    """Check of an error: true if standard output failed, which all others would do at too."""
    return isinstance(error, OSError) and error.filename == STANDARD_OUTPUT


def end_with(failures: Iterable[tuple[str, str]]) -> None:
    """Tell what went wrong with which source, a line for each; with any, exit with status 1."""
    failed = list(failures)
    for source, error in failed:
        # Errors of the system name it themselves.
        name = shown(source)
        sentence = error if error.startswith(name) else f"{name}: {error}"
        remark(sentence)
    if failed:
        sys.exit(1)


def tell_trouble(sentence: str | None) -> None:
    """Say what hindered a command that did its work all the same, if anything did."""
    if sentence is not None:
        remark(sentence)
