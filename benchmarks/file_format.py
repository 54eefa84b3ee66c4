"""Measure the file format: bits per vertex by part, beside other ways of storing the same mesh."""

from __future__ import annotations

import zlib
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from statistics import mean
from typing import Any, Final

import click
import numpy as np
import numpy.typing as npt

import vmesh
from benchmarks.measurement import (
    Photograph,
    Printer,
    Table,
    describe_machine,
    images_option,
    import_optional,
    judge,
    load_photographs,
    markdown_option,
    time_actions,
    version_of,
)
from vmesh.codec.layout import LISTED_TRIANGLES, Header
from vmesh.codec.mesh_coder import encode_mesh
from vmesh.codec.reader import measure
from vmesh.mesh import Mesh

DENSITIES: Final = (0.0075, 0.02, 0.04)  # vertices per pixel
TARGETS: Final = {0.0075: 14.0, 0.02: 12.0}  # bits per vertex of a whole file
TRIANGLES_TARGET: Final = 4.5  # bits per vertex of the triangles alone
SPEED_TARGET: Final = 1e6  # vertices per second of reading
SPEED_DENSITY: Final = 0.02
RUNS: Final = 9

Coder = Callable[[Mesh], bytes]


@dataclass(frozen=True, slots=True)
class Sizes:
    """Bits per vertex of a mesh: of the parts of its file, of a list, and by other coders."""

    density: float
    parts: dict[str, float]
    listed: float
    others: dict[str, float]


@click.command()
@images_option
@markdown_option
@click.option("--effort", type=click.IntRange(1, 9), default=5, show_default=True)
@click.option("--limit", type=click.IntRange(min=1), help="Only so many pictures of the folder.")
def main(folder: Path, markdown: bool, effort: int, limit: int | None) -> None:
    """Measure the format on meshes of a folder of photographs."""
    photographs = load_photographs(folder)[:limit]
    printer = Printer(markdown)
    coders = available_coders()
    found: list[Sizes] = []
    speed_mesh = None
    for photograph in photographs:
        for density in DENSITIES:
            mesh = mesh_of(photograph, density, effort)
            found.append(measure_sizes(mesh, density, coders))
            if speed_mesh is None and density == SPEED_DENSITY:
                speed_mesh = mesh
    report_sizes(printer, found, len(photographs))
    if speed_mesh is not None:
        report_speed(printer, speed_mesh, coders)
    printer.heading("Conditions")
    names = ", ".join(f"{name} {version_of(name)}" for name in ("brotli", "zstandard", "DracoPy"))
    printer.paragraph(f"vmesh at effort {effort}. Optional packages: {names}.")
    printer.paragraph(describe_machine())


def mesh_of(photograph: Photograph, density: float, effort: int) -> Mesh:
    """The mesh that the encoder makes of a photograph."""
    n_pixels = photograph.pixels.shape[0] * photograph.pixels.shape[1]
    return vmesh.encode(photograph.pixels, vertices=round(density * n_pixels), effort=effort)


def measure_sizes(mesh: Mesh, density: float, coders: dict[str, Coder]) -> Sizes:
    """Bits per vertex of everything."""
    data = vmesh.dumps(mesh)
    same, parts = measure(data)
    parts = {"frame": len(data) - sum(parts.values()), **parts}
    header = Header(
        mesh.width,
        mesh.height,
        mesh.subdivision,
        LISTED_TRIANGLES,
        mesh.n_vertices,
        mesh.lattice.steps,
    )
    listed = len(encode_mesh(same, header, None)) - parts["positions"] - parts["colors"]
    per_vertex = 8 / mesh.n_vertices
    return Sizes(
        density,
        {name: size * per_vertex for name, size in parts.items()},
        listed * per_vertex,
        {name: len(code(same)) * per_vertex for name, code in coders.items()},
    )


def report_sizes(printer: Printer, found: list[Sizes], n_pictures: int) -> None:
    """Print the means by part and those of the other coders."""
    printer.heading("Bits per vertex")
    rows = []
    for density in DENSITIES:
        parts = [
            mean_part(found, density, name)
            for name in ("frame", "positions", "colors", "triangles")
        ]
        total = mean_total(found, density)
        verdict = judge(total, TARGETS[density]) if density in TARGETS else ""
        figures = (f"{bits:.2f}" for bits in (*parts, total))
        rows.append((f"{density:.2%}", *figures, verdict))
    header = ("vertices per pixel", "frame", "positions", "colours", "triangles", "file", "target")
    printer.table(Table(f"By part: mean of {n_pictures} pictures", header, rows))
    listed = [mean(s.listed for s in found if s.density == density) for density in DENSITIES]
    flips = [mean_part(found, density, "triangles") for density in DENSITIES]
    rows = [
        ("flips, as the file has them", *(f"{bits:.2f}" for bits in flips)),
        ("a list", *(f"{bits:.2f}" for bits in listed)),
    ]
    names = tuple(f"{density:.2%}" for density in DENSITIES)
    printer.table(Table("Triangles of the same meshes", ("told by", *names), rows))
    verdict = judge(max(flips), TRIANGLES_TARGET)
    printer.paragraph(
        f"Wanted of told triangles, at most {TRIANGLES_TARGET} bits per vertex: {verdict}. "
        "A list is for meshes far from Delaunay."
    )
    rows = [("vmesh", *(f"{mean_total(found, density):.1f}" for density in DENSITIES))]
    for name in found[0].others:
        bits = [mean(s.others[name] for s in found if s.density == d) for d in DENSITIES]
        rows.append((name, *(f"{figure:.1f}" for figure in bits)))
    printer.table(Table("The same meshes, whole files", ("stored as", *names), rows))


