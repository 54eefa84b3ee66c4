"""Vector output: bytes, seconds, and how close programs that others wrote draw it to our raster.

python tools/bench_vector.py --images DIR [--part modes|peers] [--vertices N]
                             [--renderer NAME] [--markdown]
"""

from __future__ import annotations

import gzip
import io
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from importlib import import_module
from itertools import product
from pathlib import Path
from typing import Any, Final

import click

import vmesh
from benchmarks.measurement import (
    Photograph,
    Printer,
    Table,
    describe_machine,
    images_option,
    load_photographs,
    markdown_option,
    version_of,
)
from benchmarks.tracers import Tracing, tracings_of
from vmesh.formats.raster.picture import flatten
from vmesh.formats.svg.document import write_svg
from vmesh.mesh import Mesh
from vmesh.metrics import psnr

N_PHOTOGRAPHS: Final = 3
VERTICES: Final = (1_000, 5_000, 20_000)
METHODS: Final = ("adaptive", "blue-noise")
SCALES: Final = (1, 4)
_ROOT: Final = Path(__file__).resolve().parent.parent


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
    Mode("SVG underlay", ".svg", {"seams": "underlay"}),
    Mode("PDF exact", ".pdf"),
    Mode("PDF cairo", ".pdf", {"backend": "cairo"}),
)
PEER_RENDERER: Final = "resvg"
PEER_MODES: Final[dict[str, Callable[[Photograph], dict[str, Any]]]] = {
    "gradient": lambda _: {},
    "merged": lambda _: {"merge": 50.0},
    "fitted": lambda photograph: {"fit": photograph.pixels},
    "fitted, merged": lambda photograph: {"fit": photograph.pixels, "merge": 50.0},
}


@click.command()
@images_option
@markdown_option
@click.option("--vertices", multiple=True, type=click.IntRange(4), default=VERTICES)
@click.option("--renderer", "wanted", multiple=True, help="All that are installed unless given.")
@click.option(
    "--part",
    "parts",
    type=click.Choice(["modes", "peers"]),
    multiple=True,
    help="Only this part; may be given more than once.",
)
def main(
    folder: Path,
    markdown: bool,
    vertices: tuple[int, ...],
    wanted: tuple[str, ...],
    parts: tuple[str, ...],
) -> None:
    """Measure vector output on the first three photographs of a folder."""
    printer = Printer(markdown)
    photographs = load_photographs(folder)[:N_PHOTOGRAPHS]
    renderers = installed_renderers(wanted)
    if not parts or "modes" in parts:
        report_modes(printer, photographs, vertices, renderers)
    if not parts or "peers" in parts:
        report_peers(printer, photographs, vertices)
    printer.paragraph(describe_machine())


def renderers_of_the_tests() -> Any:
    """The module of the tests that draws files with other programs."""
    if str(_ROOT) not in sys.path:
        sys.path.append(str(_ROOT))
    return import_module("tests.formats.renderers")


def installed_renderers(wanted: tuple[str, ...]) -> dict[str, dict[str, Any]]:
    """What draws files, by the ending of their names and by the renderer's name."""
    known = renderers_of_the_tests()
    tables = {".pdf": known.PDF_RENDERERS, ".svg": known.SVG_RENDERERS}
    return {
        suffix: {name: draw for name, draw in table.items() if not wanted or name in wanted}
        for suffix, table in tables.items()
    }


def report_modes(
    printer: Printer,
    photographs: Sequence[Photograph],
    vertices: Sequence[int],
    renderers: Mapping[str, Mapping[str, Any]],
) -> None:
    """Print how programs draw every mode of every mesh."""
    printer.heading("Vector output")
    for photograph, n, method in product(photographs, vertices, METHODS):
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
    method: str,
    renderers: Mapping[str, Mapping[str, Any]],
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
    mesh: Mesh, path: Path, renderers: Mapping[str, Any]
) -> Iterator[tuple[str, tuple[str, ...]]]:
    """Names of renderers, and how close and how fast they draw a file."""
    skipped = import_module("_pytest.outcomes").Skipped
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
        except skipped:
            yield name, ("missing",) * len(SCALES) + ("-",)
            continue
        yield name, (*cells, f"{seconds:.2f}")


def report_peers(
    printer: Printer, photographs: Sequence[Photograph], vertices: Sequence[int]
) -> None:
    """Print what SVG of photographs shows by its bytes, ours beside that of vtracer."""
    printer.heading("Photographs as SVG")
    write_svg(vmesh.encode(photographs[0].pixels[:96, :96], vertices=200), io.BytesIO())  # compiles
    for photograph in photographs:
        report_documents(printer, photograph, vertices)
    printer.paragraph(
        f"dB is the PSNR over RGB against the photograph, drawn by {PEER_RENDERER}; gzipped at "
        f"the best level; s is the time from pixels to SVG. vtracer {version_of('vtracer')}."
    )


def report_documents(printer: Printer, photograph: Photograph, vertices: Sequence[int]) -> None:
    """Print the documents of one photograph by their compressed size."""
    documents = [*meshes_as_svg(photograph, vertices), *tracings_of(photograph)]
    draw = renderers_of_the_tests().SVG_RENDERERS[PEER_RENDERER]
    rows = []
    for document in documents:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "picture.svg")
            path.write_bytes(document.svg)
            shown = psnr(draw(path, 1), photograph.pixels)
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


if __name__ == "__main__":
    main()
