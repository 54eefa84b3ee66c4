"""Binary PLY files with faces of several numbers of corners, which trimesh does not read.

Their faces are replaced by fans of triangles; what else is said of faces, or comes after them, is
left out::

    header  vertices ...  face: n, n indices, others   face: ...  other elements
    header  vertices ...  face: 3, 3 indices           face: ...

References
----------
G. Turk, "The PLY Polygon File Format", Stanford University, 1994.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from typing import Final, NamedTuple

from vmesh.errors import MeshError

_ORDERS: Final = {"binary_little_endian": "<", "binary_big_endian": ">"}
# Letters of struct for the names of types.
_TYPES: Final = {
    name: letter
    for names, letter in {
        "char int8": "b",
        "uchar uint8": "B",
        "short int16": "h",
        "ushort uint16": "H",
        "int int32": "i",
        "uint uint32": "I",
        "float float32": "f",
        "double float64": "d",
    }.items()
    for name in names.split()
}
_INDICES: Final = ("vertex_index", "vertex_indices")
_END: Final = b"end_header"


class _Property(NamedTuple):
    """A property of an element: a value, or a list if its count has a type."""

    name: str
    letter: str
    count_letter: str = ""


class _Element(NamedTuple):
    """An element of a file, and which line of the header begins it."""

    name: str
    n_rows: int
    line: int
    properties: list[_Property]


def with_triangles(data: bytes) -> bytes:
    """A PLY file whose faces are triangles, if it is binary and its faces differ; else as it is.

    Raises
    ------
    MeshError
        If the faces are not where the header says.
    """
    end = data.find(b"\n", data.find(_END)) + 1
    lines = data[:end].decode("latin-1").splitlines()
    order = _ORDERS.get((lines[1:2] or [""])[0].removeprefix("format ").split(" ")[0])
    elements = _elements(lines)
    n_before = next((i for i, each in enumerate(elements) if each.name == "face"), None)
    if order is None or n_before is None:
        return data
    start = end
    for element in elements[:n_before]:
        if any(each.count_letter for each in element.properties):
            return data
        letters = "".join(each.letter for each in element.properties)
        start += element.n_rows * struct.calcsize(order + letters)
    face = elements[n_before]
    if not any(each.count_letter and each.name in _INDICES for each in face.properties):
        return data
    try:
        polygons = list(_polygons(data, start, order, face))
    except struct.error:
        raise MeshError(
            "the PLY file is damaged: its faces are not where its header says"
        ) from None
    if len(set(map(len, polygons))) == 1:
        return data
    row = struct.Struct(f"{order}B3i")
    fans = [row.pack(3, p[0], *p[i : i + 2]) for p in polygons for i in range(1, len(p) - 1)]
    header = [
        *lines[: face.line],
        f"element face {len(fans)}",
        "property list uchar int vertex_indices",
        _END.decode(),
        "",
    ]
    return "\n".join(header).encode("latin-1") + data[end:start] + b"".join(fans)


def _elements(lines: list[str]) -> list[_Element]:
    """Elements of a header, up to what makes no sense."""
    elements: list[_Element] = []
    for i, line in enumerate(lines):
        match line.split():
            case ["element", name, count] if count.isdecimal():
                elements.append(_Element(name, int(count), i, []))
            case ["property", kind, name] if kind in _TYPES and elements:
                elements[-1].properties.append(_Property(name, _TYPES[kind]))
            case ["property", "list", count, kind, name] if {count, kind} <= _TYPES.keys():
                if elements:
                    each = _Property(name, _TYPES[kind], _TYPES[count])
                    elements[-1].properties.append(each)
            case ["element" | "property", *_]:
                return []
    return elements


def _polygons(data: bytes, start: int, order: str, face: _Element) -> Iterator[tuple[int, ...]]:
    """Indices of the corners of each face."""
    place = start
    for _ in range(face.n_rows):
        polygon: tuple[int, ...] = ()
        for name, letter, count_letter in face.properties:
            count = 1
            if count_letter:
                (count,) = struct.unpack_from(order + count_letter, data, place)
                place += struct.calcsize(order + count_letter)
            values = f"{order}{count}{letter}"
            if name in _INDICES:
                polygon = struct.unpack_from(values, data, place)
            place += struct.calcsize(values)
        yield polygon
