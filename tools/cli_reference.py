"""Write ``docs/cli.md``, the reference of the command line, from the commands themselves.

``python -m tools.cli_reference`` writes it; a test says when it is out of date.
"""

from __future__ import annotations

from pathlib import Path
from typing import Final

import click

from tools.made_document import keep
from vmesh.cli.main import COMMANDS, cli

TARGET: Final = Path(__file__).parents[1] / "docs" / "cli.md"

_WIDTH: Final = 90
_START: Final = """# The command line

Written by `python -m tools.cli_reference` from the commands; not to be edited.

The shell completes commands and options once it is told to, by a line in its start-up file:

| shell | file | line |
|---|---|---|
| bash 4.4 or newer | `~/.bashrc` | `eval "$(_VMESH_COMPLETE=bash_source vmesh)"` |
| zsh | `~/.zshrc` | `eval "$(_VMESH_COMPLETE=zsh_source vmesh)"` |
| fish | `~/.config/fish/completions/vmesh.fish` | `_VMESH_COMPLETE=fish_source vmesh \\| source` |
"""


def reference() -> str:
    """The reference: the help of the program and of each command."""
    parent = click.Context(cli, info_name="vmesh", terminal_width=_WIDTH, **cli.context_settings)
    sections = [_section(cli, parent)]
    for name in COMMANDS:
        command = cli.get_command(parent, name)
        assert command is not None
        sections.append(_section(command, click.Context(command, parent, info_name=name)))
    return "\n".join([_START, *sections])


def _section(command: click.Command, context: click.Context) -> str:
    """A heading and the help of a command, as it prints it."""
    return f"## {context.command_path}\n\n```\n{command.get_help(context)}\n```\n"


@click.command()
@click.option("--check", is_flag=True, help="Write nothing; the status is 1 if it is out of date.")
def main(check: bool) -> None:
    """Write docs/cli.md."""
    keep(TARGET, reference(), "python -m tools.cli_reference", check=check)


if __name__ == "__main__":
    main()
