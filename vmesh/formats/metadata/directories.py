"""The frame of an EXIF block: which bytes belong to which entry.

Pillow reads values, and does not tell where they were. A damaged block may give an entry the bytes
of another.

References
----------
CIPA DC-008-2023 (Exif 3.0), 4.6.2: the structure of directories.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from itertools import pairwise
from typing import Final, NamedTuple

FIRST: Final = 0  # the directory that the block begins with, not known by a tag
DETAILS: Final = 0x8769  # tag of the directory with the camera's entries
PLACE: Final = 0x8825
INTEROPERABILITY: Final = 0xA005  # tag, among the details, of one about the colour space
THUMBNAIL: Final = -1  # the directory after the first

_CHILDREN: Final = (DETAILS, PLACE, INTEROPERABILITY)
_ORDERS: Final = {b"II*\0": "<", b"MM\0*": ">"}
_SIZES: Final = (0, 1, 1, 2, 4, 8, 1, 1, 2, 4, 8, 4, 8, 4)  # bytes of a value, by its type


class Entry(NamedTuple):
    """An entry of a directory, with the bytes that hold its values."""

    directory: int
    tag: int
    start: int
    stop: int


def entries_of(block: bytes) -> list[Entry]:
    """Entries of all directories of an EXIF block.

    Raises
    ------
    ValueError
        If a directory is not whole, is there twice, or its tags do not ascend.
    """
    order = _ORDERS.get(block[:4])
    if order is None:
        raise ValueError("expected the start of a TIFF file")
    found: list[Entry] = []
    left = [(FIRST, *_unpack(order + "I", block, 4))]
    offsets: set[int] = set()
    while left:
        directory, offset = left.pop()
        if offset in offsets:
            raise ValueError("a directory is there twice")
        offsets.add(offset)
        (count,) = _unpack(order + "H", block, offset)
        entries = list(_directory(block, order, directory, offset + 2, count))
        if any(a.tag >= b.tag for a, b in pairwise(entries)):
            raise ValueError("the tags of a directory do not ascend")
        found += entries
        left += [
            (entry.tag, *_unpack(order + "I", block, entry.start))
            for entry in entries
            if entry.tag in _CHILDREN and directory in (FIRST, DETAILS)
        ]
        if directory == FIRST:
            # Some programs leave out the offset of the next one.
            (following,) = struct.unpack(
                order + "I", block[offset + 2 + 12 * count :][:4].ljust(4, b"\0")
            )
            left += [(THUMBNAIL, following)] if following else []
    return found


def _directory(block: bytes, order: str, directory: int, first: int, count: int) -> Iterator[Entry]:
    """Entries of a directory whose first one is at an offset."""
    for place in range(first, first + 12 * count, 12):
        tag, kind, n_values = _unpack(order + "HHI", block, place)
        size = n_values * (_SIZES[kind] if kind < len(_SIZES) else 1)
        (start,) = _unpack(order + "I", block, place + 8) if size > 4 else (place + 8,)
        yield Entry(directory, tag, start, start + size)


def _unpack(form: str, block: bytes, offset: int) -> tuple[int, ...]:
    try:
        return struct.unpack_from(form, block, offset)
    except struct.error:
        raise ValueError("a directory is not whole") from None
