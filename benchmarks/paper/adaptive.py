"""PSNR of the adaptive method beside that of sampling, at equal numbers of vertices."""

from __future__ import annotations

from collections.abc import Sequence
from statistics import mean
from typing import Any

import click

import vmesh
from benchmarks.paper.comparison import DENSITIES, FINEST_STEP
from benchmarks.photographs import Photograph, n_pictures
from benchmarks.tables import Printer, Table
from vmesh.metrics import psnr


def report_adaptive(
    printer: Printer, photographs: list[Photograph], efforts: Sequence[int], each: bool
) -> None:
    """Print what the adaptive method gains over sampling, at equal numbers of vertices."""
    methods: dict[str, dict[str, Any]] = {"blue-noise": {"method": "blue-noise"}}
    methods |= {f"adaptive, effort {effort}": {"effort": effort} for effort in efforts}
    rows = []
    decibels: dict[str, list[list[float]]] = {name: [] for name in methods}
    for photograph in photographs:
        click.echo(f"remeshing {photograph.name}", err=True)
        for name, settings in methods.items():
            own = measure_method(photograph, settings)
            decibels[name].append(own)
            if each:
                rows.append((photograph.name, name, *(f"{db:.2f}" for db in own)))
    for name, values in decibels.items():
        means = (f"{mean(column):.2f}" for column in zip(*values, strict=True))
        rows.append(("mean", name, *means))
    header = ("picture", "method", *(f"{density:.0%}" for density in DENSITIES))
    printer.heading("The adaptive method")
    title = f"PSNR (RGB) in dB, fitted colors of step {FINEST_STEP}, {n_pictures(len(photographs))}"
    printer.table(Table(title, header, rows, n_words=2))


def measure_method(photograph: Photograph, settings: dict[str, Any]) -> list[float]:
    """PSNR at each of `DENSITIES` of a photograph encoded by a method, colors unquantised."""
    meshes = (
        vmesh.encode(photograph.pixels, density=density, color_step=FINEST_STEP, **settings)
        for density in DENSITIES
    )
    return [psnr(photograph.pixels, vmesh.render(mesh)) for mesh in meshes]
