"""Files taken apart and put together again, with checksums that fit."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterable

import numpy as np

Content = tuple[bytes, bytes]

SIGNATURE_SIZE = 8
# Width and place in HEAD of every field of a fixed size.
HEADER_FIELDS = {
    "major": (0, "<B"),
    "minor": (1, "<B"),
    "width": (2, "<H"),
    "height": (4, "<H"),
    "subdivision": (6, "<B"),
    "n_components": (7, "<B"),
    "n_vertices": (8, "<I"),
    "n_triangles": (12, "<I"),
    "connectivity": (16, "<B"),
}
STEPS_OFFSET = 17


def contents_of(data: bytes) -> list[Content]:
    """Tag and content of every chunk, without any check."""
    contents = []
    offset = SIGNATURE_SIZE
    while offset < len(data):
        tag, length = struct.unpack_from("<4sI", data, offset)
        contents.append((tag, data[offset + 8 : offset + 8 + length]))
        offset += 12 + length
    return contents


def file_of(contents: Iterable[Content], signature: bytes = b"\x8bVMS\r\n\x1a\n") -> bytes:
    """A file of chunks, whatever they are, with the right checksums."""
    data = signature
    for tag, content in contents:
        framed = tag + struct.pack("<I", len(content)) + content
        data += framed + struct.pack("<I", zlib.crc32(framed))
    return data


def with_content(data: bytes, tag: bytes, content: bytes) -> bytes:
    """The file with the content of one chunk replaced."""
    return file_of((t, content if t == tag else c) for t, c in contents_of(data))


def with_header(data: bytes, **values: int) -> bytes:
    """The file with fields of its header replaced."""
    header = bytearray(dict(contents_of(data))[b"HEAD"])
    for name, value in values.items():
        offset, code = HEADER_FIELDS[name]
        struct.pack_into(code, header, offset, value)
    return with_content(data, b"HEAD", bytes(header))


def mutant(data: bytes, random: np.random.Generator) -> bytes:
    """The file with a few random changes of its contents, and the checksums repaired."""
    contents = contents_of(data)
    for _ in range(random.integers(1, 4)):
        at = int(random.integers(len(contents)))
        tag, content = contents[at]
        changed = bytearray(content)
        place = int(random.integers(len(changed) + 1))
        action = random.integers(8)
        if action < 3 and place < len(changed):
            changed[place] ^= 1 << int(random.integers(8))
        elif action < 5 and place < len(changed):
            changed[place] = int(random.choice([0, 1, 2, 127, 128, 254, 255]))
        elif action == 5:
            changed[place:place] = random.bytes(int(random.integers(1, 5)))
        elif action == 6:
            del changed[place : place + int(random.integers(1, 5))]
        elif random.integers(8) == 0:
            contents.insert(at, contents[int(random.integers(len(contents)))])
            continue
        contents[at] = (tag, bytes(changed))
    return file_of(contents)
