"""docs/benchmarks.md shows commands, and between its prose what they print."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

import click
from click.testing import CliRunner

from benchmarks.document import commands
from benchmarks.document import main as document
from tests.benchmarks.printed import tables_of

ROOT = Path(__file__).parents[2]
TEXT = """# Figures

```sh
python -m benchmarks.paper --images PHOTOGRAPHS --part points \\
    --limit 1 --markdown
```

<!-- printed -->
Of old.
<!-- end -->

Between.

```sh
python -m benchmarks.file_format --images PHOTOGRAPHS --markdown
```

<!-- printed -->
<!-- end -->
"""


def command_of(module: str) -> click.Command:
    command = import_module(f"{module}.__main__").main
    assert isinstance(command, click.Command)
    return command


def test_the_tables_are_written_between_the_prose(tmp_path: Path, folder: str) -> None:
    target = tmp_path / "figures.md"
    target.write_text(TEXT, encoding="utf-8")
    options = ["--images", folder, "--only", "paper", "--document", str(target)]
    done = CliRunner().invoke(document, options, catch_exceptions=False)
    assert done.exit_code == 0, done.output
    text = target.read_text("utf-8")
    before, after = text.split("Between.")
    assert after == TEXT.split("Between.")[1]
    assert "Of old." not in text
    assert "*Printed at commit " in before
    (table,) = tables_of(before)
    assert table.title == "Distinct points (density), 1 picture"
    assert list(commands(text)) == list(commands(TEXT))


def test_the_benchmarks_take_the_commands_of_the_document(folder: str) -> None:
    text = (ROOT / "docs" / "benchmarks.md").read_text("utf-8")
    found = list(commands(text))
    assert found
    for _, _, module, *options in found:
        assert "--markdown" in options
        there = [folder if option == "PHOTOGRAPHS" else option for option in options]
        command_of(module).make_context(module, there)


def test_the_tables_of_the_document_are_well_formed() -> None:
    tables_of((ROOT / "docs" / "benchmarks.md").read_text("utf-8"))
