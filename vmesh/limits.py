"""Limits of the format on a mesh, and of a caller on the cost of a file or a request."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from vmesh.errors import LimitError

MAX_SIDE: Final = 65_535
MAX_SUBDIVISION: Final = 8
PLAIN_DEPTH: Final = 8  # bits of a sample where nothing else is said
MAX_DEPTH: Final = 16
# With sides of at most 2**19 lattice units the in-circle test is exact in two 64-bit words.
MAX_LATTICE_SIDE: Final = 1 << 19
MAX_TILE_SIDE: Final = 1 << 12  # lattice units

# So many vertices are read from a file of any length: it takes a fifth of a second.
FREE_VERTICES: Final = 1 << 16


@dataclass(frozen=True, slots=True)
class Limits:
    """Upper bounds that are checked before anything is allocated.

    Parameters
    ----------
    max_pixels : int
        Pixels of a canvas, of a photograph and of a raster that is asked for.
    max_vertices : int
        Vertices of a mesh; those that tiles share count for each.
    max_tiles : int
        Tiles of a mesh.
    max_vertices_per_byte : int
        Vertices for each byte of the coded mesh, beyond the first 65,536 vertices: a million that
        agree in everything fit 200 bytes. Photographs take a byte or two for each vertex.
    max_metadata : int
        Bytes of all metadata together, after inflation.
    max_work : int
        Rows of all triangles plus pixels that one rendering may visit.
    max_rows : int
        Rows of all triangles that one rendering may visit, beyond one for each of its pixels:
        slivers that span the canvas make them many where pixels are few.
    """

    max_pixels: int = 1 << 28
    max_vertices: int = 1 << 22
    max_tiles: int = 1 << 11
    max_vertices_per_byte: int = 8
    max_metadata: int = 1 << 24
    max_work: int = 1 << 31
    max_rows: int = 1 << 26

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

    def check_tiles(self, n_tiles: int) -> None:
        """Raise :class:`LimitError` if a mesh of this many tiles is not allowed."""
        if n_tiles > self.max_tiles:
            raise LimitError(f"the mesh has {n_tiles} tiles, but the limit is {self.max_tiles}")

    def check_density(self, n_vertices: int, n_bytes: int) -> None:
        """Raise :class:`LimitError` if so few bytes may not hold this many vertices."""
        if n_vertices > FREE_VERTICES + self.max_vertices_per_byte * n_bytes:
            raise LimitError(
                f"the mesh has {n_vertices} vertices in {n_bytes} bytes, but the limit is "
                f"{self.max_vertices_per_byte} vertices per byte beyond the first {FREE_VERTICES}"
            )

    def check_metadata(self, n_bytes: int) -> None:
        """Raise :class:`LimitError` if this many bytes of metadata are not allowed."""
        if n_bytes > self.max_metadata:
            raise LimitError(
                f"the metadata inflate to more than the limit of {self.max_metadata} bytes"
            )

    def check_work(self, n_rows: int, n_pixels: int) -> None:
        """Raise :class:`LimitError` if a rendering may not visit this much."""
        if n_rows + n_pixels > self.max_work:
            raise LimitError(
                f"rendering would visit {n_rows + n_pixels} rows and pixels, "
                f"but the limit is {self.max_work}"
            )
        if n_rows > self.max_rows + n_pixels:
            raise LimitError(
                f"rendering {n_pixels} pixels would visit {n_rows} rows of triangles, "
                f"but the limit is {self.max_rows} more than the pixels"
            )


DEFAULT_LIMITS = Limits()
