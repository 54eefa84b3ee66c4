"""Seconds and memory of an encoding to a size, by effort and by the number of pixels."""

from __future__ import annotations

import json
import math
import sys
import tempfile
from pathlib import Path
from typing import Final

import click
import numpy as np

from benchmarks.measurement import measure_process
from benchmarks.photographs import Photograph
from benchmarks.tables import Printer, Table
from vmesh.arrays import UInt8Array

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
