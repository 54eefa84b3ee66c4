"""Measure the encoder as its paper was measured: points, quality, bits and speed.

X. Zhao, J. Feng, B. Zhou, "Image vectorization using blue-noise sampling", 2013.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise, product
from pathlib import Path
from statistics import mean
from typing import Any, Final, get_args

import click
import numpy as np
from scipy.spatial import Delaunay

import vmesh
from benchmarks.measurement import (
    Photograph,
    Printer,
    Table,
    describe_machine,
    images_option,
    judge,
    load_photographs,
    markdown_option,
    time_actions,
)
from vmesh.arrays import UInt8Array
from vmesh.codec.reader import measure
from vmesh.encoder.colors import fit_colors
from vmesh.encoder.image import visible_planes
from vmesh.encoder.salience import compute_salience
from vmesh.encoder.sampling import sample
from vmesh.encoder.settings import ColorMode, Sampler
from vmesh.kernels.delaunay import delaunay
from vmesh.metrics import psnr

GAMMAS: Final = (1.0, 0.8, 0.6, 0.48, 0.28)
DENSITIES: Final = (0.01, 0.02, 0.04)
SAMPLERS: Final[tuple[Sampler, ...]] = get_args(Sampler)
COLORS: Final[tuple[ColorMode, ...]] = ("sampled", "fitted")
FINEST_STEP: Final = 1  # 8-bit colors, as the published figures have them
STEPS: Final = (FINEST_STEP, 8)

# Measured before this program was written, over 24 Kodak photographs: dB at each density.
PUBLISHED: Final[dict[ColorMode, tuple[float, ...]]] = {
    "sampled": (20.3, 22.5, 24.8),
    "fitted": (23.7, 25.3, 27.1),
}
PAPER_BITS: Final = 56  # a vertex: the paper's Table 1 counts seven bytes

EFFORTS: Final = (5, 9)
CROP: Final = 500
POINTS: Final = 20_000
RUNS: Final = 15
PIXEL_UNIT: Final = 2  # lattice units in a pixel
PROPOSAL: Final = "salience and sampling at the natural scale, together"
TRIANGULATION: Final = "triangulation"
FITTING: Final = "fitting of colors"
QHULL: Final = "scipy.spatial.Delaunay of the same points"
TARGETS: Final = {PROPOSAL: 15.0, TRIANGULATION: 20.0, FITTING: 150.0}  # milliseconds


@dataclass(frozen=True, slots=True)
class Quality:
    """PSNR at each of `DENSITIES` of a photograph's meshes of one kind, and their densities."""

    photograph: str
    sampler: Sampler
    colors: ColorMode
    step: int
    decibels: tuple[float, ...]
    densities: tuple[float, ...]


@click.command()
@images_option
@markdown_option
def main(folder: Path, markdown: bool) -> None:
    """Measure the encoder on a folder of photographs, as its paper was measured."""
    photographs = load_photographs(folder)
    printer = Printer(markdown)
    report_points(printer, photographs)
    report_quality(printer, photographs)
    report_adaptive(printer, photographs)
    report_bits(printer, photographs)
    report_speed(printer, photographs[0])


def report_points(printer: Printer, photographs: list[Photograph]) -> None:
    """Print how many points each gamma gives with each sampler."""
    counts = {
        (photograph.name, sampler): count_points(photograph.pixels, sampler)
        for photograph, sampler in product(photographs, SAMPLERS)
    }
    pixels = {photograph.name: photograph.pixels[:, :, 0].size for photograph in photographs}
    rows = [
        (name, sampler, *(f"{n} ({n / pixels[name]:.2%})" for n in found))
        for (name, sampler), found in counts.items()
    ]
    shares = {
        sampler: [
            [n / pixels[name] for n in found]
            for (name, own), found in counts.items()
            if own == sampler
        ]
        for sampler in SAMPLERS
    }
    for sampler in SAMPLERS:
        found = [mean(counts[name, sampler][i] for name in pixels) for i in range(len(GAMMAS))]
        density = [mean(column) for column in zip(*shares[sampler], strict=True)]
        cells = (f"{n:.0f} ({d:.2%})" for n, d in zip(found, density, strict=True))
        rows.append(("mean", sampler, *cells))
    printer.heading("Points by gamma")
    header = ("picture", "sampler", *(f"gamma {gamma}" for gamma in GAMMAS))
    printer.table(Table("Distinct points (density)", header, rows, n_words=2))
    printer.paragraph(describe_points(counts))


