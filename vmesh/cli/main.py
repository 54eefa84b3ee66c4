"""The command ``vmesh``."""

from __future__ import annotations

import errno
import sys
from contextlib import suppress
from importlib import import_module
from io import TextIOWrapper
from typing import Final

import click

from vmesh.cli.failures import is_of_output, tell_trouble
from vmesh.cli.streams import STANDARD_OUTPUT, remark
from vmesh.cli.version import version_option
from vmesh.errors import VmeshError, describe, shown

# Command -> its module and its line in the overview; modules are imported when used.
COMMANDS: Final = {
    "encode": ("vmesh.cli.encode", "Turn a photograph into a .vmesh file."),
    "decode": ("vmesh.cli.decode", "Turn a .vmesh file into pixels at any scale."),
    "to-svg": ("vmesh.cli.to_svg", "Turn a .vmesh file or a photograph into SVG."),
    "to-pdf": ("vmesh.cli.to_pdf", "Turn a .vmesh file or a photograph into PDF."),
    "to-html": (
        "vmesh.cli.to_html",
        "Turn a .vmesh file or a photograph into a page for browsers.",
    ),
    "export": (
        "vmesh.cli.export_mesh",
        "Turn a .vmesh file or a photograph into a mesh for other programs.",
    ),
    "import": ("vmesh.cli.import_mesh", "Turn a mesh of another program into a .vmesh file."),
    "info": ("vmesh.cli.info", "Say what is in a .vmesh file."),
    "validate": ("vmesh.cli.validate", "Say all that is wrong with a .vmesh file."),
    "dump": ("vmesh.cli.dump", "Print the bytes of a .vmesh file with their meaning."),
    "batch": ("vmesh.cli.batch", "Encode many photographs, and turn them into other formats."),
    "inspect": ("vmesh.cli.inspect", "Draw the stages of an encoding."),
    "report": ("vmesh.cli.report", "Compare photographs with their meshes, on one page."),
    "compare": ("vmesh.cli.compare", "Measure how close two pictures or meshes are."),
}

# Errors of writing. Those of files name them, those of what click prints, such as help, do not.
_OF_WRITING: Final = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO)


class LazyGroup(click.Group):
    """A group that imports a command's module when the command is run."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Names of all commands, in the order of a user's work."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """The command of a name."""
        if cmd_name not in COMMANDS:
            return None
        command = import_module(COMMANDS[cmd_name][0]).command
        assert isinstance(command, click.Command)
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the overview from the table alone."""
        with formatter.section("Commands"):
            formatter.write_dl([(name, text) for name, (_, text) in COMMANDS.items()])


@click.group(cls=LazyGroup, context_settings={"help_option_names": ["-h", "--help"]})
@version_option
def cli() -> None:
    """Photographs as triangle meshes: encode, store, and turn into pixels, SVG, PDF and HTML.

    A file named - is standard input or output.
    """


def main() -> None:
    """Run the command line: exit 0 when done, 1 on a failure told in one line, 2 on wrong usage."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):  # What a terminal cannot show, it shows escaped.
            stream.reconfigure(errors="backslashreplace")
    status = _run()
    can_tell = sys.stderr is not None and not sys.stderr.closed
    if can_tell and "vmesh.kernels.jit" in sys.modules:
        from vmesh.kernels.jit import take_trouble

        tell_trouble(take_trouble())
    sys.exit(status)


def _run() -> int:
    """Run the command line; returns its status."""
    try:
        cli.main(standalone_mode=False)
        if sys.stdout is not None:
            sys.stdout.flush()
        return 0
    except SystemExit as stop:
        return stop.code if isinstance(stop.code, int) else 0
    except click.exceptions.Exit as stop:
        return stop.exit_code
    except click.exceptions.Abort as stop:
        if not isinstance(stop.__cause__, EOFError):
            return 130
        remark(describe(stop.__cause__))
    except click.UsageError as error:
        lines = error.format_message().split("\n")
        click.UsageError("\n".join(map(shown, lines)), error.ctx).show()
        return 2
    except BrokenPipeError:
        # The reader of our output has gone: nobody is left to tell.
        if sys.stderr is not None:
            sys.stderr.close()
    except (VmeshError, OSError, ValueError, MemoryError) as error:
        if isinstance(error, OSError) and error.filename is None and error.errno in _OF_WRITING:
            error.filename = STANDARD_OUTPUT
        if is_of_output(error):
            # Python would try again at the end, and say so in lines of its own.
            with suppress(OSError):
                sys.stdout.close()
        remark(describe(error))
    return 1
