"""``vmesh dump``: the bytes of a .vmesh file with their meaning, or its mesh as text."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import click

from vmesh.cli.jobs import run_inputs
from vmesh.cli.limits import limit_options, take_limits
from vmesh.cli.streams import read_input, read_mesh, tell
from vmesh.codec.hex_dump import Field, annotate

_BYTES_PER_LINE: Final = 16


@click.command("dump")
@click.argument("sources", metavar="INPUT.vmesh...", nargs=-1, required=True)
@click.option(
    "--mesh",
    "as_mesh",
    is_flag=True,
    help="Decode the mesh and print it as text: canvas, vertices with their levels, triangles.",
)
@click.option(
    "--bytes",
    "n_bytes",
    type=click.IntRange(min=1),
    default=64,
    show_default=True,
    help="Most bytes to print of each field.",
)
@limit_options
def command(sources: tuple[str, ...], as_mesh: bool, n_bytes: int, **options: int) -> None:
    """Print the bytes of .vmesh files, field by field, also if they are damaged.

    Folders are searched for .vmesh files. Of several files each has a heading.
    """
    limits = take_limits(options)

    def work(source: str, heading: str) -> None:
        if as_mesh:
            from vmesh.codec.text import mesh_text

            tell(heading + mesh_text(read_mesh(source, limits)), is_line=False)
            return
        tell(heading, is_line=False)
        for field in annotate(read_input(source)):
            for line in _lines(field, n_bytes):
                tell(line)

    run_inputs(sources, work)


def _lines(field: Field, n_bytes: int) -> Iterator[str]:
    """Offset, bytes and meaning; the meaning stands on the first line."""
    shown = field.data[:n_bytes]
    meaning = field.meaning
    for start in range(0, max(len(shown), 1), _BYTES_PER_LINE):
        pairs = shown[start : start + _BYTES_PER_LINE].hex(" ")
        yield f"{field.offset + start:08x}  {pairs:{3 * _BYTES_PER_LINE}} # {meaning}".rstrip(" #")
        meaning = ""
    if len(field.data) > n_bytes:
        yield f"{'':10}... {len(field.data) - n_bytes} more bytes"
