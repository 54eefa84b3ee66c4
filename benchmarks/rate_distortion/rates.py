"""Quality of every codec in the bytes of a JPEG 2000 file of each rate."""

from __future__ import annotations

import math
from collections.abc import Sequence

import click

from benchmarks.photographs import Photograph
from benchmarks.raster.codecs import JPEG2000, available_codecs
from benchmarks.raster.search import CodecSearch
from benchmarks.rate_distortion.coding import code_with_vmesh, rate_name
from benchmarks.rate_distortion.comparison import (
    METRICS,
    means_table,
    pictures_table,
    seconds_table,
    shares_table,
)
from benchmarks.rate_distortion.figures import Row, points_of, row_of
from benchmarks.rate_distortion.paper_coding import measure_paper, report_paper
from benchmarks.tables import Printer


def measure_rates(photograph: Photograph, *, effort: int, rates: Sequence[float]) -> list[Row]:
    """Every codec in the bytes of the JPEG 2000 file of each rate; and the paper's method."""
    click.echo(f"rates of {photograph.name}", err=True)
    pixels = photograph.pixels
    search = CodecSearch(pixels)
    rows = []
    for rate in rates:
        nominal = int(rate * pixels.shape[0] * pixels.shape[1] / 8)
        reference = search.best(JPEG2000, nominal, "full")
        if reference is None:
            click.echo(f"JPEG 2000 has no file of {nominal} bytes", err=True)
            continue
        budget = reference.n_bytes
        found = [code_with_vmesh(pixels, effort, target_size=budget)]
        found += [search.best(codec, budget) for codec in available_codecs()]
        rows += [
            row_of("rates", photograph, rate_name(rate), budget, coded)
            for coded in found
            if coded is not None
        ]
    return rows + measure_paper(photograph, effort)


def report_rates(printer: Printer, rows: list[Row]) -> None:
    """Print the pictures at each rate, the means, the seconds and the paper's method."""
    printer.heading("Rates")
    compared = [row for row in rows if row.part == "rates"]
    for metric in METRICS:
        if not all(math.isnan(getattr(row, metric)) for row in compared):
            printer.table(means_table(compared, metric))
    printer.paragraph(
        "Means of each codec and, in brackets, of vmesh less the codec over the same pictures; "
        "how many pictures the codec reached, where it did not reach all."
    )
    printer.table(shares_table(compared))
    printer.table(seconds_table(compared))
    for point in points_of(compared):
        printer.table(pictures_table([row for row in compared if row.point == point], point))
    report_paper(printer, [row for row in rows if row.part == "paper"])
