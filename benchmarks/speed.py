"""Measure the decoders and the command line: rasters, stages, cold starts, memory."""

from __future__ import annotations

import io
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any, BinaryIO, Final

import click
import numpy as np
from PIL import Image

import vmesh
from benchmarks.measurement import (
    Photograph,
    Printer,
    Table,
    Timing,
    describe_machine,
    images_option,
    judge,
    load_photographs,
    markdown_option,
    measure_process,
    time_actions,
    version_of,
)
from vmesh.arrays import Float64Array, UInt8Array
from vmesh.formats.pdf.cairo_patterns import MeshPattern, import_cairo
from vmesh.formats.pdf.document import write_pdf
from vmesh.formats.raster.picture import resize
from vmesh.formats.raster.rendering import with_alpha
from vmesh.formats.svg.document import write_svg
from vmesh.kernels.scanline import SUBPIXEL, fill
from vmesh.mesh import Mesh
from vmesh.metrics import psnr

WIDTH: Final = 3840
HEIGHT: Final = 2160
MEGAPIXELS: Final = WIDTH * HEIGHT / 1e6
VERTICES: Final = 20_000
MANY_VERTICES: Final = 200_000
ENLARGEMENT: Final = 4
PIXELS_PER_VERTEX: Final = 8  # with fewer a mesh is no picture of the photograph any more
DRAW_RUNS: Final = 11
MANY_RUNS: Final = 5
STAGE_RUNS: Final = 7
START_RUNS: Final = 7
SMALL_SIDE: Final = 128
LARGE_SIZE: Final = (4000, 3000)

TARGET_SPEED: Final = 250.0  # Mpixel/s, for the mesh of VERTICES
TARGET_START: Final = 300.0  # ms
RENDER: Final = "`vmesh.render`, whole call"
KERNEL: Final = "`scanline.fill` alone"
HELP: Final = "`vmesh --help`"
INFO: Final = "`vmesh info`"

VMESH: Final = (sys.executable, "-m", "vmesh")


@dataclass(frozen=True, slots=True)
class Step:
    """A step of drawing a mesh; one that draws can say what is on its raster."""

    name: str
    run: Callable[[], object]
    pixels: Callable[[], UInt8Array] | None = None


@click.command()
@images_option
@markdown_option
def main(folder: Path, markdown: bool) -> None:
    """Measure decoders and the command line on the first photograph of a folder."""
    photograph = load_photographs(folder)[0]
    printer = Printer(markdown)
    mesh = vmesh.encode(photograph.pixels, method="blue-noise", vertices=VERTICES)
    report_raster(printer, photograph, mesh)
    report_stages(printer, photograph, mesh)
    with tempfile.TemporaryDirectory() as name:
        bench = CommandLine(Path(name), photograph.pixels)
        report_starts(printer, bench)
        report_memory(printer, bench)
    printer.paragraph(describe_machine())


def report_raster(printer: Printer, photograph: Photograph, mesh: Mesh) -> None:
    """Print how fast meshes are drawn at 4K, beside cairo and Skia."""
    printer.heading("Raster")
    timings = report_drawing(printer, photograph.name, mesh, DRAW_RUNS)
    printer.paragraph(describe_speed(timings))
    height, width = photograph.pixels.shape[:2]
    size = (ENLARGEMENT * width, ENLARGEMENT * height)
    if size[0] * size[1] < MANY_VERTICES * PIXELS_PER_VERTEX:
        printer.paragraph(
            f"{photograph.name} is too small for a mesh of {MANY_VERTICES} vertices, even enlarged "
            f"{ENLARGEMENT} times."
        )
        return
    enlarged = resize(photograph.pixels, size)
    large = vmesh.encode(enlarged, method="blue-noise", vertices=MANY_VERTICES)
    name = f"{photograph.name} enlarged {ENLARGEMENT} times"
    report_drawing(printer, name, large, MANY_RUNS)