def count_points(pixels: UInt8Array, sampler: Sampler) -> list[int]:
    """Distinct points of a picture at each of `GAMMAS`, those on the border included."""
    planes = visible_planes(pixels)
    return [sample(compute_salience(planes, gamma), sampler=sampler).n_points for gamma in GAMMAS]


def describe_points(counts: dict[tuple[str, Sampler], list[int]]) -> str:
    """In words: whether smaller gammas give more points, and which sampler gives more."""
    names = list(dict.fromkeys(name for name, _ in counts))
    growing = {
        sampler: sum(
            all(before < after for before, after in pairwise(counts[name, sampler]))
            for name in names
        )
        for sampler in SAMPLERS
    }
    pairs = [
        pair
        for name in names
        for pair in zip(counts[name, "multiclass"], counts[name, "channels"], strict=True)
    ]
    more = sum(multiclass > channels for multiclass, channels in pairs)
    gains = [
        mean(counts[name, "multiclass"][i] / counts[name, "channels"][i] for name in names) - 1
        for i in range(len(GAMMAS))
    ]
    listed = ", ".join(f"{gain:+.1%}" for gain in gains)
    return (
        "A smaller gamma gives more points at every step in "
        + " and ".join(
            f"{growing[sampler]} of {len(names)} pictures with `{sampler}`" for sampler in SAMPLERS
        )
        + f". At equal gamma `multiclass` gives more distinct points than `channels` in {more} of "
        f"{len(pairs)} cases; by gamma, in the order of the table, {listed} in the mean."
    )


def report_quality(printer: Printer, photographs: list[Photograph]) -> None:
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
            f"PSNR (RGB) in dB, mean of {len(names)} pictures",
            ("source", "sampler", "colors", *header),
            means,
            n_words=3,
        )
    )
    printer.paragraph(describe_quality(qualities))
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


def report_adaptive(printer: Printer, photographs: list[Photograph]) -> None:
    """Print what the adaptive method gains over sampling, at equal numbers of vertices."""
    methods: dict[str, dict[str, Any]] = {"blue-noise": {"method": "blue-noise"}}
    methods |= {f"adaptive, effort {effort}": {"effort": effort} for effort in EFFORTS}
    rows = []
    decibels: dict[str, list[list[float]]] = {name: [] for name in methods}
    for photograph in photographs:
        click.echo(f"remeshing {photograph.name}", err=True)
        for name, settings in methods.items():
            own = measure_method(photograph, settings)
            decibels[name].append(own)
            rows.append((photograph.name, name, *(f"{db:.2f}" for db in own)))
    for name, values in decibels.items():
        means = (f"{mean(column):.2f}" for column in zip(*values, strict=True))
        rows.append(("mean", name, *means))
    header = ("picture", "method", *(f"{density:.0%}" for density in DENSITIES))
    printer.heading("The adaptive method")
    title = f"PSNR (RGB) in dB, fitted colors of step {FINEST_STEP}"
    printer.table(Table(title, header, rows, n_words=2))


def measure_method(photograph: Photograph, settings: dict[str, Any]) -> list[float]:
    """PSNR at each of `DENSITIES` of a photograph encoded by a method, colors unquantised."""
    meshes = (
        vmesh.encode(photograph.pixels, density=density, color_step=FINEST_STEP, **settings)
        for density in DENSITIES
    )
    return [psnr(photograph.pixels, vmesh.render(mesh)) for mesh in meshes]


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
    """In words: how equal the numbers of points are, and which sampler is better."""
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
    """What multiclass sampling gains over channels, in dB, for each picture and density."""
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


