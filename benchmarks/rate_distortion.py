"""Measure vmesh beside the other lossy codecs: quality at equal bytes, seconds and memory."""

from __future__ import annotations

import json
import math
import multiprocessing
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path
from statistics import mean
from typing import Any, Final

import click
import numpy as np
from PIL import Image

import vmesh
from benchmarks.codec_figures import (
    METRICS,
    VMESH,
    Row,
    codecs_of,
    means_table,
    pictures_of,
    pictures_table,
    points_of,
    row_of,
    seconds_table,
    shares_table,
    write_rows,
)
from benchmarks.measurement import (
    Photograph,
    Printer,
    Table,
    describe_machine,
    images_option,
    load_photographs,
    markdown_option,
    measure_process,
    version_of,
)
from benchmarks.raster_codecs import (
    JPEG2000,
    CodecSearch,
    Coded,
    available_codecs,
    describe_codecs,
    lossless_sizes,
)
from benchmarks.synthetic_pictures import synthetic_pictures
from vmesh.arrays import UInt8Array

PAPER: Final = "paper"
RATES: Final = "0.05,0.10,0.15,0.20,0.25,0.30,0.40,0.50,0.60"  # bits per pixel
THUMBNAIL_SIDE: Final = 192
THUMBNAIL_BYTES: Final = (200, 400, 800)
ENLARGEMENT: Final = 2
HIGH_QUALITY: Final = 95
FILTERS: Final = {
    "bilinear": Image.Resampling.BILINEAR,
    "bicubic": Image.Resampling.BICUBIC,
    "Lanczos": Image.Resampling.LANCZOS,
}
DRAWN_RATES: Final = (0.10, 0.25, 0.50)
PAPER_BYTES: Final = 7  # a vertex: the paper's Table 1
PAPER_GOAL: Final = 12  # times fewer bytes than the paper's coding
SPEED_RATE: Final = 0.20
EFFORTS: Final = (1, 5, 9)
MEGAPIXELS: Final = (0.1, 0.3, 1, 3, 6, 12, 24)

# Encodes one picture in a process of its own, whose memory nothing else has touched.
ENCODE_CHILD: Final = """
import json, sys, time
import numpy as np
import vmesh
path, n_bytes, effort = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
pixels = np.load(path)
noise = np.random.default_rng(0).integers(0, 256, (96, 96, 3), dtype=np.uint8)
vmesh.render(vmesh.loads(vmesh.dumps(vmesh.encode(noise, target_size=600, effort=effort))))
started = time.perf_counter()
data = vmesh.dumps(vmesh.encode(pixels, target_size=n_bytes, effort=effort))
encoded = time.perf_counter()
raster = vmesh.render(vmesh.loads(data))
decoded = time.perf_counter()
# By rows: whole pictures of floating-point numbers would be the peak.
error = np.mean([np.mean(np.square(a.astype(float) - b)) for a, b in zip(pixels, raster)])
print(json.dumps([len(data), encoded - started, decoded - encoded, float(error)]))
"""


Measure = Callable[[Photograph], list[Row]]


@dataclass(frozen=True, slots=True)
class Part:
    """A part of the benchmark: rows of each picture, and what is printed of all of them."""

    measure: Measure
    report: Callable[[Printer, list[Row]], None]
    pictures: Callable[[list[Photograph]], list[Photograph]] = list


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
@markdown_option
@click.option("--effort", type=click.IntRange(1, 9), default=5, show_default=True)
@click.option(
    "--rates",
    default=RATES,
    show_default=True,
    callback=parse_rates,
    help="Bits per pixel of the JPEG 2000 files whose bytes are the budgets.",
)
@click.option("--limit", type=click.IntRange(min=1), help="Only so many pictures of the folder.")
@click.option(
    "--part",
    "parts",
    type=click.Choice(["rates", "thumbnails", "upscaling", "pictures", "speed"]),
    multiple=True,
    help="Only this part; may be given more than once.",
)
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
def main(
    folder: Path,
    markdown: bool,
    effort: int,
    rates: tuple[float, ...],
    limit: int | None,
    parts: tuple[str, ...],
    jobs: int,
    largest: float,
    csv_path: Path | None,
) -> None:
    """Measure rate and distortion on a folder of photographs."""
    photographs = load_photographs(folder)[:limit]
    printer = Printer(markdown)
    known = {
        "rates": Part(partial(measure_rates, effort=effort, rates=rates), report_rates),
        "thumbnails": Part(partial(measure_thumbnails, effort=effort), report_thumbnails),
        "upscaling": Part(partial(measure_upscaling, effort=effort), report_upscaling),
        "pictures": Part(
            partial(measure_drawings, effort=effort),
            report_drawings,
            lambda _: synthetic_pictures(),
        ),
    }
    rows: list[Row] = []
    for name, part in known.items():
        if not parts or name in parts:
            found = measure_all(name, part.measure, part.pictures(photographs), jobs)
            part.report(printer, found)
            rows += found
    if not parts or "speed" in parts:
        report_speed(printer, photographs[0], effort, largest)
    if csv_path is not None:
        write_rows(csv_path, rows)
    printer.heading("Conditions")
    printer.paragraph(f"vmesh at effort {effort}. {describe_codecs()}")
    printer.paragraph(describe_optional())
    printer.paragraph(describe_machine())


