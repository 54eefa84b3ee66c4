"""Thumbnails of a few hundred bytes by every codec."""

from __future__ import annotations

from typing import Final

import click
import numpy as np
from PIL import Image

from benchmarks.photographs import Photograph
from benchmarks.rate_distortion.coding import measure_points
from benchmarks.rate_distortion.comparison import means_table, pictures_table
from benchmarks.rate_distortion.figures import Row, points_of
from benchmarks.tables import Printer

THUMBNAIL_SIDE: Final = 192
THUMBNAIL_BYTES: Final = (200, 400, 800)


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


def report_thumbnails(printer: Printer, rows: list[Row]) -> None:
    """Print the quality of thumbnails."""
    printer.heading("Thumbnails")
    for metric in ("psnr_rgb", "psnr_y", "ssim"):
        printer.table(means_table(rows, metric))
    for point in points_of(rows):
        printer.table(pictures_table([row for row in rows if row.point == point], point))