def report_bits(printer: Printer, photographs: list[Photograph]) -> None:
    """Print the bits per vertex of real files."""
    figures = [
        [bits for density in DENSITIES for bits in count_bits(photograph.pixels, density)]
        for photograph in photographs
    ]
    means = [mean(column) for column in zip(*figures, strict=True)]
    rows = [
        (photograph.name, *(f"{bits:.2f}" for bits in own))
        for photograph, own in zip(photographs, figures, strict=True)
    ]
    rows.append(("mean", *(f"{bits:.2f}" for bits in means)))
    rows.append(("paper", *(("-", "-", str(PAPER_BITS)) * len(DENSITIES))))
    parts = ("positions", "colors", "file")
    header = (f"{part}, {density:.0%}" for density, part in product(DENSITIES, parts))
    printer.heading("Bits per vertex")
    printer.table(Table("Files at default settings", ("picture", *header), rows))
    ratios = ", ".join(f"{PAPER_BITS / bits:.2f}" for bits in means[2::3])
    printer.paragraph(
        f"The paper's {PAPER_BITS} bits are {ratios} times the mean of these files. Triangles are "
        "implied by the vertices and cost nothing; the file holds its header and checksums too."
    )


def count_bits(pixels: UInt8Array, density: float) -> tuple[float, float, float]:
    """Bits per vertex of the positions, the colors and the whole file."""
    mesh = vmesh.encode(pixels, method="blue-noise", density=density)
    data = vmesh.dumps(mesh)
    _, sizes = measure(data)
    parts = (sizes["positions"], sizes["colors"], len(data))
    positions, colors, whole = (8 * part / mesh.n_vertices for part in parts)
    return positions, colors, whole


def report_speed(printer: Printer, photograph: Photograph) -> None:
    """Print how long each stage takes, against the targets."""
    pixels = np.ascontiguousarray(photograph.pixels[:CROP, :CROP])
    timings = time_actions(stages(pixels), RUNS)
    rows = []
    for name, timing in timings.items():
        target = TARGETS.get(name)
        verdict = ("-", "-")
        if target is not None:
            verdict = (f"{target:.0f}", judge(timing.median * 1e3, target))
        rows.append((name, *timing.cells(), *verdict))
    height, width = pixels.shape[:2]
    natural = sample(compute_salience(visible_planes(pixels))).n_points
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
        f"Warm, one thread, {RUNS} runs of each stage in turns. The natural scale gives {natural} "
        f"points at gamma 1; all stages from the triangulation on work on the mesh of about "
        f"{POINTS}. scipy takes {ratio:.1f} times as long as our triangulation (by the medians)."
    )
    printer.paragraph(describe_machine())


def stages(pixels: UInt8Array) -> dict[str, Callable[[], object]]:
    """The encoder's stages, and the codec's, each ready to run by itself."""
    salience = compute_salience(visible_planes(pixels))
    mesh = vmesh.encode(pixels, method="blue-noise", vertices=POINTS)
    vertices, triangles = mesh.vertices, mesh.triangles
    colors, _ = fit_colors(pixels, vertices, triangles, PIXEL_UNIT)
    data = vmesh.dumps(mesh)
    return {
        "salience": lambda: compute_salience(visible_planes(pixels)),
        "sampling at the natural scale": lambda: sample(salience),
        PROPOSAL: lambda: sample(compute_salience(visible_planes(pixels))),
        f"sampling to {POINTS} points": lambda: sample(salience, n_points=POINTS),
        TRIANGULATION: lambda: delaunay(vertices),
        QHULL: lambda: Delaunay(vertices),
        FITTING: lambda: fit_colors(pixels, vertices, triangles, PIXEL_UNIT),
        "quantization": lambda: mesh.lattice.levels_from_colors(np.rint(colors)),
        "dumps": lambda: vmesh.dumps(mesh),
        "loads": lambda: vmesh.loads(data),
    }


if __name__ == "__main__":
    main()
