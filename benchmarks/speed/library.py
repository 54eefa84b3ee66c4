"""Milliseconds that the library takes for a photograph, end to end."""

from __future__ import annotations

import io
from collections.abc import Callable
from typing import Any, BinaryIO

import vmesh
from benchmarks.measurement import time_actions
from benchmarks.photographs import Photograph
from benchmarks.tables import Printer, Table
from vmesh.formats.pdf.document import write_pdf
from vmesh.formats.svg.document import write_svg
from vmesh.mesh import Mesh


def report_library(printer: Printer, photograph: Photograph, mesh: Mesh, runs: int) -> None:
    """Print how long the library takes for each thing that it does with a photograph."""
    data = vmesh.dumps(mesh)
    actions: dict[str, Callable[[], object]] = {
        "encode, effort 1": lambda: encode(photograph, mesh, effort=1),
        "encode, effort 5": lambda: encode(photograph, mesh, effort=5),
        "encode, blue-noise": lambda: encode(photograph, mesh, method="blue-noise"),
        "dumps": lambda: vmesh.dumps(mesh),
        "loads": lambda: vmesh.loads(data),
        "render": lambda: vmesh.render(mesh),
        "to SVG, gradient": lambda: written(lambda stream: write_svg(mesh, stream)),
        "to SVG, flat": lambda: written(lambda stream: write_svg(mesh, stream, mode="flat")),
        "to PDF": lambda: written(lambda stream: write_pdf(mesh, stream)),
        "to PDF, cairo": lambda: written(lambda stream: write_pdf(mesh, stream, backend="cairo")),
    }
    timings = time_actions(actions, runs)
    sizes = {"dumps": len(data)}
    for name, action in actions.items():
        if name.startswith("to "):
            result = action()
            assert isinstance(result, bytes)
            sizes[name] = len(result)
    rows = [
        (name, *timing.cells(), f"{sizes[name] / 1000:.0f}" if name in sizes else "-")
        for name, timing in timings.items()
    ]
    size = f"{mesh.width} x {mesh.height} pixels"
    printer.heading("A photograph, end to end")
    printer.table(
        Table(
            f"{photograph.name}, {size}, {mesh.n_vertices} vertices, in ms",
            ("step", "median", "min", "max", "kB written"),
            rows,
        )
    )
    printer.paragraph(f"Warm, in turns, written to memory; runs of each: {runs}.")


def encode(photograph: Photograph, like: Mesh, **settings: Any) -> Mesh:
    """A mesh of a photograph with as many vertices as another."""
    return vmesh.encode(photograph.pixels, vertices=like.n_vertices, **settings)


def written(write: Callable[[BinaryIO], object]) -> bytes:
    """Bytes that a writer writes."""
    stream = io.BytesIO()
    write(stream)
    return stream.getvalue()
