"""Bits of each vertex in files of sampled points, beside the paper's count."""

from __future__ import annotations

from itertools import product
from statistics import mean
from typing import Final

import vmesh
from benchmarks.paper.comparison import DENSITIES
from benchmarks.photographs import Photograph, n_pictures
from benchmarks.tables import Printer, Table
from vmesh.arrays import UInt8Array
from vmesh.codec.reader import measure

PAPER_BITS: Final = 56  # a vertex: the paper's Table 1 counts seven bytes


def report_bits(printer: Printer, photographs: list[Photograph], each: bool) -> None:
    """Print the bits per vertex of real files."""
    figures = [
        [bits for density in DENSITIES for bits in count_bits(photograph.pixels, density)]
        for photograph in photographs
    ]
    means = [mean(column) for column in zip(*figures, strict=True)]
    rows = [
        (photograph.name, *(f"{bits:.2f}" for bits in own))
        for photograph, own in zip(photographs, figures, strict=True)
        if each
    ]
    rows.append(("mean", *(f"{bits:.2f}" for bits in means)))
    rows.append(("paper", *(("-", "-", str(PAPER_BITS)) * len(DENSITIES))))
    parts = ("positions", "colors", "file")
    header = (f"{part}, {density:.0%}" for density, part in product(DENSITIES, parts))
    printer.heading("Bits per vertex")
    title = f"Files of the method blue-noise, {n_pictures(len(photographs))}"
    printer.table(Table(title, ("picture", *header), rows))
    ratios = ", ".join(f"{PAPER_BITS / bits:.2f}" for bits in means[2::3])
    printer.paragraph(
        f"The paper's {PAPER_BITS} bits are {ratios} times the mean of these files. Triangles are "
        "implied by the vertices and cost nothing; the file holds its header and checksums too."
    )


def count_bits(pixels: UInt8Array, density: float) -> tuple[float, float, float]:
    """Bits per vertex of the positions, the colors and the whole file."""
    mesh = vmesh.encode(pixels, method="blue-noise", density=density)
    data = vmesh.dumps(mesh)
    _, sizes = measure(data)
    parts = (sizes["positions"], sizes["colors"], len(data))
    positions, colors, whole = (8 * part / mesh.n_vertices for part in parts)
    return positions, colors, whole
