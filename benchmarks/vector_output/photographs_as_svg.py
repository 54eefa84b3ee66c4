"""Photographs as SVG by their bytes: meshes beside tracings."""

from __future__ import annotations

import gzip
import io
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, Final

import click

import vmesh
from benchmarks.photographs import Photograph
from benchmarks.software import version_of
from benchmarks.tables import Printer, Table
from benchmarks.vector_output.tracers import Tracing, tracings_of
from tests.formats.renderers import draw_with_resvg
from vmesh.formats.svg.document import write_svg
from vmesh.metrics import psnr

PEER_MODES: Final[dict[str, Callable[[Photograph], dict[str, Any]]]] = {
    "gradient": lambda _: {},
    "merged": lambda _: {"merge": 50.0},
    "fitted": lambda photograph: {"fit": photograph.pixels},
    "fitted, merged": lambda photograph: {"fit": photograph.pixels, "merge": 50.0},
}


def report_peers(
    printer: Printer, photographs: Sequence[Photograph], vertices: Sequence[int]
) -> None:
    """Print what SVG of photographs shows by its bytes, ours beside that of vtracer."""
    printer.heading("Photographs as SVG")
    write_svg(vmesh.encode(photographs[0].pixels[:96, :96], vertices=200), io.BytesIO())  # compiles
    for photograph in photographs:
        click.echo(f"SVG of {photograph.name}", err=True)
        report_documents(printer, photograph, vertices)
    printer.paragraph(
        f"dB is the PSNR over RGB against the photograph, drawn by resvg; gzipped at "
        f"the best level; s is the time from pixels to SVG. vtracer {version_of('vtracer')}."
    )


def report_documents(printer: Printer, photograph: Photograph, vertices: Sequence[int]) -> None:
    """Print the documents of one photograph by their compressed size."""
    documents = [*meshes_as_svg(photograph, vertices), *tracings_of(photograph)]
    rows = []
    for document in documents:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "picture.svg")
            path.write_bytes(document.svg)
            shown = psnr(draw_with_resvg(path, 1), photograph.pixels)
        packed = len(gzip.compress(document.svg, 9))
        rows.append(
            (
                packed,
                (
                    document.settings,
                    str(len(document.svg)),
                    str(packed),
                    f"{shown:.2f}",
                    f"{document.seconds:.1f}",
                ),
            )
        )
    header = ("by", "bytes", "gzipped", "dB", "s")
    printer.table(Table(photograph.name, header, [row for _, row in sorted(rows)]))


def meshes_as_svg(photograph: Photograph, vertices: Sequence[int]) -> Iterator[Tracing]:
    """SVG of adaptive meshes of a photograph, by numbers of vertices and ways of writing."""
    for n in vertices:
        started = time.perf_counter()
        mesh = vmesh.encode(photograph.pixels, vertices=n)
        encoded = time.perf_counter() - started
        for name, options in PEER_MODES.items():
            stream = io.BytesIO()
            started = time.perf_counter()
            write_svg(mesh, stream, **options(photograph))
            seconds = encoded + time.perf_counter() - started
            yield Tracing(f"vmesh, {n} vertices, {name}", stream.getvalue(), seconds)
