"""``vmesh info``: what is in a .vmesh file, without decoding it."""

from __future__ import annotations

import json
from typing import Any

import click

from vmesh.cli.streams import read_input
from vmesh.codec import layout
from vmesh.errors import FormatError


@click.command("info")
@click.argument("source", metavar="INPUT.vmesh")
@click.option("--json", "as_json", is_flag=True, help="Print figures as JSON.")
def command(source: str, as_json: bool) -> None:
    """Say what is in a .vmesh file: its size, its mesh, and the bytes of each part."""
    data = read_input(source)
    try:
        figures = describe(data)
    except FormatError as error:
        raise FormatError(error.code, f"{source}: {error.message}", error.offset) from None
    click.echo(json.dumps(figures) if as_json else _table(figures))


def describe(data: bytes) -> dict[str, Any]:
    """Figures of a file whose frame and header are sound; its payloads are not decoded."""
    chunks = layout.read_chunks(data)
    header = layout.read_header(chunks)
    implied = header.connectivity == layout.IMPLIED_TRIANGLES
    return {
        "version": f"{header.major}.{header.minor}",
        "width": header.width,
        "height": header.height,
        "components": {1: "grey", 3: "RGB", 4: "RGBA"}[header.n_components],
        "color_steps": list(header.steps),
        "subdivision": header.subdivision,
        "vertices": header.n_vertices,
        "triangles": header.n_triangles,
        "connectivity": "implied" if implied else "listed",
        "bytes": len(data),
        "bits_per_vertex": round(8 * len(data) / header.n_vertices, 3),
        "parts": [
            {
                "tag": chunk.tag.decode(),
                "offset": chunk.offset,
                "bytes": chunk.size,
                "bits_per_vertex": round(8 * chunk.size / header.n_vertices, 3),
            }
            for chunk in chunks
        ],
    }


def _table(figures: dict[str, Any]) -> str:
    """The figures as lines for people."""
    density = figures["vertices"] / (figures["width"] * figures["height"])
    lines = [
        f"{figures['width']} x {figures['height']} pixels, {figures['components']}, "
        f".vmesh {figures['version']}",
        f"{figures['vertices']} vertices ({density:.2%} of the pixels), "
        f"{figures['triangles']} triangles, {figures['connectivity']}",
        f"{figures['bytes']} bytes, {figures['bits_per_vertex']:.2f} bits per vertex",
        "",
        "part      bytes  bits per vertex",
    ]
    lines += [
        f"{part['tag']}  {part['bytes']:9}  {part['bits_per_vertex']:15.2f}"
        for part in figures["parts"]
    ]
    return "\n".join(lines)
