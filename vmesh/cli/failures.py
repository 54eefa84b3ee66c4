"""Sources that failed, of a command that went on with the others."""

from __future__ import annotations

import sys
from collections.abc import Iterable

import click


def end_with(failures: Iterable[tuple[str, str]]) -> None:
    """Tell what went wrong with which source, a line for each; with any, exit with status 1."""
    failed = list(failures)
    for source, error in failed:
        # Errors of the system name it themselves.
        sentence = error if error.startswith(source) else f"{source}: {error}"
        click.echo(f"vmesh: {sentence}", err=True)
    if failed:
        sys.exit(1)
