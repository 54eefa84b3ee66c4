"""Panels of a sheet: the drawings that are side by side, with their names and figures."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from vmesh.arrays import Float64Array
from vmesh.inspection.region import Region
from vmesh.inspection.sheet.items import PAPER, Frame, Item, View
from vmesh.inspection.stages import Inspection
from vmesh.inspection.views import (
    DRAWINGS,
    INK,
    Draw,
    draw_bicubic,
    draw_error,
    draw_original,
    draw_render,
    draw_triangles,
)


@dataclass(frozen=True, slots=True)
class Panel:
    """A drawing with its name and a detail below it."""

    name: str
    detail: str
    draw: Draw


def stage_panels(inspection: Inspection) -> tuple[Panel, ...]:
    """The panels of the whole picture."""
    mesh = inspection.mesh
    n_pixels = mesh.width * mesh.height
    kind = {1: "grey", 3: "RGB", 4: "RGB and alpha"}[mesh.n_components]
    details = {
        "original": f"{kind} of {mesh.depth} bits",
        "salience": "dark where vertices are wanted",
        "points": f"{mesh.n_vertices:,} ({mesh.n_vertices / n_pixels:.2%} of the pixels)",
        "mesh": f"{mesh.n_triangles:,} triangles",
        "render": f"{_decibels(inspection)} in {inspection.n_bytes:,} bytes",
        "error": _mean_error(inspection.errors),
    }
    return tuple(
        Panel(name.capitalize(), detail, DRAWINGS[name]) for name, detail in details.items()
    )


def enlargement_panels(
    inspection: Inspection, region: Region, *, is_enlarged: bool
) -> tuple[Panel, ...]:
    """The panels of a region."""
    part = np.s_[region.top : region.top + region.height, region.left : region.left + region.width]
    place = f"{region.width} x {region.height} pixels at {region.left}, {region.top}"
    return (
        Panel("Region", place, _draw_place),
        Panel("Original", "a pixel is a square" if is_enlarged else "", draw_original),
        Panel("Bicubic", "the original, interpolated", draw_bicubic),
        Panel("Mesh", "drawn at this scale", draw_render),
        Panel("Triangles", "over the original, paler" if is_enlarged else "", draw_triangles),
        Panel("Error", _mean_error(inspection.errors[part]), draw_error),
    )


def _draw_place(inspection: Inspection, view: View) -> Iterator[Item]:
    """The whole picture, as large as it fits, with a frame around a view's region."""
    height, width = inspection.original.shape[:2]
    whole = Region(0, 0, width, height)
    scale = min(view.width / width, view.height / height)
    size = whole.view(scale)
    x, y = view.x + (view.width - size.width) // 2, view.y + (view.height - size.height) // 2
    yield from draw_original(inspection, whole.view(scale, x, y))
    place = x + round(view.left * scale), y + round(view.top * scale)
    extent = [max(2, round(side * scale)) for side in (view.across, view.down)]
    for width, color in enumerate((INK, PAPER, INK)):
        left, top = (side - width for side in place)
        across, down = (side + 2 * width for side in extent)
        yield Frame(left, top, across, down, color)


def figures_of(inspection: Inspection) -> str:
    """The figures of a mesh in a line."""
    mesh, n_bytes = inspection.mesh, inspection.n_bytes
    bits = 8 * n_bytes / (mesh.width * mesh.height)
    return (
        f"{mesh.width} x {mesh.height} pixels, {mesh.n_vertices:,} vertices, "
        f"{mesh.n_triangles:,} triangles, {n_bytes:,} bytes, {bits:.3f} bits per pixel, "
        f"{_decibels(inspection)}"
    )


def _decibels(inspection: Inspection) -> str:
    found = inspection.psnr
    return "no error" if found == float("inf") else f"PSNR {found:.2f} dB"


def _mean_error(errors: Float64Array) -> str:
    return f"mean {errors.mean():.1f} levels"
