"""Figures of a ``.vmesh`` file: those of its header, and the bytes of each part."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Final

from vmesh.codec import layout
from vmesh.codec.container import read_file
from vmesh.codec.layout import Chunk
from vmesh.codec.metadata import inflate
from vmesh.codec.policy import Strict
from vmesh.codec.profile_name import profile_name
from vmesh.errors import FormatError, LimitError
from vmesh.limits import Limits

_UNNAMED: Final = "unnamed"


def describe(data: bytes, by_parts: bool, limits: Limits) -> dict[str, Any]:
    """Figures of a file whose frame and header are sound; its mesh is decoded only for its parts.

    The bytes of all parts add up to the file. What belongs to no chunk's content, such as header,
    tags and checksums, is the frame.
    """
    container = read_file(data, Strict())
    header = container.header
    figures: dict[str, Any] = {
        "version": layout.version_name(data[len(layout.SIGNATURE)]),
        "width": header.width,
        "height": header.height,
        "components": layout.COMPONENT_NAMES[header.n_components],
        "depth": header.depth,
        "color_steps": list(header.steps),
        "subdivision": header.subdivision,
        "vertices": header.n_vertices,
        "connectivity": layout.CONNECTIVITY_NAMES[header.connectivity],
        "tiles": None
        if container.grid is None
        else {
            "side": container.grid.side,
            "columns": container.grid.columns,
            "rows": container.grid.rows,
        },
        "bytes": len(data),
        "bits_per_vertex": round(8 * len(data) / header.n_vertices, 3),
    }
    ancillary = [
        (layout.CHUNK_NAMES.get(chunk.tag, chunk.tag.decode()), len(chunk.content))
        for chunk in container.ancillary
    ]
    figures["profile"] = _profile_of(container.ancillary, limits)
    figures["metadata"] = [name for name, _ in ancillary]
    coded = [("mesh", sum(len(chunk.content) for _, chunk in container.found))]
    if by_parts:
        from vmesh.codec.reader import read

        reading = read(data, limits=limits)
        figures["triangles"] = reading.mesh.n_triangles
        coded = list(reading.sizes.items())
    parts = [*ancillary, *coded]
    parts.insert(0, ("frame", len(data) - sum(size for _, size in parts)))
    figures["parts"] = [
        {
            "part": name,
            "bytes": size,
            "bits_per_vertex": round(8 * size / header.n_vertices, 3),
        }
        for name, size in parts
    ]
    return figures


def _profile_of(chunks: Iterable[Chunk], limits: Limits) -> str | None:
    """Name of the ICC profile among the chunks of a file, none if there is no profile."""
    for chunk in chunks:
        if chunk.tag == layout.METADATA_TAGS["icc"]:
            try:
                return profile_name(inflate(chunk, limits)) or _UNNAMED
            except (FormatError, LimitError):  # the figures of the mesh are as good as ever
                return _UNNAMED
    return None
