"""Progress on standard error, on a terminal only."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

Report = Callable[[str], None]


@contextmanager
def show_progress(title: str, n_stages: int, *, quiet: bool) -> Iterator[Report]:
    """Show a bar of stages while the block runs; yields what to call as each stage begins.

    Says so when compiled code is not in the cache yet, since the first run then takes longer.
    """
    if quiet or sys.stderr is None or not sys.stderr.isatty():
        yield lambda stage: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    from vmesh.kernels.jit import on_first_compilation

    console = Console(stderr=True)
    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task(title, total=n_stages + 1)

        def report(stage: str) -> None:
            bar.update(task, advance=1, description=f"{title}: {stage}")

        def announce() -> None:
            console.print("compiling (first run only)")

        with on_first_compilation(announce):
            yield report
