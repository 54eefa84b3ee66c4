"""Pictures that went through .vmesh files and through those of the other codecs."""

from __future__ import annotations

import time
from functools import cache
from typing import Any

import click
import numpy as np

import vmesh
from benchmarks.photographs import Photograph
from benchmarks.raster.codecs import available_codecs
from benchmarks.raster.search import CodecSearch, Coded
from benchmarks.rate_distortion.figures import VMESH, Row, row_of
from vmesh.arrays import UInt8Array


def code_with_vmesh(pixels: UInt8Array, effort: int, **target: Any) -> Coded | None:
    """A picture that went through a .vmesh file, None if the target is out of reach.

    Parameters
    ----------
    pixels : ndarray
        Shape (h, w, 3), uint8.
    effort : int
    **target
        What `vmesh.encode` is to reach: ``target_size``, ``target_psnr``, ``quality``.
    """
    warm_up(effort)
    started = time.perf_counter()
    try:
        data = vmesh.dumps(vmesh.encode(pixels, effort=effort, **target))
    except ValueError as error:
        click.echo(f"vmesh, {target}: {error}", err=True)
        return None
    encoded = time.perf_counter()
    raster = vmesh.render(vmesh.loads(data))
    decoded = time.perf_counter()
    settings = ", ".join(f"{name} {value}" for name, value in target.items())
    return Coded(VMESH, settings, len(data), raster, encoded - started, decoded - encoded)


@cache
def warm_up(effort: int) -> None:
    """Have everything compiled before anything is timed."""
    pixels = np.random.default_rng(0).integers(0, 256, (96, 96, 3), dtype=np.uint8)
    targets: tuple[dict[str, Any], ...] = ({"target_size": 600}, {"quality": 50})
    for target in targets:
        vmesh.render(vmesh.loads(vmesh.dumps(vmesh.encode(pixels, effort=effort, **target))))


def measure_points(
    part: str,
    photograph: Photograph,
    effort: int,
    points: dict[str, int],
    perceptual: bool = True,
) -> list[Row]:
    """Every codec within budgets of bytes."""
    search = CodecSearch(photograph.pixels)
    rows = []
    for point, budget in points.items():
        found = [code_with_vmesh(photograph.pixels, effort, target_size=budget)]
        found += [search.best(codec, budget) for codec in available_codecs()]
        rows += [
            row_of(part, photograph, point, budget, coded, perceptual)
            for coded in found
            if coded is not None
        ]
    return rows


def rate_name(rate: float) -> str:
    """A rate as the tables show it."""
    return f"{rate:.2f} bpp"
