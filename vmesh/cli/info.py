"""``vmesh info``: what is in a .vmesh file, by its header and, if asked for, by its coded mesh."""

from __future__ import annotations

import json
from typing import Any, Final

import click

from vmesh.cli.limits import limit_options, take_limits
from vmesh.cli.streams import read_input
from vmesh.codec.summary import describe
from vmesh.errors import FormatError, LimitError

_METADATA: Final = {"exif": "EXIF", "xmp": "XMP"}


@click.command("info")
@click.argument("source", metavar="INPUT.vmesh")
@click.option(
    "--parts",
    "by_parts",
    is_flag=True,
    help="Decode the mesh, to count its triangles and the bytes of its positions and colors.",
)
@click.option("--json", "as_json", is_flag=True, help="Print figures as JSON.")
@limit_options
def command(source: str, by_parts: bool, as_json: bool, **options: int) -> None:
    """Say what is in a .vmesh file: its size, its mesh, and the bytes of each part."""
    data, limits = read_input(source), take_limits(options)
    try:
        figures = describe(data, by_parts, limits)
    except FormatError as error:
        raise FormatError(error.code, f"{source}: {error.message}", error.offset) from None
    except LimitError as error:
        raise LimitError(f"{source}: {error}") from None
    click.echo(json.dumps(figures) if as_json else _table(figures))


def _table(figures: dict[str, Any]) -> str:
    """The figures as lines for people."""
    density = figures["vertices"] / (figures["width"] * figures["height"])
    triangles = f"{figures['triangles']} triangles" if "triangles" in figures else "triangles"
    lines = [
        f"{figures['width']} x {figures['height']} pixels, {figures['components']} "
        f"of {figures['depth']} bits, "
        f".vmesh {figures['version']}",
        f"{figures['vertices']} vertices ({density:.2%} of the pixels) "
        f"on 1/{1 << figures['subdivision']} pixel, {figures['connectivity']} {triangles}",
        f"colour steps {', '.join(map(str, figures['color_steps']))}",
        *_tiles(figures["tiles"]),
        *_metadata(figures),
        f"{figures['bytes']} bytes, {figures['bits_per_vertex']:.2f} bits per vertex",
        "",
        "part           bytes  bits per vertex",
    ]
    lines += [
        f"{part['part']:9}  {part['bytes']:9}  {part['bits_per_vertex']:15.2f}"
        for part in figures["parts"]
    ]
    return "\n".join(lines)


def _tiles(tiles: dict[str, int] | None) -> list[str]:
    """The line about tiles, if there are any."""
    if tiles is None:
        return []
    return [f"{tiles['columns']} x {tiles['rows']} tiles of {tiles['side']} pixels"]


def _metadata(figures: dict[str, Any]) -> list[str]:
    """The lines about the colours' space, and about further metadata, if there are any."""
    others = [_METADATA.get(name, f"chunk {name}") for name in figures["metadata"] if name != "icc"]
    lines = [] if figures["profile"] is None else [f"ICC profile {figures['profile']}"]
    return [*lines, f"metadata {', '.join(others)}"] if others else lines
