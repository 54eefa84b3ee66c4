"""Speed of rasters, of the library and of the command line, with cold starts and memory."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Final

import click

import vmesh
from benchmarks.options import images_option, markdown_option, parts_option, repeat_option
from benchmarks.photographs import load_photographs
from benchmarks.software import describe_machine
from benchmarks.speed.library import report_library
from benchmarks.speed.processes import CommandLine, report_first_run, report_memory, report_starts
from benchmarks.speed.rasters import report_rasters
from benchmarks.tables import Printer

PARTS: Final = ("raster", "library", "starts", "first-run", "memory")


@click.command()
@images_option
@parts_option(PARTS)
@click.option(
    "--vertices", type=click.IntRange(4), default=20_000, show_default=True, help="Of the mesh."
)
@click.option(
    "--size",
    type=click.IntRange(1),
    nargs=2,
    default=(3840, 2160),
    show_default=True,
    help="Columns and rows of the rasters that are drawn.",
)
@click.option(
    "--large",
    type=click.IntRange(1),
    nargs=2,
    default=(4000, 3000),
    show_default=True,
    help="Columns and rows of the large picture whose encoding is measured.",
)
@repeat_option(7)
@markdown_option
def main(
    folder: Path,
    parts: tuple[str, ...],
    vertices: int,
    size: tuple[int, int],
    large: tuple[int, int],
    repeat: int,
    markdown: bool,
) -> None:
    """Measure decoders and the command line on the first photograph of a folder."""
    (photograph,) = load_photographs(folder, 1)
    printer = Printer(markdown)
    mesh = vmesh.encode(photograph.pixels, vertices=vertices)
    if "raster" in parts:
        report_rasters(printer, photograph, mesh, size, repeat)
    if "library" in parts:
        report_library(printer, photograph, mesh, repeat)
    with tempfile.TemporaryDirectory() as name:
        bench = CommandLine(Path(name), photograph.pixels, large)
        if "starts" in parts:
            report_starts(printer, bench, repeat)
        if "first-run" in parts:
            report_first_run(printer, bench)
        if "memory" in parts:
            report_memory(printer, bench)
    printer.paragraph(describe_machine())


if __name__ == "__main__":
    main()
