"""The coding of the encoder's paper, and the bytes that vmesh takes for the same PSNR."""

from __future__ import annotations

import time
from statistics import mean
from typing import Final

import vmesh
from benchmarks.photographs import Photograph
from benchmarks.raster.search import Coded
from benchmarks.rate_distortion.coding import code_with_vmesh
from benchmarks.rate_distortion.figures import VMESH, Row, row_of
from benchmarks.tables import Printer, Table

PAPER: Final = "paper"
PAPER_BYTES: Final = 7  # a vertex: the paper's Table 1
PAPER_GOAL: Final = 12  # times fewer bytes than the paper's coding


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
