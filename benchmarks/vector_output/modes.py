"""Modes of vector output: bytes, seconds, and how close others draw them to our raster."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product
from pathlib import Path
from typing import Any, Final

import click

import vmesh
from benchmarks.photographs import Photograph
from benchmarks.tables import Printer, Table
from benchmarks.vector_output.renderers import MISSING, Renderers
from tests.formats.renderers import Renderer
from vmesh.encoder.settings import Method
from vmesh.formats.picture.conversion import flatten
from vmesh.mesh import Mesh
from vmesh.metrics import psnr

SCALES: Final = (1, 4)


@dataclass(frozen=True, slots=True)
class Mode:
    """A way to write a mesh: the ending of the file's name, and the options of `export`."""

    name: str
    suffix: str
    options: Mapping[str, Any] = field(default_factory=dict)


MODES: Final = (
    Mode("SVG gradient", ".svg"),
    Mode("SVG merged", ".svg", {"merge": 50.0}),
    Mode("SVG exact", ".svg", {"mode": "exact"}),
    Mode("SVG auto", ".svg", {"mode": "auto"}),
    Mode("SVG flat", ".svg", {"mode": "flat"}),
    Mode("SVG trapping", ".svg", {"seams": "trapping"}),
    Mode("PDF exact", ".pdf"),
    Mode("PDF cairo", ".pdf", {"backend": "cairo"}),
)


def report_modes(
    printer: Printer,
    photographs: Sequence[Photograph],
    methods: Sequence[Method],
    vertices: Sequence[int],
    renderers: Renderers,
) -> None:
    """Print how programs draw every mode of every mesh."""
    printer.heading("Modes and renderers")
    for photograph, n, method in product(photographs, vertices, methods):
        click.echo(f"modes of {photograph.name}, {method}, {n} vertices", err=True)
        report_mesh(printer, photograph, n, method, renderers)
    printer.paragraph(
        "dB is the PSNR over RGB against our own raster at "
        f"{' and '.join(f'{scale}x' for scale in SCALES)}; s is the time of the latter drawing, "
        "with the start of the program where it is one. Single runs."
    )


def report_mesh(
    printer: Printer,
    photograph: Photograph,
    n: int,
    method: Method,
    renderers: Renderers,
) -> None:
    """Print the table of one mesh: a row for each mode and renderer."""
    mesh = vmesh.encode(photograph.pixels, method=method, vertices=n)
    size = len(vmesh.dumps(mesh))
    columns = ("mode", "renderer", "bytes", "x .vmesh", "B / triangle", "write s")
    header = (*columns, *(f"{scale}x dB" for scale in SCALES), "draw s")
    title = f"{photograph.name}, {method}, {mesh.n_vertices} vertices, .vmesh of {size} bytes"
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for mode in MODES:
            path = Path(folder, f"picture{mode.suffix}")
            started = time.perf_counter()
            vmesh.export(mesh, path, **mode.options)
            seconds = time.perf_counter() - started
            written = path.stat().st_size
            figures = (str(written), f"{written / size:.2f}", f"{written / mesh.n_triangles:.2f}")
            for name, drawn in drawings(mesh, path, renderers[mode.suffix]):
                rows.append((mode.name, name, *figures, f"{seconds:.2f}", *drawn))
    printer.table(Table(title, header, rows, n_words=2))


def drawings(
    mesh: Mesh, path: Path, renderers: Mapping[str, Renderer]
) -> Iterator[tuple[str, tuple[str, ...]]]:
    """Names of renderers, and how close and how fast they draw a file."""
    for name, draw in renderers.items():
        cells = []
        seconds = 0.0
        try:
            for scale in SCALES:
                started = time.perf_counter()
                drawn = draw(path, scale)
                seconds = time.perf_counter() - started
                ours = flatten(vmesh.render(mesh, scale=scale))
                cells.append(f"{psnr(drawn, ours):.1f}")
        except MISSING:
            yield name, ("missing",) * len(SCALES) + ("-",)
            continue
        yield name, (*cells, f"{seconds:.2f}")
