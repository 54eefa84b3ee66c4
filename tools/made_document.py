"""Documents that are made of the code: written, or held against what they would be."""

from __future__ import annotations

from pathlib import Path

import click


def keep(target: Path, text: str, command: str, *, check: bool) -> None:
    """Write a document, or end with status 1 if it is to be checked and says something else.

    `command` is what makes it, for the sentence that says so.
    """
    if not check:
        target.write_text(text, "utf-8", newline="\n")
    elif target.read_text("utf-8") != text:
        place = target.relative_to(Path(__file__).parents[1])
        raise click.ClickException(f"{place} is out of date: run {command}")
