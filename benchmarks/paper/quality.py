"""PSNR of meshes of the same numbers of points, by sampler and by colours."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from statistics import mean
from typing import Final

import click

import vmesh
from benchmarks.paper.comparison import COLORS, DENSITIES, FINEST_STEP, SAMPLERS, STEPS
from benchmarks.photographs import Photograph, n_pictures
from benchmarks.tables import Printer, Table
from vmesh.encoder.settings import ColorMode, Sampler
from vmesh.metrics import psnr

# Measured before this program was written, over 24 Kodak photographs: dB at each density.
PUBLISHED: Final[dict[ColorMode, tuple[float, ...]]] = {
    "sampled": (20.3, 22.5, 24.8),
    "fitted": (23.7, 25.3, 27.1),
}


@dataclass(frozen=True, slots=True)
class Quality:
    """PSNR at each of `DENSITIES` of a photograph's meshes of one kind, and their densities."""

    photograph: str
    sampler: Sampler
    colors: ColorMode
    step: int
    decibels: tuple[float, ...]
    densities: tuple[float, ...]


def report_quality(printer: Printer, photographs: list[Photograph], each: bool) -> None:
    """Print PSNR at equal numbers of points."""
    qualities = []
    for photograph in photographs:
        click.echo(f"encoding {photograph.name}", err=True)
        qualities += [
            measure_quality(photograph, sampler, colors, step)
            for sampler, colors, step in product(SAMPLERS, COLORS, STEPS)
        ]
    names = [photograph.name for photograph in photographs]
    header = tuple(f"{density:.0%}, step {step}" for step, density in product(STEPS, DENSITIES))
    printer.heading("Quality at equal numbers of points")
    means = [
        ("here", sampler, colors, *quality_cells(qualities, names, sampler, colors))
        for sampler, colors in product(SAMPLERS, COLORS)
    ]
    means += [
        ("published, 24 pictures", "-", colors, *(f"{db:.1f}" for db in decibels), *("-",) * 3)
        for colors, decibels in PUBLISHED.items()
    ]
    printer.table(
        Table(
            f"PSNR (RGB) in dB, mean of {n_pictures(len(names))}",
            ("source", "sampler", "colors", *header),
            means,
            n_words=3,
        )
    )
    printer.paragraph(describe_quality(qualities))
    if not each:
        return
    rows = [
        (name, sampler, colors, *quality_cells(qualities, [name], sampler, colors))
        for name, sampler, colors in product(names, SAMPLERS, COLORS)
    ]
    printer.table(
        Table(
            "PSNR (RGB) in dB of each picture",
            ("picture", "sampler", "colors", *header),
            rows,
            n_words=3,
        )
    )


def measure_quality(
    photograph: Photograph, sampler: Sampler, colors: ColorMode, step: int
) -> Quality:
    """PSNR of a photograph's meshes of one kind, drawn at its own size."""
    meshes = [
        vmesh.encode(
            photograph.pixels,
            method="blue-noise",
            density=density,
            sampler=sampler,
            colors=colors,
            color_step=step,
        )
        for density in DENSITIES
    ]
    return Quality(
        photograph.name,
        sampler,
        colors,
        step,
        tuple(psnr(photograph.pixels, vmesh.render(mesh)) for mesh in meshes),
        tuple(mesh.n_vertices / (mesh.width * mesh.height) for mesh in meshes),
    )


def quality_cells(
    qualities: list[Quality], names: Sequence[str], sampler: Sampler, colors: ColorMode
) -> list[str]:
    """Mean PSNR over some pictures, for each step and density."""
    cells = []
    for step in STEPS:
        chosen = [
            quality.decibels
            for quality in qualities
            if quality.photograph in names
            and (quality.sampler, quality.colors, quality.step) == (sampler, colors, step)
        ]
        cells += [f"{mean(column):.2f}" for column in zip(*chosen, strict=True)]
    return cells


def describe_quality(qualities: list[Quality]) -> str:
    """Sentences that say how equal the numbers of points are, and which sampler is better."""
    wanted = [quality.densities for quality in qualities]
    worst = max(
        abs(density / target - 1)
        for densities in wanted
        for density, target in zip(densities, DENSITIES, strict=True)
    )
    sentences = [f"The numbers of points are within {worst:.1%} of those asked for."]
    for colors in COLORS:
        gains = multiclass_gains(qualities, colors)
        better = sum(gain > 0 for gain in gains)
        sentences.append(
            f"With {colors} colors of step {FINEST_STEP} `multiclass` is better than `channels` in "
            f"{better} of {len(gains)} cases, by {mean(gains):+.3f} dB in the mean."
        )
    return " ".join(sentences)


def multiclass_gains(qualities: list[Quality], colors: ColorMode) -> list[float]:
    """Gains of multiclass sampling over channels, in dB, for each picture and density."""
    by_sampler = {
        sampler: [
            decibels
            for quality in qualities
            if (quality.sampler, quality.colors, quality.step) == (sampler, colors, FINEST_STEP)
            for decibels in quality.decibels
        ]
        for sampler in SAMPLERS
    }
    pairs = zip(by_sampler["multiclass"], by_sampler["channels"], strict=True)
    return [multiclass - channels for multiclass, channels in pairs]
