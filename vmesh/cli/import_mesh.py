"""``vmesh import``: a mesh of another program -> a .vmesh file."""

from __future__ import annotations

from typing import Any

import click

from vmesh.cli.limits import limit_options, take_limits
from vmesh.cli.options import quiet_option
from vmesh.cli.progress import show_progress
from vmesh.cli.streams import check_suffix, write_output
from vmesh.codec.layout import FILE_SUFFIX
from vmesh.errors import LimitError
from vmesh.formats.registry import MESH_SUFFIXES
from vmesh.limits import MAX_SIDE


@click.command("import")
@click.argument("source", metavar="INPUT")
@click.argument("target", metavar="OUTPUT.vmesh")
@click.option(
    "--scale", type=click.FloatRange(0, min_open=True), help="Pixels in a unit of INPUT, else 1."
)
@click.option("--width", type=click.IntRange(1, MAX_SIDE), help="Width of the canvas in pixels.")
@click.option("--height", type=click.IntRange(1, MAX_SIDE), help="Height of the canvas in pixels.")
@click.option(
    "--color-step",
    type=click.IntRange(1, 255),
    default=1,
    show_default=True,
    help="Rounding of the vertex colours, 1 for none; 8 makes the file about a third smaller.",
)
@limit_options
@quiet_option
def command(
    source: str,
    target: str,
    scale: float | None,
    width: int | None,
    height: int | None,
    color_step: int,
    quiet: bool,
    **options: Any,
) -> None:
    """Turn a mesh of another program, PLY, OBJ, glTF (.glb) or canonical text, into a .vmesh file.

    Its triangles have to be flat, with a colour at every vertex, and cover the box around them,
    which becomes the canvas. x points right, y up. --width or --height alone keeps the proportions.
    """
    limits = take_limits(options)
    if not source.lower().endswith(MESH_SUFFIXES):
        raise click.UsageError(f"{source}: expected a name that ends in {', '.join(MESH_SUFFIXES)}")
    if scale and (width or height):
        raise click.UsageError("expected --scale or a size, not both")
    check_suffix(target, (FILE_SUFFIX,))
    from vmesh.codec.writer import dumps
    from vmesh.formats.models.mesh_import import import_mesh

    with show_progress("importing", 2, quiet=quiet) as report:
        report("reading")
        try:
            mesh = import_mesh(
                source, scale=scale, width=width, height=height, step=color_step, limits=limits
            )
        except LimitError as error:
            raise LimitError(f"{source}: {error}") from None
        except ValueError as error:
            raise ValueError(f"{source}: {error}") from None
        report("writing")
        data = dumps(mesh)
        write_output(target, lambda stream: stream.write(data))
