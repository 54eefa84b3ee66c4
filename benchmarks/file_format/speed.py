"""Speed of writing and reading a mesh."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Final

import vmesh
from benchmarks.file_format.coders import DRACO, Coder
from benchmarks.measurement import judge_speed, time_actions
from benchmarks.tables import Printer, Table
from vmesh.mesh import Mesh

SPEED_TARGET: Final = 1e6  # vertices per second of reading


def report_speed(printer: Printer, mesh: Mesh, coders: Mapping[str, Coder], runs: int) -> None:
    """Print how fast a mesh is written and read, on one core."""
    data = vmesh.dumps(mesh)
    actions: dict[str, Callable[[], object]] = {
        "vmesh, writing": lambda: vmesh.dumps(mesh),
        "vmesh, reading": lambda: vmesh.loads(data),
    }
    if DRACO in coders:
        draco = import_module("DracoPy")
        coded = coders[DRACO](mesh)
        actions["Draco, writing"] = lambda: coders[DRACO](mesh)
        actions["Draco, reading"] = lambda: draco.decode(coded)
    times = time_actions(actions, runs)
    printer.heading("Speed")
    rows = [
        (name, *timing.cells(), f"{mesh.n_vertices / timing.median / 1e6:.3f}")
        for name, timing in times.items()
    ]
    header = ("action", "median ms", "fastest", "slowest", "million vertices/s")
    title = f"A mesh of {mesh.n_vertices} vertices, warm, {runs} runs of each in turns"
    printer.table(Table(title, header, rows))
    verdict = judge_speed(mesh.n_vertices / times["vmesh, reading"].median, SPEED_TARGET)
    printer.paragraph(f"Wanted of reading, a million vertices per second: {verdict}.")
