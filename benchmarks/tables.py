"""Tables of figures with headings and remarks, printed as plain text or as GitHub's Markdown."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

import click

_LINE: Final = 100


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
        click.echo("\n" + textwrap.fill(text, _LINE, break_on_hyphens=False))

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
