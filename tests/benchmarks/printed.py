"""Tables as the benchmarks print them, read back."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import click
from click.testing import CliRunner

_TABLE = re.compile(r"^#### (.*)\n\n((?:\|.*\|\n)+)", re.MULTILINE)
_NUMBER = re.compile(r"[+-]?\d+(\.\d+)?( bytes)?%?\*?")
_FIGURE = re.compile(
    rf"{_NUMBER.pattern}( \({_NUMBER.pattern}\))?( of \d+)?|\d+\.\d+ / \d+"
    r"|-|equal|met|missed by \d+%|missing|not installed"
)


@dataclass(frozen=True)
class PrintedTable:
    title: str
    header: list[str]
    is_figure: list[bool]
    rows: list[list[str]]


def run(command: click.Command, *options: str) -> list[PrintedTable]:
    """Tables that a benchmark prints, each checked to be well formed."""
    arguments: Sequence[Any] = [*options, "--markdown"]
    printed = CliRunner().invoke(command, arguments, catch_exceptions=False)
    assert printed.exit_code == 0, printed.output
    return tables_of(printed.output)


def tables_of(markdown: str) -> list[PrintedTable]:
    """Tables of a document, each checked to be well formed."""
    tables = []
    for title, body in _TABLE.findall(markdown):
        header, rule, *rows = (_cells(line) for line in body.splitlines())
        tables.append(PrintedTable(title, header, [cell.endswith(":") for cell in rule], rows))
    for table in tables:
        check(table)
    return tables


def check(table: PrintedTable) -> None:
    """A header, rows as long as it, words in some columns and figures in the others."""
    assert all(table.header), table
    assert table.rows, table
    for row in table.rows:
        assert len(row) == len(table.header) == len(table.is_figure), (table.title, row)
        figures = [cell for cell, is_figure in zip(row, table.is_figure, strict=True) if is_figure]
        assert all(_FIGURE.fullmatch(cell) for cell in figures), (table.title, row)
        assert any(map(_NUMBER.match, figures)) or "not installed" in figures, (table.title, row)


def _cells(line: str) -> list[str]:
    return [cell.strip() for cell in line.strip("|").split("|")]
