"""What the benchmarks share: photographs to read, times to take and tables to print."""

from __future__ import annotations

import os
import platform
import subprocess
import sys
import textwrap
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from statistics import median
from typing import Any, Final

import click

from vmesh.arrays import UInt8Array
from vmesh.formats.raster.picture import flatten, read_picture

_SUFFIXES: Final = (".png", ".jpg", ".jpeg")
_SHIPPED: Final = Path(__file__).resolve().parent.parent / "tests" / "images"
_PACKAGES: Final = ("numpy", "numba", "scipy")
_LINE: Final = 100
# In a small process of its own: the peak that a process is charged with starts at its parent's.
_MEASURE_CHILD: Final = """
import resource, subprocess, sys
subprocess.run(sys.argv[1:], check=True)
peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
print(peak if sys.platform == "darwin" else 1024 * peak)
"""

images_option = click.option(
    "--images",
    "folder",
    type=click.Path(exists=True, file_okay=False, path_type=Path),
    default=_SHIPPED,
    help="Folder of photographs, .png or .jpg; those of the tests unless given.",
)
markdown_option = click.option("--markdown", is_flag=True, help="Print tables for GitHub.")


@dataclass(frozen=True, slots=True)
class Photograph:
    """A picture to measure on: its name, and its pixels of shape (h, w, 3), uint8."""

    name: str
    pixels: UInt8Array


@dataclass(frozen=True, slots=True)
class Timing:
    """Seconds that an action took: the median of its runs, the shortest and the longest."""

    median: float
    shortest: float
    longest: float

    def cells(self, unit: float = 1e-3) -> tuple[str, str, str]:
        """The three figures in units of `unit` seconds."""
        figures = (self.median, self.shortest, self.longest)
        first, second, third = (f"{seconds / unit:.2f}" for seconds in figures)
        return first, second, third


@dataclass(frozen=True, slots=True)
class Table:
    """A table: its title, the names of its columns, its rows, and how many columns hold words."""

    title: str
    header: tuple[str, ...]
    rows: Sequence[tuple[str, ...]]
    n_words: int = 1


@dataclass(frozen=True, slots=True)
class Printer:
    """Prints headings, paragraphs and tables, as plain text or as GitHub's Markdown."""

    markdown: bool

    def heading(self, text: str) -> None:
        """Print the title of a section."""
        click.echo(f"\n### {text}" if self.markdown else f"\n{text}\n{'=' * len(text)}")

    def paragraph(self, text: str) -> None:
        """Print sentences."""
        click.echo("\n" + (text if self.markdown else textwrap.fill(text, _LINE)))

    def table(self, table: Table) -> None:
        """Print a table; figures are set to the right."""
        click.echo(f"\n#### {table.title}\n" if self.markdown else f"\n{table.title}\n")
        rows = [table.header, *table.rows]
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        lines = [self._line(row, widths, table.n_words) for row in rows]
        lines.insert(1, self._rule(widths, table.n_words))
        click.echo("\n".join(lines))

    def _line(self, row: Iterable[str], widths: list[int], n_words: int) -> str:
        cells = [
            cell.ljust(width) if i < n_words else cell.rjust(width)
            for i, (cell, width) in enumerate(zip(row, widths, strict=True))
        ]
        return f"| {' | '.join(cells)} |" if self.markdown else "  ".join(cells).rstrip()

    def _rule(self, widths: list[int], n_words: int) -> str:
        if not self.markdown:
            return "  ".join("-" * width for width in widths)
        dashes = [
            "-" * (width + 2) if i < n_words else "-" * (width + 1) + ":"
            for i, width in enumerate(widths)
        ]
        return f"|{'|'.join(dashes)}|"


def load_photographs(folder: Path, names: Sequence[str] | None = None) -> list[Photograph]:
    """All photographs of a folder as RGB, by name; of some names only, if they are given."""
    paths = sorted(path for path in folder.iterdir() if path.suffix.lower() in _SUFFIXES)
    paths = [path for path in paths if names is None or path.stem in names]
    if not paths:
        raise click.UsageError(f"{folder}: no photographs that end in {', '.join(_SUFFIXES)}")
    return [load_photograph(path) for path in paths]


def load_photograph(path: Path) -> Photograph:
    """The photograph in a file, as RGB."""
    with path.open("rb") as stream:
        return Photograph(path.stem, flatten(read_picture(stream).array))


def time_actions(actions: Mapping[str, Callable[[], object]], runs: int) -> dict[str, Timing]:
    """Times of several actions, taken in turns so that other load falls on all of them alike.

    Each is run once before, so that its code is compiled and its data are in the caches.
    """
    for action in actions.values():
        action()
    seconds: dict[str, list[float]] = {name: [] for name in actions}
    for _ in range(runs):
        for name, action in actions.items():
            started = time.perf_counter()
            action()
            seconds[name].append(time.perf_counter() - started)
    return {name: Timing(median(own), min(own), max(own)) for name, own in seconds.items()}


def measure_process(*command: str, environment: Mapping[str, str] | None = None) -> tuple[str, int]:
    """What a process prints, and the most memory that it held, in bytes."""
    measuring = (sys.executable, "-c", _MEASURE_CHILD, *command)
    printed = subprocess.run(
        measuring, check=True, env=environment, stdout=subprocess.PIPE, text=True
    ).stdout
    own, _, peak = printed.rstrip().rpartition("\n")
    return own, int(peak)


def judge(found: float, most: float) -> str:
    """Whether a figure that should be small keeps to its bound, and by how much it does not."""
    return "met" if found <= most else f"missed by {found / most - 1:.0%}"


def describe_machine() -> str:
    """What of the machine and its software the figures depend on."""
    cores = os.cpu_count() or 1
    software = [f"Python {platform.python_version()}"]
    software += [f"{name} {version_of(name)}" for name in _PACKAGES]
    return f"{platform.machine()}, {cores} core{'s' * (cores != 1)}; {', '.join(software)}."


def import_optional(name: str) -> Any:
    """A module, None if it is not installed."""
    try:
        return import_module(name)
    except ImportError:
        return None


def version_of(package: str) -> str:
    """Version of an installed package."""
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"
