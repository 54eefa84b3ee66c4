"""Vector output: bytes, seconds, and how close programs that others wrote draw it to our raster."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import click

from benchmarks.options import images_option, limit_option, markdown_option, parts_option
from benchmarks.photographs import load_photographs
from benchmarks.software import describe_machine
from benchmarks.tables import Printer
from benchmarks.vector_output.modes import report_modes
from benchmarks.vector_output.photographs_as_svg import report_peers
from benchmarks.vector_output.renderers import renderer_names, renderers_by_suffix

PARTS: Final = ("modes", "peers")
METHODS: Final = ("adaptive", "blue-noise")


@click.command()
@images_option
@limit_option(3)
@parts_option(PARTS)
@click.option(
    "--vertices",
    multiple=True,
    type=click.IntRange(4),
    default=(1_000, 5_000, 20_000),
    show_default=True,
    help="Of the meshes; may be given more than once.",
)
@click.option(
    "--method",
    "methods",
    multiple=True,
    type=click.Choice(METHODS),
    default=("adaptive",),
    show_default=True,
    help="Of the meshes of the part 'modes'; may be given more than once.",
)
@click.option(
    "--renderer",
    "wanted",
    multiple=True,
    type=click.Choice(renderer_names()),
    help="Of the part 'modes', all unless given; may be given more than once.",
)
@markdown_option
def main(
    folder: Path,
    limit: int,
    parts: tuple[str, ...],
    vertices: tuple[int, ...],
    methods: tuple[str, ...],
    wanted: tuple[str, ...],
    markdown: bool,
) -> None:
    """Measure vector output on photographs of a folder."""
    printer = Printer(markdown)
    photographs = load_photographs(folder, limit)
    if "modes" in parts:
        report_modes(printer, photographs, methods, vertices, renderers_by_suffix(wanted))
    if "peers" in parts:
        report_peers(printer, photographs, vertices)
    printer.paragraph(describe_machine())


if __name__ == "__main__":
    main()
