"""Quality of vmesh and of other lossy codecs at equal bytes, with seconds and memory."""

from __future__ import annotations

import math
import multiprocessing
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Final

import click
import numpy as np
from PIL import Image

from benchmarks.options import (
    effort_option,
    images_option,
    limit_option,
    markdown_option,
    parts_option,
)
from benchmarks.photographs import Photograph, load_photographs, n_pictures
from benchmarks.raster.codecs import describe_codecs
from benchmarks.rate_distortion.cost import report_speed
from benchmarks.rate_distortion.drawings import measure_drawings, report_drawings
from benchmarks.rate_distortion.figures import Row, write_rows
from benchmarks.rate_distortion.rates import measure_rates, report_rates
from benchmarks.rate_distortion.synthetic_pictures import synthetic_pictures
from benchmarks.rate_distortion.thumbnails import measure_thumbnails, report_thumbnails
from benchmarks.rate_distortion.upscaling import measure_upscaling, report_upscaling
from benchmarks.software import describe_machine, describe_packages
from benchmarks.tables import Printer

RATES: Final = "0.05,0.10,0.15,0.20,0.25,0.30,0.40,0.50,0.60"  # bits per pixel
PARTS: Final = ("rates", "thumbnails", "upscaling", "pictures", "speed")


Measure = Callable[[Photograph], list[Row]]


@dataclass(frozen=True, slots=True)
class Part:
    """A part of the benchmark: figures of a picture, what is printed of all, and the pictures."""

    measure: Measure
    report: Callable[[Printer, list[Row]], None]
    pictures: Sequence[Photograph]


def parse_rates(_: click.Context, __: click.Parameter, value: str) -> tuple[float, ...]:
    """Rates of a list with commas."""
    try:
        rates = tuple(float(rate) for rate in value.split(","))
    except ValueError as error:
        raise click.BadParameter(f"expected numbers with commas, got {value!r}") from error
    if not all(0 < rate < math.inf for rate in rates):
        raise click.BadParameter(f"expected rates above 0, got {value!r}")
    return rates


@click.command()
@images_option
@limit_option()
@click.option(
    "--reduce",
    "factor",
    type=click.IntRange(min=1),
    default=1,
    show_default=True,
    help="Reduce all pictures so many times.",
)
@effort_option
@click.option(
    "--rates",
    default=RATES,
    show_default=True,
    callback=parse_rates,
    help="Bits per pixel of the JPEG 2000 files whose bytes are the budgets.",
)
@parts_option(PARTS)
@click.option(
    "--jobs",
    type=click.IntRange(min=1),
    default=1,
    show_default=True,
    help="Processes. More than one disturb the seconds, not the quality.",
)
@click.option(
    "--largest",
    type=float,
    default=3.0,
    show_default=True,
    help="Megapixels of the largest picture of the part 'speed'.",
)
@click.option("--csv", "csv_path", type=click.Path(path_type=Path), help="File for all figures.")
@markdown_option
def main(
    folder: Path,
    limit: int | None,
    factor: int,
    effort: int,
    rates: tuple[float, ...],
    parts: tuple[str, ...],
    jobs: int,
    largest: float,
    csv_path: Path | None,
    markdown: bool,
) -> None:
    """Measure rate and distortion on a folder of photographs."""
    photographs = reduced(load_photographs(folder, limit), factor)
    drawings = reduced(synthetic_pictures()[:limit], factor) if "pictures" in parts else []
    printer = Printer(markdown)
    known = {
        "rates": Part(
            partial(measure_rates, effort=effort, rates=rates), report_rates, photographs
        ),
        "thumbnails": Part(
            partial(measure_thumbnails, effort=effort), report_thumbnails, photographs
        ),
        "upscaling": Part(partial(measure_upscaling, effort=effort), report_upscaling, photographs),
        "pictures": Part(partial(measure_drawings, effort=effort), report_drawings, drawings),
    }
    rows: list[Row] = []
    for name, part in known.items():
        if name in parts:
            found = measure_all(name, part, jobs)
            part.report(printer, found)
            rows += found
    if "speed" in parts:
        report_speed(printer, photographs[0], effort, largest)
    if csv_path is not None:
        write_rows(csv_path, rows)
    printer.heading("Conditions")
    printer.paragraph(f"vmesh at effort {effort}. {describe_codecs()}")
    printer.paragraph(describe_packages("ssimulacra2", "mozjpeg-lossless-optimization"))
    printer.paragraph(describe_machine())


def reduced(photographs: Sequence[Photograph], factor: int) -> list[Photograph]:
    """Pictures of a fraction of the size, by means of `factor` x `factor` pixels."""
    if factor == 1:
        return list(photographs)
    return [
        Photograph(own.name, np.asarray(Image.fromarray(own.pixels).reduce(factor)))
        for own in photographs
    ]


def measure_all(name: str, part: Part, jobs: int) -> list[Row]:
    """Rows of all pictures of a part, in their order."""
    click.echo(f"{name}: {n_pictures(len(part.pictures))}", err=True)
    if jobs == 1:
        return [row for picture in part.pictures for row in part.measure(picture)]
    # Started afresh: a copy of this process would inherit its locks and threads.
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(jobs, mp_context=context) as pool:
        return [row for rows in pool.map(part.measure, part.pictures) for row in rows]


if __name__ == "__main__":
    main()