def measure_all(name: str, measure: Measure, photographs: list[Photograph], jobs: int) -> list[Row]:
    """Rows of all pictures, in their order."""
    click.echo(f"{name}: {len(photographs)} pictures", err=True)
    if jobs == 1:
        return [row for photograph in photographs for row in measure(photograph)]
    # Started afresh: a copy of this process would inherit its locks and threads.
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(jobs, mp_context=context) as pool:
        return [row for rows in pool.map(measure, photographs) for row in rows]


def code_with_vmesh(pixels: UInt8Array, effort: int, **target: Any) -> Coded | None:
    """A picture that went through a .vmesh file, None if the target is out of reach.

    Parameters
    ----------
    pixels : ndarray
        Shape (h, w, 3), uint8.
    effort : int
    **target
        What `vmesh.encode` is to reach: ``target_size``, ``target_psnr``, ``quality``.
    """
    warm_up(effort)
    started = time.perf_counter()
    try:
        data = vmesh.dumps(vmesh.encode(pixels, effort=effort, **target))
    except ValueError as error:
        click.echo(f"vmesh, {target}: {error}", err=True)
        return None
    encoded = time.perf_counter()
    raster = vmesh.render(vmesh.loads(data))
    decoded = time.perf_counter()
    settings = ", ".join(f"{name} {value}" for name, value in target.items())
    return Coded(VMESH, settings, len(data), raster, encoded - started, decoded - encoded)


@cache
def warm_up(effort: int) -> None:
    """Have everything compiled before anything is timed."""
    pixels = np.random.default_rng(0).integers(0, 256, (96, 96, 3), dtype=np.uint8)
    targets: tuple[dict[str, Any], ...] = ({"target_size": 600}, {"quality": 50})
    for target in targets:
        vmesh.render(vmesh.loads(vmesh.dumps(vmesh.encode(pixels, effort=effort, **target))))


def describe_optional() -> str:
    """Which of the packages that can be missing are there."""
    names = ("ssimulacra2", "mozjpeg-lossless-optimization")
    return "Optional packages: " + ", ".join(f"{name} {version_of(name)}" for name in names) + "."


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


def rate_name(rate: float) -> str:
    """A rate as the tables show it."""
    return f"{rate:.2f} bpp"


def measure_paper(photograph: Photograph, effort: int) -> list[Row]:
    """The paper's method at its natural number of points, and vmesh at the same PSNR.

    Its colours are those of the pixels, in eight bits, and every vertex takes seven bytes.
    """
    pixels = photograph.pixels
    rows = []
    for colors in ("sampled", "fitted"):
        started = time.perf_counter()
        mesh = vmesh.encode(pixels, method="blue-noise", gamma=1.0, colors=colors, color_step=1)
        encoded = time.perf_counter()
        raster = vmesh.render(mesh)
        decoded = time.perf_counter()
        settings = f"{mesh.n_vertices} vertices, {colors} colours"
        paper = Coded(
            PAPER,
            settings,
            PAPER_BYTES * mesh.n_vertices,
            raster,
            encoded - started,
            decoded - encoded,
        )
        rows.append(row_of("paper", photograph, colors, 0, paper, perceptual=False))
        coded = code_with_vmesh(pixels, effort, target_psnr=rows[-1].psnr_rgb)
        if coded is not None:
            rows.append(row_of("paper", photograph, colors, 0, coded, perceptual=False))
    return rows


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


