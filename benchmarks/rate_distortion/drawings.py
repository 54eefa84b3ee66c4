"""Drawings, which are no photographs, by every codec and without loss."""

from __future__ import annotations

import math
from typing import Final

import click

from benchmarks.photographs import Photograph
from benchmarks.raster.codecs import lossless_sizes
from benchmarks.raster.search import Coded
from benchmarks.rate_distortion.coding import measure_points, rate_name
from benchmarks.rate_distortion.comparison import means_table, pictures_table
from benchmarks.rate_distortion.figures import Row, codecs_of, pictures_of, points_of, row_of
from benchmarks.tables import Printer, Table

DRAWN_RATES: Final = (0.10, 0.25, 0.50)


def measure_drawings(photograph: Photograph, *, effort: int) -> list[Row]:
    """Every codec on a picture that is no photograph, and its lossless files."""
    click.echo(f"drawing {photograph.name}", err=True)
    pixels = photograph.pixels
    n_pixels = pixels.shape[0] * pixels.shape[1]
    points = {rate_name(rate): int(rate * n_pixels / 8) for rate in DRAWN_RATES}
    rows = measure_points("pictures", photograph, effort, points)
    for codec, size in lossless_sizes(pixels).items():
        whole = Coded(codec, "", size, pixels, math.nan, math.nan)
        rows.append(row_of("pictures", photograph, "lossless", 0, whole, perceptual=False))
    return rows


def report_drawings(printer: Printer, rows: list[Row]) -> None:
    """Print the quality of pictures that are no photographs, and their lossless sizes."""
    printer.heading("Pictures that are no photographs")
    lossy = [row for row in rows if row.point != "lossless"]
    for point in points_of(lossy):
        printer.table(pictures_table([row for row in lossy if row.point == point], point))
    printer.table(means_table(lossy, "ssim"))
    lossless = [row for row in rows if row.point == "lossless"]
    codecs = codecs_of(lossless)
    sizes = {(row.picture, row.codec): row.n_bytes for row in lossless}
    lines = [
        (picture, *(str(sizes[picture, codec]) for codec in codecs))
        for picture in pictures_of(lossless)
    ]
    printer.table(Table("Bytes of lossless files", ("picture", *codecs), lines))
    printer.paragraph("A lossless file that is within a budget of bytes beats all the lossy ones.")
