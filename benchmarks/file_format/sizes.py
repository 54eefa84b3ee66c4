"""Bits of each vertex, by parts of the file and beside other ways of storing the same mesh."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import mean
from typing import Final

import vmesh
from benchmarks.file_format.coders import Coder
from benchmarks.measurement import judge
from benchmarks.photographs import n_pictures
from benchmarks.tables import Printer, Table
from vmesh.codec.layout import LISTED_TRIANGLES, Header
from vmesh.codec.mesh_coder import encode_mesh
from vmesh.codec.reader import measure
from vmesh.mesh import Mesh

DENSITIES: Final = (0.0075, 0.02, 0.04)  # vertices for each pixel
TARGETS: Final = {0.0075: 14.0, 0.02: 12.0}  # bits per vertex of a whole file
TRIANGLES_TARGET: Final = 4.5  # bits per vertex of the triangles alone


@dataclass(frozen=True, slots=True)
class Sizes:
    """Bits per vertex of a mesh: of the parts of its file, of a list, and by other coders."""

    density: float
    parts: dict[str, float]
    listed: float
    others: dict[str, float]


def measure_sizes(mesh: Mesh, density: float, coders: Mapping[str, Coder]) -> Sizes:
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


def report_sizes(printer: Printer, found: Sequence[Sizes], n: int) -> None:
    """Print the means over `n` pictures by part, and those of the other coders."""
    printer.heading("Bits per vertex")
    rows = []
    for density in DENSITIES:
        parts = [
            mean_part(found, density, name)
            for name in ("frame", "positions", "colors", "triangles")
        ]
        total = mean_total(found, density)
        verdict = judge(total, TARGETS[density]) if density in TARGETS else "-"
        figures = (f"{bits:.2f}" for bits in (*parts, total))
        rows.append((f"{density:.2%}", *figures, verdict))
    header = ("vertices per pixel", "frame", "positions", "colours", "triangles", "file", "target")
    printer.table(Table(f"By part: mean of {n_pictures(n)}", header, rows))
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


def mean_part(found: Sequence[Sizes], density: float, part: str) -> float:
    """Mean bits per vertex of a part."""
    return mean(sizes.parts.get(part, 0.0) for sizes in found if sizes.density == density)


def mean_total(found: Sequence[Sizes], density: float) -> float:
    """Mean bits per vertex of whole files."""
    return mean(sum(sizes.parts.values()) for sizes in found if sizes.density == density)