def report_paper(printer: Printer, rows: list[Row]) -> None:
    """Print how many bytes vmesh takes for the PSNR of the paper's method."""
    lines = []
    ratios: dict[str, list[float]] = {}
    for picture, colors in dict.fromkeys((row.picture, row.point) for row in rows):
        own = {row.codec: row for row in rows if (row.picture, row.point) == (picture, colors)}
        paper, ours = own[PAPER], own.get(VMESH)
        cells = [f"{paper.psnr_rgb:.2f}", str(paper.n_bytes // PAPER_BYTES), str(paper.n_bytes)]
        if ours is None:
            cells += ["-"] * 3
        else:
            ratio = paper.n_bytes / ours.n_bytes
            ratios.setdefault(colors, []).append(ratio)
            cells += [f"{ours.psnr_rgb:.2f}", str(ours.n_bytes), f"{ratio:.1f}"]
        lines.append((picture, colors, *cells))
    lines += [
        ("mean", colors, *("-",) * 5, f"{mean(values):.1f}") for colors, values in ratios.items()
    ]
    header = (
        "picture",
        "colors",
        "paper, dB",
        "vertices",
        "bytes",
        "vmesh, dB",
        "bytes",
        "times fewer",
    )
    title = "The paper's method at gamma 1, and vmesh at its PSNR"
    printer.table(Table(title, header, lines, n_words=2))
    printer.paragraph(
        f"The paper's coding takes {PAPER_BYTES} bytes a vertex. Its colors are sampled; fitted "
        f"ones are ours. The goal is {PAPER_GOAL} times fewer bytes beside the sampled ones."
    )


def measure_thumbnails(photograph: Photograph, *, effort: int) -> list[Row]:
    """Every codec at a few hundred bytes."""
    click.echo(f"thumbnail of {photograph.name}", err=True)
    image = Image.fromarray(photograph.pixels)
    scale = THUMBNAIL_SIDE / max(image.size)
    size = (max(1, round(image.width * scale)), max(1, round(image.height * scale)))
    reduced = np.asarray(image.resize(size, Image.Resampling.LANCZOS))
    thumbnail = Photograph(photograph.name, reduced)
    points = {f"{n_bytes} bytes": n_bytes for n_bytes in THUMBNAIL_BYTES}
    return measure_points("thumbnails", thumbnail, effort, points, perceptual=False)


def measure_points(
    part: str,
    photograph: Photograph,
    effort: int,
    points: dict[str, int],
    perceptual: bool = True,
) -> list[Row]:
    """Every codec within budgets of bytes."""
    search = CodecSearch(photograph.pixels)
    rows = []
    for point, budget in points.items():
        found = [code_with_vmesh(photograph.pixels, effort, target_size=budget)]
        found += [search.best(codec, budget) for codec in available_codecs()]
        rows += [
            row_of(part, photograph, point, budget, coded, perceptual)
            for coded in found
            if coded is not None
        ]
    return rows


def report_thumbnails(printer: Printer, rows: list[Row]) -> None:
    """Print the quality of thumbnails."""
    printer.heading("Thumbnails")
    for metric in ("psnr_rgb", "psnr_y", "ssim"):
        printer.table(means_table(rows, metric))
    for point in points_of(rows):
        printer.table(pictures_table([row for row in rows if row.point == point], point))


def measure_upscaling(photograph: Photograph, *, effort: int) -> list[Row]:
    """A picture of half the size enlarged: as a mesh, and with Pillow's filters."""
    click.echo(f"upscaling of {photograph.name}", err=True)
    height, width = (side // ENLARGEMENT * ENLARGEMENT for side in photograph.pixels.shape[:2])
    whole = Photograph(photograph.name, photograph.pixels[:height, :width])
    image = Image.fromarray(whole.pixels)
    reduced = image.reduce(ENLARGEMENT)
    warm_up(effort)
    started = time.perf_counter()
    data = vmesh.dumps(vmesh.encode(np.asarray(reduced), quality=HIGH_QUALITY, effort=effort))
    encoded = time.perf_counter()
    raster = vmesh.render(vmesh.loads(data), scale=ENLARGEMENT)
    seconds = (encoded - started, time.perf_counter() - encoded)
    enlarged = [Coded(VMESH, f"quality {HIGH_QUALITY}", len(data), raster, *seconds)]
    for name, resampling in FILTERS.items():
        started = time.perf_counter()
        pixels = np.asarray(reduced.resize(image.size, resampling))
        elapsed = time.perf_counter() - started
        enlarged.append(Coded(name, "", 0, pixels, 0.0, elapsed))
    return [row_of("upscaling", whole, f"{ENLARGEMENT}x", 0, coded) for coded in enlarged]


def report_upscaling(printer: Printer, rows: list[Row]) -> None:
    """Print what enlarging gives."""
    printer.heading("Upscaling")
    pictures, codecs = pictures_of(rows), codecs_of(rows)
    values = {(row.picture, row.codec): row.psnr_rgb for row in rows}
    sizes = {row.picture: row.n_bytes for row in rows if row.codec == VMESH}
    lines = [
        (picture, str(sizes[picture]), *(f"{values[picture, codec]:.2f}" for codec in codecs))
        for picture in pictures
    ]
    means = (mean(values[picture, codec] for picture in pictures) for codec in codecs)
    lines.append(("mean", f"{mean(sizes.values()):.0f}", *(f"{value:.2f}" for value in means)))
    title = f"PSNR (RGB) in dB of the reduced picture, enlarged {ENLARGEMENT} times"
    printer.table(Table(title, ("picture", "bytes", *codecs), lines))
    printer.table(means_table(rows, "ssim"))
    printer.paragraph(
        f"Reduced by means of {ENLARGEMENT} x {ENLARGEMENT} pixels; the mesh is encoded at "
        f"quality {HIGH_QUALITY}, the filters have the reduced pixels themselves."
    )


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


def report_speed(printer: Printer, photograph: Photograph, effort: int, largest: float) -> None:
    """Print seconds and peak memory against effort and size."""
    printer.heading("Speed and memory")
    header = ("effort", "bytes", "encode, s", "decode, ms", "PSNR (RGB), dB", "peak, MB")
    lines = [(str(own), *speed_cells(photograph.pixels, own)) for own in sorted({*EFFORTS, effort})]
    height, width = photograph.pixels.shape[:2]
    title = f"{photograph.name}, {width} x {height} pixels, at {SPEED_RATE:.2f} bpp"
    printer.table(Table(title, header, lines))
    lines = [
        (f"{size:g}", *speed_cells(tiled(photograph.pixels, size), effort))
        for size in MEGAPIXELS
        if size <= largest
    ]
    title = f"{photograph.name} cropped or repeated, at {SPEED_RATE:.2f} bpp, effort {effort}"
    printer.table(Table(title, ("Mpixel", *header[1:]), lines))
    printer.paragraph(
        "One run each, in a process of its own, after a small picture that has everything "
        "compiled. The peak is the most resident memory of the process, Python, its libraries and "
        "the picture itself included. Larger pictures repeat the photograph, mirrored."
    )


def speed_cells(pixels: UInt8Array, effort: int) -> tuple[str, ...]:
    """Figures of an encoding in a process of its own."""
    n_pixels = pixels.shape[0] * pixels.shape[1]
    n_bytes = int(SPEED_RATE * n_pixels / 8)
    click.echo(f"speed: {n_pixels / 1e6:.1f} Mpixel, effort {effort}", err=True)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "pixels.npy"
        np.save(path, pixels)
        command = (sys.executable, "-c", ENCODE_CHILD, str(path), str(n_bytes), str(effort))
        printed, peak = measure_process(*command)
    size, encode_seconds, decode_seconds, error = json.loads(printed)
    return (
        str(size),
        f"{encode_seconds:.2f}",
        f"{1e3 * decode_seconds:.0f}",
        f"{10 * math.log10(255**2 / error):.2f}" if error else "equal",
        f"{peak / 1e6:.0f}",
    )


def tiled(pixels: UInt8Array, megapixels: float) -> UInt8Array:
    """A picture of a size and the same proportions: cropped, or repeated in mirrored tiles."""
    height, width = pixels.shape[:2]
    scale = math.sqrt(megapixels * 1e6 / (height * width))
    rows, columns = round(scale * height), round(scale * width)
    padding = ((0, max(0, rows - height)), (0, max(0, columns - width)), (0, 0))
    larger: UInt8Array = np.pad(pixels, padding, mode="symmetric")
    return np.ascontiguousarray(larger[:rows, :columns])


if __name__ == "__main__":
    main()
