"""Bits of each vertex in a file, beside other ways of storing the same mesh, and their speed."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import click

import vmesh
from benchmarks.file_format.coders import available_coders
from benchmarks.file_format.sizes import DENSITIES, measure_sizes, report_sizes
from benchmarks.file_format.speed import report_speed
from benchmarks.file_format.tiles import report_tiles
from benchmarks.options import (
    effort_option,
    images_option,
    limit_option,
    markdown_option,
    parts_option,
    repeat_option,
)
from benchmarks.photographs import Photograph, load_photographs
from benchmarks.software import describe_machine, describe_packages
from benchmarks.tables import Printer
from vmesh.mesh import Mesh

PARTS: Final = ("sizes", "speed", "tiles")
SPEED_DENSITY: Final = 0.02
N_TILED: Final = 3


@click.command()
@images_option
@limit_option()
@parts_option(PARTS)
@effort_option
@click.option(
    "--tile",
    type=click.IntRange(32, 2048),
    default=256,
    show_default=True,
    help="Pixels of a side of a tile.",
)
@repeat_option(9)
@markdown_option
def main(
    folder: Path,
    limit: int | None,
    parts: tuple[str, ...],
    effort: int,
    tile: int,
    repeat: int,
    markdown: bool,
) -> None:
    """Measure the format on meshes of a folder of photographs."""
    photographs = load_photographs(folder, limit)
    printer = Printer(markdown)
    coders = available_coders()
    if "sizes" in parts:
        found = []
        for photograph in photographs:
            click.echo(f"sizes of {photograph.name}", err=True)
            for density in DENSITIES:
                mesh = mesh_of(photograph, density, effort)
                found.append(measure_sizes(mesh, density, coders))
        report_sizes(printer, found, len(photographs))
    if "speed" in parts:
        report_speed(printer, mesh_of(photographs[0], SPEED_DENSITY, effort), coders, repeat)
    if "tiles" in parts:
        report_tiles(printer, photographs[:N_TILED], tile, effort)
    printer.heading("Conditions")
    packages = describe_packages("brotli", "zstandard", "DracoPy")
    printer.paragraph(f"vmesh at effort {effort}. {packages}")
    printer.paragraph(describe_machine())


def mesh_of(photograph: Photograph, density: float, effort: int) -> Mesh:
    """The mesh that the encoder makes of a photograph."""
    return vmesh.encode(
        photograph.pixels, vertices=round(density * photograph.n_pixels), effort=effort
    )


if __name__ == "__main__":
    main()
