"""Points, quality, bits and speed of the encoder, as its paper measured them.

X. Zhao, J. Feng, B. Zhou, "Image vectorization using blue-noise sampling", 2013.
"""

from __future__ import annotations

from pathlib import Path
from typing import Final

import click

from benchmarks.options import (
    images_option,
    limit_option,
    markdown_option,
    parts_option,
    repeat_option,
)
from benchmarks.paper.adaptive import report_adaptive
from benchmarks.paper.bits import report_bits
from benchmarks.paper.points import report_points
from benchmarks.paper.quality import report_quality
from benchmarks.paper.stages import report_speed
from benchmarks.photographs import load_photographs
from benchmarks.software import describe_machine
from benchmarks.tables import Printer

PARTS: Final = ("points", "quality", "adaptive", "bits", "speed")


@click.command()
@images_option
@limit_option()
@parts_option(PARTS)
@click.option("--each", is_flag=True, help="Rows of each photograph as well as the means.")
@click.option(
    "--effort",
    "efforts",
    type=click.IntRange(1, 9),
    multiple=True,
    default=(5,),
    show_default=True,
    help="Of the adaptive method; may be given more than once.",
)
@click.option(
    "--vertices",
    type=click.IntRange(4),
    default=20_000,
    show_default=True,
    help="Of the mesh whose stages are timed.",
)
@repeat_option(15)
@markdown_option
def main(
    folder: Path,
    limit: int | None,
    parts: tuple[str, ...],
    each: bool,
    efforts: tuple[int, ...],
    vertices: int,
    repeat: int,
    markdown: bool,
) -> None:
    """Measure the encoder on a folder of photographs, as its paper measured it."""
    photographs = load_photographs(folder, limit)
    printer = Printer(markdown)
    if "points" in parts:
        report_points(printer, photographs, each)
    if "quality" in parts:
        report_quality(printer, photographs, each)
    if "adaptive" in parts:
        report_adaptive(printer, photographs, efforts, each)
    if "bits" in parts:
        report_bits(printer, photographs, each)
    if "speed" in parts:
        report_speed(printer, photographs[0], vertices, repeat)
    printer.paragraph(describe_machine())


if __name__ == "__main__":
    main()
