"""``vmesh encode``: a photograph -> a .vmesh file."""

from __future__ import annotations

import json
import time
from typing import Any

import click

from vmesh.cli.limits import limit_options, take_limits
from vmesh.cli.options import (
    encoder_options,
    json_option,
    picture_options,
    quiet_option,
    strip_option,
    take_picture_options,
    take_settings,
)
from vmesh.cli.progress import show_progress
from vmesh.cli.streams import STANDARD, check_suffix, read_photograph, write_output
from vmesh.codec.layout import FILE_SUFFIX
from vmesh.formats.metadata.privacy import Strip


@click.command("encode")
@click.argument("source", metavar="INPUT")
@click.argument("target", metavar="OUTPUT.vmesh")
@picture_options
@strip_option("none")
@encoder_options
@limit_options
@json_option
@quiet_option
def command(
    source: str, target: str, strip: Strip | None, as_json: bool, quiet: bool, **options: Any
) -> None:
    """Turn a photograph into a .vmesh file."""
    settings, limits = take_settings(options), take_limits(options)
    reading = take_picture_options(options)
    check_suffix(target, (FILE_SUFFIX,))
    if as_json and target == STANDARD:
        raise click.UsageError("--json and the file cannot both go to standard output")
    from vmesh.codec.writer import dumps
    from vmesh.encoder.pipeline import count_steps, encode_with
    from vmesh.formats.metadata.privacy import stripped

    started = time.perf_counter()
    with show_progress("encoding", count_steps(settings) + 2, quiet=quiet) as report:
        report("reading")
        picture = read_photograph(source, reading, limits)
        metadata = stripped(picture.metadata, strip or "none")
        mesh = encode_with(picture.array, settings, metadata=metadata, progress=report)
        limits.check_vertices(mesh.n_vertices)
        report("writing")
        data = dumps(mesh)
        write_output(target, lambda stream: stream.write(data))
    if as_json:
        figures = {
            "width": mesh.width,
            "height": mesh.height,
            "vertices": mesh.n_vertices,
            "triangles": mesh.n_triangles,
            "bytes": len(data),
            "bits_per_vertex": round(8 * len(data) / mesh.n_vertices, 3),
            "seconds": round(time.perf_counter() - started, 3),
        }
        click.echo(json.dumps(figures))
