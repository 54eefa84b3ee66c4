"""Speed of drawing meshes as rasters, beside cairo and Skia."""

from __future__ import annotations

from typing import Final

import vmesh
from benchmarks.measurement import Timing, judge_speed, time_actions
from benchmarks.photographs import Photograph
from benchmarks.software import import_optional, version_of
from benchmarks.speed.drawing import (
    KERNEL,
    RENDER,
    Size,
    Step,
    cairo_steps,
    skia_steps,
    vmesh_steps,
)
from benchmarks.tables import Printer, Table
from vmesh.arrays import UInt8Array
from vmesh.formats.pdf.cairo_patterns import import_cairo
from vmesh.formats.picture.conversion import resize
from vmesh.mesh import Mesh
from vmesh.metrics import psnr

TARGET_SPEED: Final = 250.0  # Mpixel/s, for 20,000 vertices at 3840 x 2160
MORE_VERTICES: Final = 10  # times those of the first mesh, in a photograph that is enlarged
ENLARGEMENT: Final = 4
PIXELS_PER_VERTEX: Final = 8  # with fewer a mesh is no picture of the photograph any more


def report_rasters(
    printer: Printer, photograph: Photograph, mesh: Mesh, size: Size, runs: int
) -> None:
    """Print how fast meshes are drawn at a size, beside cairo and Skia."""
    printer.heading("Raster")
    timings = report_drawing(printer, photograph.name, mesh, size, runs)
    printer.paragraph(describe_speed(timings, size))
    height, width = photograph.pixels.shape[:2]
    enlarged_size = (ENLARGEMENT * width, ENLARGEMENT * height)
    many = MORE_VERTICES * mesh.n_vertices
    if enlarged_size[0] * enlarged_size[1] < many * PIXELS_PER_VERTEX:
        printer.paragraph(
            f"{photograph.name} is too small for a mesh of {many} vertices, even enlarged "
            f"{ENLARGEMENT} times."
        )
        return
    enlarged = resize(photograph.pixels, enlarged_size)
    large = vmesh.encode(enlarged, vertices=many, effort=1)
    name = f"{photograph.name} enlarged {ENLARGEMENT} times"
    report_drawing(printer, name, large, size, runs)


def report_drawing(
    printer: Printer, name: str, mesh: Mesh, size: Size, runs: int
) -> dict[str, Timing]:
    """Print how long each program takes to draw a mesh, and how near it comes to our raster."""
    steps = [*vmesh_steps(mesh, size), *cairo_steps(mesh, size)]
    skia = import_optional("skia")
    if skia is not None:
        steps += skia_steps(skia, mesh, size)
    timings = time_actions({step.name: step.run for step in steps}, runs)
    width, height = size
    raster = vmesh.render(mesh, width=width, height=height)
    rows = [
        (step.name, *drawing_cells(step, timings[step.name], timings[RENDER], raster))
        for step in steps
    ]
    if skia is None:
        rows.append(("skia-python", "not installed", *("-",) * 5))
    title = f"{mesh.n_vertices} vertices of {name}, drawn at {width} x {height}, in ms"
    header = ("step", "median", "min", "max", "times ours", "Mpixel/s", "PSNR against ours, dB")
    printer.table(Table(title, header, rows))
    cairo = import_cairo().cairo_version_string()
    printer.paragraph(
        f"Runs of each: {runs}, in turns, one thread; ratios and Mpixel/s are of medians; "
        f"cairo {cairo}, skia-python {version_of('skia-python')}."
    )
    return timings


def drawing_cells(step: Step, timing: Timing, ours: Timing, raster: UInt8Array) -> tuple[str, ...]:
    """Figures of a step's row, beside the time of our whole call and its raster."""
    ratio = f"{timing.median / ours.median:.2f}"
    if step.pixels is None:
        return (*timing.cells(), ratio, "-", "-")
    likeness = psnr(step.pixels(), raster)
    shown = "equal" if likeness == float("inf") else f"{likeness:.1f}"
    return (
        *timing.cells(),
        ratio,
        f"{raster.shape[0] * raster.shape[1] / 1e6 / timing.median:.0f}",
        shown,
    )


def describe_speed(timings: dict[str, Timing], size: Size) -> str:
    """Sentences about the speed of our raster against its target."""
    megapixels = size[0] * size[1] / 1e6
    sentences = []
    for name in (RENDER, KERNEL):
        usual, fastest = (megapixels / t for t in (timings[name].median, timings[name].shortest))
        sentences.append(
            f"{name} reaches {usual:.0f} Mpixel/s by the median and {fastest:.0f} in its fastest "
            f"run; by the median the target of {TARGET_SPEED:.0f} is "
            f"{judge_speed(usual, TARGET_SPEED)}."
        )
    return " ".join(sentences)
