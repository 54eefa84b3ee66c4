"""``vmesh info``: what is in a .vmesh file, by its header and, if asked for, by its coded mesh."""

from __future__ import annotations

import json
from typing import Any

import click

from vmesh.cli.jobs import run_inputs
from vmesh.cli.limits import limit_options, take_limits
from vmesh.cli.streams import read_input, tell
from vmesh.codec.summary import describe
from vmesh.errors import FormatError, LimitError, shown
from vmesh.limits import Limits


@click.command("info")
@click.argument("sources", metavar="INPUT.vmesh...", nargs=-1, required=True)
@click.option(
    "--parts",
    "by_parts",
    is_flag=True,
    help="Decode the mesh, to count its triangles and the bytes of its positions and colors.",
)
@click.option("--json", "as_json", is_flag=True, help="Print figures as JSON.")
@limit_options
def command(sources: tuple[str, ...], by_parts: bool, as_json: bool, **options: int) -> None:
    """Say what is in .vmesh files: their size, their mesh, and the bytes of each part.

    Folders are searched for .vmesh files. Of several files each has a heading, or its line of JSON
    a source. What cannot be read is told at the end, and the status is 1.
    """
    limits = take_limits(options)

    def work(source: str, heading: str) -> None:
        figures = figures_of(source, limits, by_parts=by_parts)
        if as_json:
            tell(json.dumps({"source": source} | figures if heading else figures))
        else:
            tell(heading + _table(figures))

    run_inputs(sources, work)


def figures_of(source: str, limits: Limits, *, by_parts: bool) -> dict[str, Any]:
    """Figures of a file; errors name it."""
    try:
        return describe(read_input(source), by_parts, limits)
    except FormatError as error:
        raise FormatError(error.code, f"{shown(source)}: {error.message}", error.offset) from None
    except LimitError as error:
        raise LimitError(f"{shown(source)}: {error}") from None


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
