"""``vmesh to-html``: a .vmesh file or a photograph -> a page that shows it."""

from __future__ import annotations

from typing import Any

import click

from vmesh.cli.limits import limit_options, take_limits
from vmesh.cli.options import (
    encoder_options,
    picture_options,
    quiet_option,
    strip_option,
    take_picture_options,
    take_settings,
)
from vmesh.cli.streams import check_suffix, write_output
from vmesh.cli.vector import convert
from vmesh.formats.metadata.privacy import Strip
from vmesh.formats.registry import FORMATS


@click.command("to-html")
@click.argument("source", metavar="INPUT", required=False)
@click.argument("target", metavar="OUTPUT.html", required=False)
@click.option(
    "--element",
    metavar="FILE.js",
    help="Write the script of <vmesh-image src=...> for pages of your own, and nothing else.",
)
@picture_options
@strip_option("private")
@encoder_options
@limit_options
@quiet_option
def command(
    source: str | None,
    target: str | None,
    element: str | None,
    strip: Strip | None,
    quiet: bool,
    **options: Any,
) -> None:
    """Turn a .vmesh file, or a photograph, into one HTML file that shows it in a browser.

    The options of the encoder apply to photographs.
    """
    settings, limits = take_settings(options), take_limits(options)
    reading = take_picture_options(options)
    if element is not None:
        if source is not None:
            raise click.UsageError("--element takes no INPUT: the script is the same for all")
        write_element(element)
        return
    if source is None or target is None:
        raise click.UsageError("expected INPUT and OUTPUT.html, or --element FILE.js")
    check_suffix(target, (".html", ".htm"))
    convert(source, target, FORMATS[".html"], settings, reading, limits, quiet=quiet, strip=strip)


def write_element(target: str) -> None:
    """Write the script of the custom element."""
    check_suffix(target, (".js", ".mjs"))
    from vmesh.formats.html.document import element_script

    write_output(target, lambda stream: stream.write(element_script().encode()))
