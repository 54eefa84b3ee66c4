"""``vmesh compare``: how close two pictures or meshes are."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import click

from vmesh.cli.limits import limit_options, take_limits
from vmesh.cli.options import (
    json_option,
    picture_options,
    take_reading,
)
from vmesh.cli.streams import Reading, read_mesh_or_photograph, tell

if TYPE_CHECKING:
    from vmesh.arrays import UInt8Array
    from vmesh.limits import Limits


@click.command("compare")
@click.argument("first", metavar="A")
@click.argument("second", metavar="B")
@picture_options
@limit_options
@json_option
def command(first: str, second: str, as_json: bool, **options: Any) -> None:
    """Print PSNR over RGB and over luma, and SSIM, of two pictures or .vmesh files.

    Both are compared in sRGB, into which colours are converted that have another ICC profile.
    B is brought to the size of A: a mesh by drawing it at that size, a picture by bicubic
    resampling. What is transparent counts as white.
    """
    reading, limits = take_reading(options), take_limits(options)
    from vmesh.metrics import compare

    reference = _pixels(first, reading, limits, None)
    other = _pixels(second, reading, limits, (reference.shape[1], reference.shape[0]))
    figures = compare(reference, other)
    if as_json:
        # JSON has no infinity: equal pictures have no PSNR.
        finite = {key: x if x != float("inf") else None for key, x in figures.items()}
        tell(json.dumps(finite))
    else:
        tell(f"PSNR RGB  {figures['psnr_rgb']:.3f} dB")
        tell(f"PSNR Y    {figures['psnr_y']:.3f} dB")
        tell(f"SSIM      {figures['ssim']:.5f}")


def _pixels(
    path: str, reading: Reading, limits: Limits, size: tuple[int, int] | None
) -> UInt8Array:
    """Pixels of a picture or mesh in sRGB, shape (h, w, 3), at a size or at its own."""
    from vmesh.formats.color.conversion import to_srgb
    from vmesh.formats.picture.conversion import flatten, resize
    from vmesh.formats.raster.rendering import render
    from vmesh.mesh import Mesh

    given = read_mesh_or_photograph(path, reading, limits)
    profile = given.metadata.icc
    if isinstance(given, Mesh):
        width, height = size or (given.width, given.height)
        raster = render(given, limits=limits, width=width, height=height)
        return flatten(to_srgb(raster, profile, given.depth), given.depth)
    pixels = flatten(to_srgb(given.array, profile))
    return pixels if size is None else resize(pixels, size)
