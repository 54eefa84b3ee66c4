"""``vmesh import``: a mesh of another program -> a .vmesh file."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any, Final

import click

from vmesh.batch.sources import Kind
from vmesh.cli.jobs import Job, Making, job_arguments, take_jobs
from vmesh.cli.limits import limit_options, take_limits
from vmesh.cli.options import quiet_option
from vmesh.cli.progress import show_progress
from vmesh.codec.layout import FILE_SUFFIX
from vmesh.errors import LimitError, shown
from vmesh.formats.registry import MESH_SUFFIXES
from vmesh.limits import MAX_SIDE

if TYPE_CHECKING:
    from vmesh.mesh import Mesh


_MAKING: Final = Making(
    Kind("meshes of other programs", frozenset(MESH_SUFFIXES)), (FILE_SUFFIX,), FILE_SUFFIX
)


@click.command("import")
@job_arguments("INPUT", "OUTPUT.vmesh")
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
    scale: float | None,
    width: int | None,
    height: int | None,
    color_step: int,
    quiet: bool,
    **options: Any,
) -> None:
    """Turn meshes of other programs, PLY, OBJ, glTF (.glb) or canonical text, into .vmesh files.

    Without OUTPUT.vmesh it is named after INPUT, with .vmesh at its end. With -o DIR there may be
    many INPUTs, also folders.

    Triangles have to be flat, with a colour at every vertex, and cover the box around them, which
    becomes the canvas. x points right, y up. --width or --height alone keeps the proportions.
    """
    limits = take_limits(options)
    if scale and (width or height):
        raise click.UsageError("expected --scale or a size, not both")
    jobs = take_jobs(options, _MAKING)
    for source in (job.source for job in jobs.jobs):
        if not source.lower().endswith(MESH_SUFFIXES):
            endings = ", ".join(MESH_SUFFIXES)
            raise click.UsageError(f"{shown(source)}: expected a name that ends in {endings}")

    def work(job: Job) -> None:
        read = partial(
            import_one, scale=scale, width=width, height=height, step=color_step, limits=limits
        )
        from vmesh.codec.writer import dumps

        with show_progress(f"importing{job.place}", 2, quiet=quiet) as report:
            report("reading")
            mesh = read(job.source)
            report("writing")
            data = dumps(mesh)
            job.write(lambda stream: stream.write(data))

    jobs.run(work)


def import_one(source: str, **options: Any) -> Mesh:
    """Mesh of another program's file; errors name it."""
    from vmesh.formats.models.mesh_import import import_mesh

    try:
        return import_mesh(source, **options)
    except LimitError as error:
        raise LimitError(f"{shown(source)}: {error}") from None
    except ValueError as error:
        raise ValueError(f"{shown(source)}: {error}") from None
