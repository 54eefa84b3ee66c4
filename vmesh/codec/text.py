"""The canonical text of a mesh, the same for every decoder that reads a file right, and back."""

from __future__ import annotations

from collections.abc import Iterator
from typing import BinaryIO, Final, NoReturn

import numpy as np

from vmesh.arrays import Int32Array
from vmesh.color_lattice import ColorLattice
from vmesh.errors import MeshError
from vmesh.limits import DEFAULT_LIMITS, Limits
from vmesh.mesh import Mesh

_FIRST_LINE: Final = "vmesh 1.0"  # the version of the text, not of a file
_MOST_DIGITS: Final = 9  # which 32 bits hold
_LONGEST_QUOTE: Final = 40  # characters of a line in a message


def mesh_text(mesh: Mesh) -> str:
    """The canonical text of a mesh (``spec/conformance/README.md``), in ASCII.

    Parameters
    ----------
    mesh : Mesh
        In canonical order, as :func:`vmesh.loads` returns it.
    """
    return "".join(f"{line}\n" for line in _lines(mesh))


def _lines(mesh: Mesh) -> Iterator[str]:
    yield _FIRST_LINE
    yield f"canvas {mesh.width} {mesh.height}"
    yield f"subdivision {mesh.subdivision}"
    yield f"depth {mesh.lattice.depth}"
    yield " ".join(["steps", *map(str, mesh.lattice.steps)])
    yield f"vertices {mesh.n_vertices}"
    for numbers in np.concatenate([mesh.vertices, mesh.levels], axis=1).tolist():
        yield " ".join(map(str, numbers))
    yield f"triangles {mesh.n_triangles}"
    for numbers in mesh.triangles.tolist():
        yield " ".join(map(str, numbers))


def write_text(mesh: Mesh, stream: BinaryIO, *, limits: Limits = DEFAULT_LIMITS) -> None:
    """Write the canonical text of a mesh, which need not be in canonical order."""
    limits.check_vertices(mesh.n_vertices)
    stream.write(mesh_text(mesh.canonical()).encode("ascii"))


def mesh_from_text(text: str, *, limits: Limits = DEFAULT_LIMITS) -> Mesh:
    """Mesh of a canonical text, equal to the last level; metadata are not in the text.

    Raises
    ------
    MeshError
        If a line is not the one that is expected there.
    ValueError
        If the lines make no mesh that a file may hold.
    LimitError
        If the mesh has more vertices or a larger canvas than `limits` allow.
    """
    lines = _Reader(text)
    lines.expect(_FIRST_LINE)
    width, height = lines.numbers("canvas", 2)
    (subdivision,) = lines.numbers("subdivision", 1)
    (depth,) = lines.numbers("depth", 1)
    lattice = ColorLattice(tuple(lines.numbers("steps")), depth)
    limits.check_pixels(width, height)
    (n_vertices,) = lines.numbers("vertices", 1)
    limits.check_vertices(n_vertices)
    rows = lines.table(n_vertices, 2 + lattice.n_components)
    (n_triangles,) = lines.numbers("triangles", 1)
    triangles = lines.table(n_triangles, 3)
    lines.expect("")
    mesh = Mesh(width, height, rows[:, :2], triangles, rows[:, 2:], lattice, subdivision)
    mesh.check()
    return mesh.canonical()


class _Reader:
    """The lines of a text, one after the other."""

    def __init__(self, text: str) -> None:
        self._lines = text.split("\n")
        self._next = 0

    def expect(self, wanted: str) -> None:
        """Pass a line, which must be the wanted one; the last is empty."""
        if self._take() != wanted:
            self._refuse(f"expected {wanted or 'the end'!r}")

    def numbers(self, keyword: str, count: int = 0) -> list[int]:
        """Numbers of a line that begins with a keyword; exactly `count` of them unless it is 0."""
        first, *words = self._take().split(" ")
        if first != keyword or not words or (count and len(words) != count):
            self._refuse(f"expected {keyword!r} and {count or 'some'} numbers")
        return [self._number(word) for word in words]

    def table(self, n_rows: int, n_columns: int) -> Int32Array:
        """Numbers of the next lines, shape (n_rows, n_columns), int32."""
        rows: list[list[int]] = []
        while len(rows) < n_rows:
            words = self._take().split(" ")
            if len(words) != n_columns:
                self._refuse(f"expected {n_columns} numbers")
            rows.append([self._number(word) for word in words])
        return np.array(rows, dtype=np.int32).reshape(-1, n_columns)

    def _take(self) -> str:
        if self._next == len(self._lines):
            raise MeshError("the text ends too early")
        self._next += 1
        return self._lines[self._next - 1]

    def _number(self, word: str) -> int:
        digits = word.removeprefix("-")
        if not (digits.isascii() and digits.isdecimal() and len(digits) <= _MOST_DIGITS):
            self._refuse(f"expected whole numbers of at most {_MOST_DIGITS} digits")
        return int(word)

    def _refuse(self, wanted: str) -> NoReturn:
        line = self._lines[self._next - 1]
        raise MeshError(f"line {self._next}: {wanted}, got {line[:_LONGEST_QUOTE]!r}")
