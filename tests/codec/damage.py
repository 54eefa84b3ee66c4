"""Files taken apart and put together again, with checksums that fit."""

from __future__ import annotations

import zlib
from collections.abc import Iterable

import numpy as np

Content = tuple[bytes, bytes]

SIGNATURE = b"\x8bVM\r\n"
# The fields of a header of samples of 8 bits, in order; a number for each step follows them.
HEADER_FIELDS = ("version", "format", "width", "height", "n_vertices")
# First bit and number of bits of the fields that share the byte `format`.
FORMAT_FIELDS = {"components": (0, 2), "subdivision": (2, 4), "connectivity": (6, 2)}


def varint(number: int) -> bytes:
    """A number of 0 or more in groups of seven bits, in the shortest form."""
    groups = [number >> shift & 127 for shift in range(0, max(number.bit_length(), 1), 7)]
    return bytes([*(group | 128 for group in groups[:-1]), groups[-1]])


def padded(number: int) -> bytes:
    """A number as a varint that is a byte longer than it need be."""
    short = varint(number)
    return bytes([*short[:-1], short[-1] | 128, 0])


def split_varint(data: bytes, offset: int) -> tuple[int, int]:
    """A number, and the offset after it."""
    end = offset
    while data[end] & 128:
        end += 1
    return sum((data[i] & 127) << 7 * (i - offset) for i in range(offset, end + 1)), end + 1


def checked(data: bytes) -> bytes:
    """Bytes and their checksum."""
    return data + zlib.crc32(data).to_bytes(4, "little")


def split(data: bytes) -> tuple[bytes, list[Content]]:
    """The header of a file without signature and checksum, and its chunks, without any check."""
    offset = len(SIGNATURE) + 2
    components = data[offset - 1] & 3
    if components == 1:
        components = data[offset] & 3
        offset += 1
    for _ in range(3 + components + 1):
        _, offset = split_varint(data, offset)
    header = data[len(SIGNATURE) : offset]
    offset += 4
    contents = []
    while offset < len(data):
        tag = data[offset : offset + 1]
        length, start = split_varint(data, offset + 1)
        contents.append((tag, data[start : start + length]))
        offset = start + length + 4
    return header, contents


def chunk_of(tag: bytes, content: bytes) -> bytes:
    """A chunk, whatever it is, with the right checksum."""
    return checked(tag + varint(len(content)) + content)


def file_of(header: bytes, contents: Iterable[Content], signature: bytes = SIGNATURE) -> bytes:
    """A file of a header and chunks, whatever they are, with the right checksums."""
    chunks = b"".join(chunk_of(tag, content) for tag, content in contents)
    return checked(signature + header) + chunks


def with_content(data: bytes, tag: bytes, content: bytes) -> bytes:
    """The file with the content of one chunk replaced."""
    header, contents = split(data)
    return file_of(header, [(t, content if t == tag else c) for t, c in contents])


def split_header(data: bytes) -> tuple[dict[str, int], bytes]:
    """Fields of the header of a file by name, and the bytes of its steps."""
    header, _ = split(data)
    values, offset = [header[0], header[1]], 2
    for _ in range(3):
        value, offset = split_varint(header, offset)
        values.append(value)
    fields = dict(zip(HEADER_FIELDS, values, strict=True))
    for name, (first, size) in FORMAT_FIELDS.items():
        fields[name] = fields["format"] >> first & (1 << size) - 1
    return fields, header[offset:]


def header_fields(data: bytes) -> dict[str, int]:
    """Fields of the header of a file by name, its steps left out."""
    return split_header(data)[0]


def with_header(data: bytes, steps: bytes | None = None, /, **values: int) -> bytes:
    """The file with its steps or fields of its header replaced."""
    _, contents = split(data)
    own_fields, own_steps = split_header(data)
    fields = {**own_fields, **values}
    if "format" not in values:
        fields["format"] = sum(fields[name] << first for name, (first, _) in FORMAT_FIELDS.items())
    numbers = b"".join(varint(fields[name]) for name in HEADER_FIELDS[2:])
    changed = bytes([fields["version"], fields["format"]]) + numbers
    return file_of(changed + (own_steps if steps is None else steps), contents)


def mutant(data: bytes, random: np.random.Generator) -> bytes:
    """The file with a few random changes of its header and contents, the checksums repaired."""
    header, contents = split(data)
    blocks = [(b"", header), *contents]
    for _ in range(random.integers(1, 4)):
        # The mesh is the last block, and has most to go wrong in.
        at = int(random.integers(len(blocks))) if random.integers(2) else len(blocks) - 1
        tag, content = blocks[at]
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
        elif random.integers(8) == 0 and at > 0:
            blocks.insert(at, blocks[int(random.integers(1, len(blocks)))])
            continue
        blocks[at] = (tag, bytes(changed))
    return file_of(blocks[0][1], blocks[1:])