def mean_part(found: list[Sizes], density: float, part: str) -> float:
    """Mean bits per vertex of a part."""
    return mean(sizes.parts.get(part, 0.0) for sizes in found if sizes.density == density)


def mean_total(found: list[Sizes], density: float) -> float:
    """Mean bits per vertex of whole files."""
    return mean(sum(sizes.parts.values()) for sizes in found if sizes.density == density)


def report_speed(printer: Printer, mesh: Mesh, coders: dict[str, Coder]) -> None:
    """Print how fast a mesh is written and read, on one core."""
    data = vmesh.dumps(mesh)
    actions: dict[str, Callable[[], object]] = {
        "vmesh, writing": lambda: vmesh.dumps(mesh),
        "vmesh, reading": lambda: vmesh.loads(data),
    }
    if "Draco" in coders:
        draco = import_module("DracoPy")
        coded = code_with_draco(mesh)
        actions["Draco, writing"] = lambda: code_with_draco(mesh)
        actions["Draco, reading"] = lambda: draco.decode(coded)
    times = time_actions(actions, RUNS)
    printer.heading("Speed")
    rows = [
        (name, *timing.cells(), f"{mesh.n_vertices / timing.median / 1e6:.3f}")
        for name, timing in times.items()
    ]
    header = ("", "median ms", "fastest", "slowest", "million vertices/s")
    printer.table(Table(f"A mesh of {mesh.n_vertices} vertices, warm", header, rows))
    seconds = times["vmesh, reading"].median
    verdict = judge(seconds, mesh.n_vertices / SPEED_TARGET)
    printer.paragraph(f"Wanted of reading, a million vertices per second: {verdict} (in seconds).")


# --- Other ways of storing a mesh -----------------------------------------------------------------


def available_coders() -> dict[str, Coder]:
    """The other ways whose packages are there."""
    coders: dict[str, Coder] = {
        "raw arrays": raw,
        "raw, zlib 9": lambda mesh: zlib.compress(raw(mesh), 9),
        "differences, zlib 9": lambda mesh: zlib.compress(differences(mesh), 9),
    }
    if (brotli := import_optional("brotli")) is not None:
        coders["raw, brotli 11"] = lambda mesh: brotli.compress(raw(mesh))
        coders["differences, brotli 11"] = lambda mesh: brotli.compress(differences(mesh))
    if (zstandard := import_optional("zstandard")) is not None:
        coders["differences, zstd 22"] = lambda mesh: zstandard.compress(differences(mesh), 22)
    if import_optional("DracoPy") is not None:
        coders["Draco"] = code_with_draco
    return coders


def planes(mesh: Mesh) -> list[npt.NDArray[np.int64]]:
    """Coordinates, levels and corners of a mesh, each as an array of its own."""
    columns = [*mesh.vertices.T, *mesh.levels.T, *mesh.triangles.T]
    return [column.astype(np.int64) for column in columns]


def raw(mesh: Mesh) -> bytes:
    """Every array in the smallest type that holds it."""
    return b"".join(smallest(column).tobytes() for column in planes(mesh))


def differences(mesh: Mesh) -> bytes:
    """Every array as differences from entry to entry; corners from the first of their triangle."""
    *rest, a, b, c = planes(mesh)
    columns = [np.diff(column, prepend=0) for column in (*rest, a)]
    return b"".join(smallest(column).tobytes() for column in (*columns, b - a, c - a))


def smallest(column: npt.NDArray[np.int64]) -> npt.NDArray[Any]:
    """An array in the smallest type that holds it, its bytes in planes."""
    low, high = int(column.min()), int(column.max())
    kind = np.promote_types(np.min_scalar_type(low), np.min_scalar_type(high))
    narrow = column.astype(kind)
    return narrow.view(np.uint8).reshape(len(narrow), -1).T.copy()


def code_with_draco(mesh: Mesh) -> bytes:
    """The mesh by Draco's slowest and smallest setting; positions are exact, colours are drawn."""
    draco = import_module("DracoPy")
    side = max(mesh.width, mesh.height) << mesh.subdivision
    bits = side.bit_length()
    points = np.pad(mesh.vertices, ((0, 0), (0, 1))).astype(np.float32)
    data: bytes = draco.encode(
        points,
        mesh.triangles.astype(np.uint32),
        quantization_bits=bits,
        compression_level=10,
        quantization_range=(1 << bits) - 1,
        quantization_origin=[0, 0, 0],
        colors=mesh.colors.astype(np.uint8),
    )
    return data


if __name__ == "__main__":
    main()
