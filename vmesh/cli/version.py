"""Versions that a result may depend on, for ``vmesh --version``."""

from __future__ import annotations

import platform
from typing import Final

import click

from vmesh import __version__

_PACKAGES: Final = ("numpy", "numba", "scipy", "Pillow")


def show_version(ctx: click.Context, _: click.Parameter, is_asked_for: bool) -> None:
    """Print the versions and end, if the option is given."""
    if is_asked_for and not ctx.resilient_parsing:
        click.echo(versions())
        ctx.exit()


def versions() -> str:
    """Versions of the program, of the format it writes and of what it is built on, in lines."""
    from importlib.metadata import version

    from vmesh.codec.layout import VERSION

    lines = [
        f"vmesh {__version__}",
        f"format {VERSION[0]}.{VERSION[1]}",
        f"Python {platform.python_version()}",
    ]
    return "\n".join([*lines, *(f"{name} {version(name)}" for name in _PACKAGES)])


version_option = click.option(
    "--version",
    is_flag=True,
    is_eager=True,
    expose_value=False,
    callback=show_version,
    help="Show the versions that matter and exit.",
)
