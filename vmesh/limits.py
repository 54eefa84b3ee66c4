"""What the format allows a mesh to be, and what a caller allows a file or a request to cost."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from vmesh.errors import LimitError

MAX_SIDE: Final = 65_535
MAX_SUBDIVISION: Final = 8
# With sides of at most 2**19 lattice units the in-circle test is exact in two 64-bit words.
MAX_LATTICE_SIDE: Final = 1 << 19


@dataclass(frozen=True, slots=True)
class Limits:
    """Upper bounds that are checked before anything is allocated.

    Parameters
    ----------
    max_pixels : int
        Pixels of a canvas, of a photograph and of a raster that is asked for.
    max_vertices : int
        Vertices of a mesh.
    max_metadata : int
        Bytes of all metadata together, after inflation.
    max_work : int
        Rows of all triangles plus pixels that one rendering may visit.
    """

    max_pixels: int = 1 << 28
    max_vertices: int = 1 << 22
    max_metadata: int = 1 << 24
    max_work: int = 1 << 31

    def check_pixels(self, width: int, height: int) -> None:
        """Raise :class:`LimitError` if a raster of this size is not allowed."""
        if width * height > self.max_pixels:
            raise LimitError(
                f"a raster of {width} x {height} pixels was asked for, "
                f"but the limit is {self.max_pixels} pixels"
            )

    def check_vertices(self, n_vertices: int) -> None:
        """Raise :class:`LimitError` if a mesh of this many vertices is not allowed."""
        if n_vertices > self.max_vertices:
            raise LimitError(
                f"the mesh has {n_vertices} vertices, but the limit is {self.max_vertices}"
            )

    def check_metadata(self, n_bytes: int) -> None:
        """Raise :class:`LimitError` if this many bytes of metadata are not allowed."""
        if n_bytes > self.max_metadata:
            raise LimitError(
                f"the metadata inflate to more than the limit of {self.max_metadata} bytes"
            )

    def check_work(self, work: int) -> None:
        """Raise :class:`LimitError` if a rendering may not visit this much."""
        if work > self.max_work:
            raise LimitError(
                f"rendering would visit {work} rows and pixels, but the limit is {self.max_work}"
            )


DEFAULT_LIMITS = Limits()
