"""``vmesh decode``: a .vmesh file -> pixels."""

from __future__ import annotations

from typing import Any

import click

from vmesh.cli.limits import limit_options, take_limits
from vmesh.cli.options import quiet_option, strip_option
from vmesh.cli.progress import show_progress
from vmesh.cli.streams import STANDARD, check_suffix, read_mesh, write_output
from vmesh.formats.metadata.privacy import Strip
from vmesh.formats.registry import FORMATS, RASTER_SUFFIXES, ExportOptions, format_of, write_mesh
from vmesh.limits import MAX_SIDE


class MatrixType(click.ParamType[tuple[float, ...]]):
    """Six numbers with commas between them."""

    name = "a,b,c,d,e,f"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[float, ...]:
        """The numbers of a text."""
        try:
            numbers = tuple(float(part) for part in value.split(","))
        except ValueError:
            numbers = ()
        if len(numbers) != 6:
            self.fail(f"expected six numbers such as 1,0,0,1,0,0, got {value!r}", param, ctx)
        return numbers


@click.command("decode")
@click.argument("source", metavar="INPUT.vmesh")
@click.argument("target", metavar="OUTPUT")
@click.option("--scale", type=click.FloatRange(0, min_open=True), help="Pixels per canvas pixel.")
@click.option("--width", type=click.IntRange(1, MAX_SIDE), help="Width of the result in pixels.")
@click.option("--height", type=click.IntRange(1, MAX_SIDE), help="Height of the result in pixels.")
@click.option(
    "--longest-side", type=click.IntRange(1, MAX_SIDE), help="The larger of both, in pixels."
)
@click.option(
    "--transform",
    type=MatrixType(),
    help="Affine map in SVG's order: x' = a x + c y + e, y' = b x + d y + f.",
)
@click.option(
    "--supersample",
    type=click.IntRange(1, 16),
    default=1,
    show_default=True,
    help="Samples per pixel and direction; for small results.",
)
@click.option(
    "--allow-partial",
    is_flag=True,
    help="Draw what there is of a file that was cut off, if at least its positions are there, or "
    "of one in tiles, if one of them is whole.",
)
@strip_option("none")
@limit_options
@quiet_option
def command(
    source: str,
    target: str,
    scale: float | None,
    width: int | None,
    height: int | None,
    longest_side: int | None,
    transform: tuple[float, ...] | None,
    supersample: int,
    allow_partial: bool,
    strip: Strip | None,
    quiet: bool,
    **options: Any,
) -> None:
    """Turn a .vmesh file into pixels: PNG, JPEG, WebP, TIFF or PAM, by the name of OUTPUT.

    The size is that of the photograph, or --scale, --width, --height, --longest-side say it; one
    side keeps the proportions. Standard output gets a PNG.
    """
    limits = take_limits(options)
    check_suffix(target, RASTER_SUFFIXES)
    if sum(value is not None for value in (scale, width or height, longest_side)) > 1:
        raise click.UsageError("expected --scale, --longest-side or a size, not several of them")
    if longest_side and transform:
        raise click.UsageError("expected no --transform with --longest-side")
    wanted = FORMATS[".png"] if target == STANDARD else format_of(target)
    with show_progress("decoding", 2, quiet=quiet) as report:
        report("reading")
        mesh = read_mesh(source, limits, allow_partial=allow_partial)
        if longest_side:
            is_wide = mesh.width >= mesh.height
            width, height = (longest_side, None) if is_wide else (None, longest_side)
        report("drawing")
        chosen: ExportOptions = {
            "scale": scale,
            "width": width,
            "height": height,
            "transform": transform,
            "supersample": supersample,
            "strip": strip,
        }
        write_output(
            target, lambda stream: write_mesh(mesh, stream, wanted, limits=limits, **chosen)
        )
