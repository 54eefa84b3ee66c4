"""``vmesh export``: a .vmesh file or a photograph -> a mesh for other programs."""

from __future__ import annotations

from typing import Any, Final

import click

from vmesh.batch.sources import PICTURES_AND_MESHES
from vmesh.cli.jobs import Job, Making, job_arguments, take_jobs
from vmesh.cli.limits import limit_options, take_limits
from vmesh.cli.options import (
    encoder_options,
    mask_option,
    picture_options,
    quiet_option,
    take_picture_options,
    take_settings,
)
from vmesh.cli.streams import STANDARD
from vmesh.cli.vector import convert
from vmesh.formats.registry import MESH_SUFFIXES, ExportOptions, format_of

_MAKING: Final = Making(PICTURES_AND_MESHES, MESH_SUFFIXES)


@click.command("export")
@job_arguments("INPUT", "OUTPUT", has_folder=False)
@click.option("--ascii", is_flag=True, help="PLY as text instead of binary.")
@picture_options
@mask_option
@encoder_options
@limit_options
@quiet_option
def command(ascii: bool, mask: str | None, quiet: bool, **options: Any) -> None:
    """Turn a .vmesh file, or a photograph, into a mesh for other programs, by the name of OUTPUT.

    PLY, OBJ and glTF (.glb) with a colour at every vertex need trimesh: pip install trimesh. A
    pixel is a unit, x points right, y up, and z is 0. A name that ends in .txt gets the canonical
    text, to the last level. The options of the encoder apply to photographs.
    """
    settings, limits = take_settings(options), take_limits(options)
    reading = take_picture_options(options)
    jobs = take_jobs(options, _MAKING)
    target = jobs.jobs[0].target
    if target == STANDARD:
        raise click.UsageError("expected a name for OUTPUT: its ending says the format")
    chosen: ExportOptions = {"ascii": True} if ascii else {}
    if ascii and not target.lower().endswith(".ply"):
        raise click.UsageError("--ascii is for PLY")

    def work(job: Job) -> None:
        wanted = format_of(target)
        convert(job, wanted, settings, reading, limits, quiet=quiet, mask=mask, **chosen)

    jobs.run(work)
