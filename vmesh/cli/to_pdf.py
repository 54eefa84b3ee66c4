"""``vmesh to-pdf``: a .vmesh file or a photograph -> PDF."""

from __future__ import annotations

from typing import Any

import click

from vmesh.cli.limits import limit_options, take_limits
from vmesh.cli.options import encoder_options, quiet_option, take_settings
from vmesh.cli.streams import check_suffix
from vmesh.cli.vector import convert
from vmesh.formats.registry import FORMATS


@click.command("to-pdf")
@click.argument("source", metavar="INPUT")
@click.argument("target", metavar="OUTPUT")
@encoder_options
@limit_options
@quiet_option
def command(source: str, target: str, quiet: bool, **options: Any) -> None:
    """Turn a .vmesh file, or a photograph, into a PDF page of its size.

    The options of the encoder apply to photographs.
    """
    settings, limits = take_settings(options), take_limits(options)
    check_suffix(target, (".pdf",))
    convert(source, target, FORMATS[".pdf"], settings, limits, quiet=quiet)
