"""Enlarging of a reduced picture: as a mesh, and with Pillow's filters."""

from __future__ import annotations

import time
from statistics import mean
from typing import Final

import click
import numpy as np
from PIL import Image

import vmesh
from benchmarks.photographs import Photograph
from benchmarks.raster.search import Coded
from benchmarks.rate_distortion.coding import warm_up
from benchmarks.rate_distortion.comparison import means_table
from benchmarks.rate_distortion.figures import VMESH, Row, codecs_of, pictures_of, row_of
from benchmarks.tables import Printer, Table

ENLARGEMENT: Final = 2
HIGH_QUALITY: Final = 95
FILTERS: Final = {
    "bilinear": Image.Resampling.BILINEAR,
    "bicubic": Image.Resampling.BICUBIC,
    "Lanczos": Image.Resampling.LANCZOS,
}


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
