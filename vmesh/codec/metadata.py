"""Chunks beside the mesh -> Metadata (spec, section 9); needs no compiled code."""

from __future__ import annotations

import zlib

from vmesh.codec import layout
from vmesh.codec.layout import Chunk
from vmesh.codec.policy import Policy
from vmesh.errors import FormatError
from vmesh.limits import Limits
from vmesh.mesh import Metadata


def read_metadata(chunks: list[Chunk], limits: Limits, policy: Policy) -> Metadata:
    """ICC profile, EXIF, XMP and the ancillary chunks that are not known.

    Parameters
    ----------
    chunks : list of Chunk
        All but the mesh.
    limits : Limits
        How far the chunks may inflate.
    policy : Policy
        Told of chunks that are damaged.

    Raises
    ------
    LimitError
        If they inflate to more than `limits` allow.
    """
    names = {tag: name for name, tag in layout.METADATA_TAGS.items()}
    known: dict[str, bytes] = {}
    unknown = []
    total = 0
    for chunk in chunks:
        if chunk.tag in names:
            try:
                known[names[chunk.tag]] = block = inflate(chunk, limits)
            except FormatError as error:
                policy.complain(error)
                continue
            total += len(block)
        else:
            unknown.append((chunk.tag, chunk.content))
            total += len(chunk.content)
        limits.check_metadata(total)
    return Metadata(**known, unknown=tuple(unknown))


def inflate(chunk: Chunk, limits: Limits) -> bytes:
    """Content of a known metadata chunk, inflated to no more than the limit."""
    inflater = zlib.decompressobj()
    try:
        block = inflater.decompress(chunk.content, limits.max_metadata + 1)
    except zlib.error as error:
        raise FormatError("metadata", f"zlib: {error}", chunk.content_offset) from None
    limits.check_metadata(len(block))
    if not inflater.eof or inflater.unused_data or not block:
        raise FormatError(
            "metadata", "expected one complete zlib stream with content", chunk.content_offset
        )
    return block
