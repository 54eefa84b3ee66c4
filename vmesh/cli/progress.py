"""Progress on standard error, on a terminal only."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Final

from vmesh.progress import Progress, silent

if TYPE_CHECKING:
    from rich.progress import Progress as Bar
    from rich.progress import ProgressColumn, TaskID

# Seconds of work that the time left is told from: a single file may take minutes.
_MEMORY: Final = 3600.0


@contextmanager
def show_progress(title: str, n_stages: int, *, quiet: bool) -> Iterator[Progress]:
    """Show a bar of stages while the block runs; yields what to call as each stage begins.

    Says so when compiled code is not in the cache yet, since the first run then takes longer.
    """
    if not _is_shown(quiet):
        yield silent
        return
    from vmesh.kernels.jit import on_first_compilation

    with (
        _bar(title, n_stages + 1, []) as (bar, task),
        on_first_compilation(lambda: bar.console.print("compiling (first run only)")),
    ):

        def report(stage: str) -> None:
            # Their number is a guess: before the block ends the bar is not full.
            n_begun = min(bar.tasks[task].completed + 1, n_stages)
            bar.update(task, completed=n_begun, description=f"{title}: {stage}")

        yield report


@contextmanager
def show_files(title: str, n_files: int, *, quiet: bool) -> Iterator[Progress]:
    """Show a bar of files while the block runs; yields what to call as each one is done."""
    if not _is_shown(quiet):
        yield silent
        return
    from rich.progress import MofNCompleteColumn

    with _bar(title, n_files, [MofNCompleteColumn()]) as (bar, task):
        yield lambda name: bar.update(task, advance=1, description=f"{title}: {name}")


def _is_shown(quiet: bool) -> bool:
    return not quiet and sys.stderr is not None and sys.stderr.isatty()


@contextmanager
def _bar(title: str, total: int, columns: list[ProgressColumn]) -> Iterator[tuple[Bar, TaskID]]:
    """A bar with the time it took and the time left, which goes when the block ends."""
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )
    from rich.progress import Progress as Bar

    with Bar(
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        *columns,
        TimeElapsedColumn(),
        TimeRemainingColumn(),
        TextColumn("left"),
        console=Console(stderr=True),
        transient=True,
        speed_estimate_period=_MEMORY,
    ) as bar:
        yield bar, bar.add_task(title, total=total)
