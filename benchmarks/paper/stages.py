"""Milliseconds of each stage of the encoder and the codec, against their targets."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np
from scipy.spatial import Delaunay

import vmesh
from benchmarks.measurement import judge, time_actions
from benchmarks.photographs import Photograph
from benchmarks.tables import Printer, Table
from vmesh.arrays import UInt8Array
from vmesh.encoder.colors import fit_colors
from vmesh.encoder.image import premultiplied_planes, weighted
from vmesh.encoder.salience import compute_salience
from vmesh.encoder.sampling import sample
from vmesh.kernels.delaunay import delaunay

CROP: Final = 500
PIXEL_UNIT: Final = 2  # lattice units in a pixel
PROPOSAL: Final = "salience and sampling at the natural scale, together"
TRIANGULATION: Final = "triangulation"
FITTING: Final = "fitting of colors"
QHULL: Final = "scipy.spatial.Delaunay of the same points"
TARGETS: Final = {PROPOSAL: 15.0, TRIANGULATION: 20.0, FITTING: 150.0}  # milliseconds


def report_speed(printer: Printer, photograph: Photograph, n_vertices: int, runs: int) -> None:
    """Print how long each stage takes, against the targets."""
    pixels = np.ascontiguousarray(photograph.pixels[:CROP, :CROP])
    timings = time_actions(stages(pixels, n_vertices), runs)
    rows = []
    for name, timing in timings.items():
        target = TARGETS.get(name)
        verdict = ("-", "-")
        if target is not None:
            verdict = (f"{target:.0f}", judge(timing.median * 1e3, target))
        rows.append((name, *timing.cells(), *verdict))
    height, width = pixels.shape[:2]
    natural = sample(compute_salience(premultiplied_planes(pixels))).n_points
    printer.heading("Speed")
    printer.table(
        Table(
            f"Stages in ms, {width} x {height} pixels of {photograph.name}",
            ("stage", "median", "min", "max", "target", "median against target"),
            rows,
        )
    )
    ratio = timings[QHULL].median / timings[TRIANGULATION].median
    printer.paragraph(
        f"Warm, one thread, in turns; runs of each: {runs}. The natural scale gives {natural} "
        f"points at gamma 1; all stages from the triangulation on work on a mesh of about "
        f"{n_vertices} vertices. By the medians, scipy takes {ratio:.1f} times as long as our "
        "triangulation."
    )


def stages(pixels: UInt8Array, n_vertices: int) -> dict[str, Callable[[], object]]:
    """The encoder's stages, and the codec's, each ready to run by itself."""
    salience = compute_salience(premultiplied_planes(pixels))
    mesh = vmesh.encode(pixels, method="blue-noise", vertices=n_vertices)
    vertices, triangles = mesh.vertices, mesh.triangles
    colors, _ = fit_colors(weighted(pixels), vertices, triangles, PIXEL_UNIT)
    data = vmesh.dumps(mesh)
    return {
        "salience": lambda: compute_salience(premultiplied_planes(pixels)),
        "sampling at the natural scale": lambda: sample(salience),
        PROPOSAL: lambda: sample(compute_salience(premultiplied_planes(pixels))),
        f"sampling to {n_vertices} points": lambda: sample(salience, n_points=n_vertices),
        TRIANGULATION: lambda: delaunay(vertices),
        QHULL: lambda: Delaunay(vertices),
        FITTING: lambda: fit_colors(weighted(pixels), vertices, triangles, PIXEL_UNIT),
        "quantization": lambda: mesh.lattice.levels_from_colors(np.rint(colors)),
        "dumps": lambda: vmesh.dumps(mesh),
        "loads": lambda: vmesh.loads(data),
    }
