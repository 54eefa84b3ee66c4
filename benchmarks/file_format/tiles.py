"""Bytes and quality of meshes that are made of tiles, beside whole ones."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import click

import vmesh
from benchmarks.photographs import Photograph
from benchmarks.tables import Printer, Table
from vmesh.metrics import psnr

TILED_DENSITIES: Final = (0.01, 0.03)  # vertices for each pixel


def report_tiles(
    printer: Printer, photographs: Sequence[Photograph], side: int, effort: int
) -> None:
    """Print bytes and PSNR of the same numbers of vertices, whole and in tiles."""
    rows = []
    for photograph in photographs:
        click.echo(f"tiles of {photograph.name}", err=True)
        for density in TILED_DENSITIES:
            whole, whole_psnr = measure_tiles(photograph, density, None, effort)
            tiled, tiled_psnr = measure_tiles(photograph, density, side, effort)
            sizes = (str(whole), str(tiled), f"{tiled / whole - 1:+.1%}")
            qualities = (f"{whole_psnr:.2f}", f"{tiled_psnr:.2f}")
            rows.append((photograph.name, f"{density:.0%}", *sizes, *qualities))
    header = ("picture", "vertices per pixel", "bytes, whole", "bytes, in tiles", "more")
    title = f"Whole meshes and meshes in tiles of {side} x {side} pixels"
    printer.heading("Tiles")
    printer.table(Table(title, (*header, "dB, whole", "dB, in tiles"), rows))
    printer.paragraph(
        "Vertices on the lines between tiles are stored with each of them, and contexts begin anew "
        "in each; dB is the PSNR over RGB."
    )


def measure_tiles(
    photograph: Photograph, density: float, side: int | None, effort: int
) -> tuple[int, float]:
    """Bytes and PSNR of a mesh in tiles of a side, or of a whole one."""
    mesh = vmesh.encode(photograph.pixels, density=density, tile=side, effort=effort)
    return len(vmesh.dumps(mesh)), psnr(photograph.pixels, vmesh.render(mesh))