def report_drawing(printer: Printer, name: str, mesh: Mesh, runs: int) -> dict[str, Timing]:
    """Print how long each program takes to draw a mesh, and how near it comes to our raster."""
    steps = [*vmesh_steps(mesh), *cairo_steps(mesh)]
    skia = import_skia()
    if skia is not None:
        steps += skia_steps(skia, mesh)
    timings = time_actions({step.name: step.run for step in steps}, runs)
    raster = vmesh.render(mesh, width=WIDTH, height=HEIGHT)
    rows = [
        (step.name, *drawing_cells(step, timings[step.name], timings[RENDER], raster))
        for step in steps
    ]
    if skia is None:
        rows.append(("skia-python", "not installed", *("-",) * 5))
    title = f"{mesh.n_vertices} vertices of {name}, drawn at {WIDTH} x {HEIGHT}, in ms"
    header = ("step", "median", "min", "max", "times ours", "Mpixel/s", "PSNR against ours, dB")
    printer.table(Table(title, header, rows))
    cairo = import_cairo().cairo_version_string()
    printer.paragraph(
        f"{runs} runs of each in turns, one thread; ratios and Mpixel/s are of medians; "
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
    return (*timing.cells(), ratio, f"{MEGAPIXELS / timing.median:.0f}", shown)


def describe_speed(timings: dict[str, Timing]) -> str:
    """In words: the speed of our raster against its target."""
    sentences = [
        f"{name} reaches {MEGAPIXELS / timings[name].median:.0f} Mpixel/s by the median and "
        f"{MEGAPIXELS / timings[name].shortest:.0f} in its fastest run; the target of "
        f"{TARGET_SPEED:.0f} is {judge_speed(MEGAPIXELS / timings[name].median)} by the median."
        for name in (RENDER, KERNEL)
    ]
    return " ".join(sentences)


def judge_speed(found: float) -> str:
    """Whether a speed in Mpixel/s reaches the target, and by how much it does not."""
    return "met" if found >= TARGET_SPEED else f"missed by {1 - found / TARGET_SPEED:.0%}"


def scaled_points(mesh: Mesh) -> Float64Array:
    """Vertices in pixels of the raster, shape (n, 2)."""
    points: Float64Array = mesh.points * (WIDTH / mesh.width, HEIGHT / mesh.height)
    return points


def vmesh_steps(mesh: Mesh) -> list[Step]:
    """Our own raster: the whole call, and its inner loop with everything prepared."""
    positions = np.floor(scaled_points(mesh) * SUBPIXEL + 0.5).astype(np.int64)
    triangles, colors = mesh.triangles, mesh.colors
    raster = np.zeros((HEIGHT, WIDTH, 3), dtype=np.uint8)

    def whole() -> UInt8Array:
        return vmesh.render(mesh, width=WIDTH, height=HEIGHT)

    return [
        Step(RENDER, whole, whole),
        Step(KERNEL, lambda: fill(positions, triangles, colors, raster), lambda: raster),
    ]


def cairo_steps(mesh: Mesh) -> list[Step]:
    """A cairo mesh pattern: built, and painted on an image surface."""
    cairocffi = import_cairo()
    corners = scaled_points(mesh)[mesh.triangles]
    colors = (with_alpha(mesh.colors) / 255.0)[mesh.triangles]
    surface = cairocffi.ImageSurface(cairocffi.FORMAT_RGB24, WIDTH, HEIGHT)
    context = cairocffi.Context(surface)

    def build() -> MeshPattern:
        pattern = MeshPattern()
        pattern.add_triangles(corners, colors)
        return pattern

    def pixels() -> UInt8Array:
        surface.flush()
        data = np.frombuffer(surface.get_data(), dtype=np.uint8)
        return data.reshape(HEIGHT, WIDTH, 4)[:, :, channels_of_native_rgb()]

    pattern = build()
    return [
        Step("cairo mesh pattern, build", build),
        Step("cairo mesh pattern, paint", lambda: pattern.paint(context), pixels),
    ]


def channels_of_native_rgb() -> list[int]:
    """Bytes of red, green and blue in cairo's 32-bit words, which are of the machine's order."""
    return [2, 1, 0] if sys.byteorder == "little" else [1, 2, 3]


def import_skia() -> ModuleType | None:
    """The module skia, None if it is not installed."""
    try:
        import skia
    except ImportError:
        return None
    module: ModuleType = skia
    return module


def skia_steps(skia: Any, mesh: Mesh) -> list[Step]:
    """Skia's drawVertices: the vertices built, and drawn on a raster surface."""
    points, colors = scaled_points(mesh), mesh.colors.astype(np.int64)
    words = (255 << 24) | (colors[:, 0] << 16) | (colors[:, 1] << 8) | colors[:, 2]
    indices: list[int] | None = mesh.triangles.ravel().tolist()
    if mesh.n_vertices > 1 << 16:  # Skia's indices have 16 bits: every triangle has its own corners
        points, words = points[mesh.triangles].reshape(-1, 2), words[mesh.triangles].ravel()
        indices = None
    buffer = np.zeros((HEIGHT, WIDTH, 4), dtype=np.uint8)
    canvas = skia.Surface(buffer).getCanvas()
    paint = skia.Paint(AntiAlias=False)

    def build() -> object:
        corners = [skia.Point(x, y) for x, y in points.tolist()]
        mode = skia.Vertices.kTriangles_VertexMode
        return skia.Vertices(mode, corners, colors=words.tolist(), indices=indices)

    def draw() -> None:
        canvas.drawVertices(vertices, paint, skia.BlendMode.kDst)  # the vertices' colours alone

    vertices = build()
    return [
        Step("skia-python vertices, build", build),
        Step("skia-python drawVertices", draw, lambda: buffer[:, :, :3]),
    ]


def report_stages(printer: Printer, photograph: Photograph, mesh: Mesh) -> None:
    """Print how long the library takes for each thing that it does with a photograph."""
    data = vmesh.dumps(mesh)
    actions: dict[str, Callable[[], object]] = {
        "encode, blue-noise": lambda: vmesh.encode(
            photograph.pixels, method="blue-noise", vertices=VERTICES
        ),
        "encode, adaptive": lambda: vmesh.encode(photograph.pixels, vertices=VERTICES),
        "dumps": lambda: vmesh.dumps(mesh),
        "loads": lambda: vmesh.loads(data),
        "render": lambda: vmesh.render(mesh),
        "to SVG, gradient": lambda: written(lambda stream: write_svg(mesh, stream)),
        "to SVG, flat": lambda: written(lambda stream: write_svg(mesh, stream, mode="flat")),
        "to PDF": lambda: written(lambda stream: write_pdf(mesh, stream)),
        "to PDF, cairo": lambda: written(lambda stream: write_pdf(mesh, stream, backend="cairo")),
    }
    timings = time_actions(actions, STAGE_RUNS)
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
    printer.paragraph(f"Warm, one thread, {STAGE_RUNS} runs of each in turns, written to memory.")


def written(write: Callable[[BinaryIO], object]) -> bytes:
    """What a writer writes."""
    stream = io.BytesIO()
    write(stream)
    return stream.getvalue()


class CommandLine:
    """The command ``vmesh`` in processes of its own, with a cache of compiled code of its own."""

    def __init__(self, folder: Path, pixels: UInt8Array) -> None:
        self.small = folder / "small.png"
        self.large = folder / "large.png"
        self.mesh = folder / "photo.vmesh"
        self._environment = os.environ | {"NUMBA_CACHE_DIR": str(folder / "cache")}
        Image.fromarray(pixels[:SMALL_SIDE, :SMALL_SIDE]).save(self.small)
        Image.fromarray(resize(pixels, LARGE_SIZE)).save(self.large, compress_level=1)

    def run(self, *command: str) -> str:
        """What a process prints."""
        return subprocess.run(
            command, check=True, env=self._environment, stdout=subprocess.PIPE, text=True
        ).stdout

    def encode(self, picture: Path) -> str:
        """Encode a picture with the default settings; figures as JSON."""
        return self.run(*VMESH, "encode", str(picture), str(self.mesh), "--json")

    def encode_measured(self, picture: Path) -> tuple[dict[str, Any], int]:
        """Figures of an encoding and the most memory that its process held, in bytes."""
        command = (*VMESH, "encode", str(picture), str(self.mesh), "--json")
        figures, peak = measure_process(*command, environment=self._environment)
        return json.loads(figures), peak


def report_starts(printer: Printer, bench: CommandLine) -> None:
    """Print how long processes take from their start to their end."""
    started = time.perf_counter()
    bench.encode(bench.small)
    first = time.perf_counter() - started
    actions: dict[str, Callable[[], object]] = {
        "an empty Python program": lambda: bench.run(sys.executable, "-c", "pass"),
        "`import vmesh`": lambda: bench.run(sys.executable, "-c", "import vmesh"),
        HELP: lambda: bench.run(*VMESH, "--help"),
        INFO: lambda: bench.run(*VMESH, "info", str(bench.mesh)),
        "`vmesh encode`, later runs": lambda: bench.encode(bench.small),
    }
    timings = time_actions(actions, START_RUNS)
    timings["`vmesh encode`, first run, compiling everything"] = Timing(first, first, first)
    printer.heading("Cold starts")
    header = ("process", "median", "min", "max", "target", "median against target")
    rows = [
        (name, *timing.cells(), *start_target(name, timing)) for name, timing in timings.items()
    ]
    printer.table(Table("Whole processes, in ms", header, rows))
    printer.paragraph(
        f"{START_RUNS} runs of each in turns after one that is not counted; the compiling one is "
        f"a single run with an empty `NUMBA_CACHE_DIR`. Encoded are {SMALL_SIDE} x {SMALL_SIDE} "
        "pixels."
    )


def start_target(name: str, timing: Timing) -> tuple[str, str]:
    """Target and verdict of a process's row."""
    if name not in (HELP, INFO):
        return "-", "-"
    return f"{TARGET_START:.0f}", judge(timing.median * 1e3, TARGET_START)


def report_memory(printer: Printer, bench: CommandLine) -> None:
    """Print the peak memory of encodings."""
    printer.heading("Memory")
    rows = list(memory_rows(bench))
    header = ("picture", "vertices", "seconds", "peak, MB", "bytes per pixel over the first")
    printer.table(Table("`vmesh encode` at default settings", header, rows))
    printer.paragraph(
        "The most resident memory of the process, Python and its libraries included; seconds are "
        "of one run, from reading to writing. The large picture is the photograph enlarged."
    )


def memory_rows(bench: CommandLine) -> Iterator[tuple[str, ...]]:
    """Figures of a picture too small to matter and of a large one."""
    base = 0
    for picture in (bench.small, bench.large):
        figures, peak = bench.encode_measured(picture)
        pixels = figures["width"] * figures["height"]
        yield (
            f"{figures['width']} x {figures['height']}",
            str(figures["vertices"]),
            f"{figures['seconds']:.2f}",
            f"{peak / 1e6:.0f}",
            f"{(peak - base) / pixels:.0f}" if base else "-",
        )
        base = peak


if __name__ == "__main__":
    main()
