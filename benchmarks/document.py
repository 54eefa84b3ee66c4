"""``docs/benchmarks.md``: the tables between its prose, printed by the commands that it shows.

A block of the document is a command in a fence, and between two comments what the command printed::

    ```sh
    python -m benchmarks.paper --images PHOTOGRAPHS --markdown
    ```

    <!-- printed -->
    ...
    <!-- end -->
"""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import click

from benchmarks.options import images_option

ROOT: Final = Path(__file__).parents[1]
DOCUMENT: Final = ROOT / "docs" / "benchmarks.md"
PHOTOGRAPHS: Final = "PHOTOGRAPHS"  # stands for the folder in the commands

_BLOCK: Final = re.compile(
    r"```sh\n(?P<command>python -m benchmarks\.[^`]*)\n```\n\n"
    r"<!-- printed -->\n(?P<printed>.*?)<!-- end -->",
    re.DOTALL,
)


@click.command()
@images_option
@click.option("--only", default="", help="Only commands that contain this.")
@click.option(
    "--document",
    type=click.Path(exists=True, dir_okay=False, path_type=Path),
    default=DOCUMENT,
    help="docs/benchmarks.md unless given.",
)
def main(folder: Path, only: str, document: Path) -> None:
    """Run the commands of a document and write what they print where it stands there."""
    n_blocks = len(_BLOCK.findall(document.read_text("utf-8")))
    for number in range(n_blocks):
        # Written after each command: what is printed is not lost if a later one fails.
        text = document.read_text("utf-8")
        block = list(_BLOCK.finditer(text))[number]
        if only in block["command"]:
            click.echo(f"{number + 1} of {n_blocks}: {block['command']}", err=True)
            start, end = block.span("printed")
            printed = run(block["command"], folder)
            document.write_text(text[:start] + printed + text[end:], "utf-8", newline="\n")


def commands(text: str) -> Iterator[list[str]]:
    """Words of the commands of a document, from ``python`` on."""
    for block in _BLOCK.finditer(text):
        yield words(block["command"])


def words(command: str) -> list[str]:
    """Words of a command, whose lines may end in a backslash."""
    return shlex.split(command.replace("\\\n", " "))


def run(command: str, folder: Path) -> str:
    """Lines that a command prints on a folder of photographs, under a line on where and when."""
    _, *arguments = words(command)
    arguments = [str(folder.resolve()) if word == PHOTOGRAPHS else word for word in arguments]
    started = time.perf_counter()
    done = subprocess.run(
        [sys.executable, *arguments], cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True
    )
    seconds = time.perf_counter() - started
    return f"\n*Printed at {describe_commit()}, in {seconds:.0f} s.*\n{done.stdout}\n"


def describe_commit() -> str:
    """The commit that is checked out, and whether the code has changed since."""
    try:
        commit = _git("rev-parse", "--short", "HEAD")
        changed = _git("status", "--porcelain", "--", "vmesh", "benchmarks")
    except (OSError, subprocess.CalledProcessError):
        return "an unknown commit"
    return f"commit {commit}" + " with changes" * bool(changed)


def _git(*arguments: str) -> str:
    done = subprocess.run(["git", *arguments], cwd=ROOT, check=True, capture_output=True, text=True)
    return done.stdout.strip()


if __name__ == "__main__":
    main()
