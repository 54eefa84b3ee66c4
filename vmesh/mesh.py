"""The mesh: integer vertices on a lattice, a colour level at each, triangles that cover a canvas.

::

    (0, 0) ---- x ---->  (width, 0)         pixels; a pixel's centre is at +1/2, +1/2
      |    .       .                        vertices are multiples of 1 / 2**subdivision pixel
      y       .                             triangles turn from x towards y: clockwise on a
      v   .        .                        screen, a positive cross product in these axes
    (0, height)          (width, height)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, fields
from importlib import import_module
from operator import index
from types import ModuleType
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from vmesh.arrays import Float64Array, Int32Array, Int64Array, SampleArray, UInt8Array
from vmesh.color_lattice import ColorLattice, rescale
from vmesh.limits import (
    MAX_LATTICE_SIDE,
    MAX_SIDE,
    MAX_SUBDIVISION,
    MAX_TILE_SIDE,
    PLAIN_DEPTH,
)

_LARGEST_ENTRY: Final = 1e9

Matrix = Sequence[float]
"""An affine map ``(a, b, c, d, e, f)`` in SVG's order: x' = a x + c y + e, y' = b x + d y + f."""


@dataclass(frozen=True, slots=True)
class Metadata:
    """What travels with a picture beside its pixels.

    Parameters
    ----------
    icc, exif, xmp : bytes
        ICC profile, EXIF block from its TIFF header on (its orientation already applied to the
        picture) and XMP packet, empty if there is none.
    unknown : tuple of (bytes, bytes)
        Tag and content of ancillary chunks that this version does not know: kept as they are.
    """

    icc: bytes = b""
    exif: bytes = b""
    xmp: bytes = b""
    unknown: tuple[tuple[bytes, bytes], ...] = ()


def _frozen(array: npt.ArrayLike, dtype: npt.DTypeLike, name: str) -> npt.NDArray[np.integer]:
    """Read-only contiguous copy of a two-dimensional integer array."""
    given = np.asarray(array)
    if given.ndim != 2 or given.dtype.kind not in "iu":
        raise ValueError(
            f"expected {name} as a two-dimensional integer array, "
            f"got shape {given.shape} of {given.dtype}"
        )
    limits = np.iinfo(dtype)
    if given.size and (int(given.min()) < limits.min or int(given.max()) > limits.max):
        raise ValueError(f"{name} do not fit {np.dtype(dtype)}")
    copy: npt.NDArray[np.integer] = np.array(given, dtype=dtype, order="C")
    copy.flags.writeable = False
    return copy


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """A picture as a triangle mesh with a colour at every vertex.

    Parameters
    ----------
    width, height : int
        Size of the canvas in pixels, 1 to 65,535.
    vertices : ndarray
        Shape (n, 2), int32: x right, y down, in lattice units from the top left corner.
    triangles : ndarray
        Shape (m, 3), int32: indices into `vertices`, positively oriented.
    levels : ndarray
        Shape (n, c), int32: colour levels on `lattice`; `colors` gives them as samples.
    lattice : ColorLattice
        Steps of the colour components.
    subdivision : int
        A pixel is 2**subdivision lattice units wide, 0 to 8.
    metadata : Metadata
        ICC profile, EXIF and XMP.
    tile : int, optional
        Side in pixels of the tiles that a file of the mesh is made of, up to 4096 lattice units;
        no triangle crosses the lines between them. Without it a file holds the mesh as one.
    """

    width: int
    height: int
    vertices: Int32Array
    triangles: Int32Array
    levels: Int32Array
    lattice: ColorLattice
    subdivision: int = 0
    metadata: Metadata = field(default_factory=Metadata)
    tile: int | None = None

    def __post_init__(self) -> None:
        for name in ("width", "height", "subdivision"):
            object.__setattr__(self, name, index(getattr(self, name)))
        if self.tile is not None:
            object.__setattr__(self, "tile", index(self.tile))
        for name in ("vertices", "triangles", "levels"):
            object.__setattr__(self, name, _frozen(getattr(self, name), np.int32, name))
        self._check_header()
        self._check_arrays()

    @classmethod
    def from_colors(
        cls,
        width: int,
        height: int,
        vertices: npt.ArrayLike,
        triangles: npt.ArrayLike,
        colors: npt.ArrayLike,
        *,
        step: int = 1,
        depth: int = PLAIN_DEPTH,
        subdivision: int = 0,
        metadata: Metadata | None = None,
    ) -> Mesh:
        """Mesh with vertex colours rounded to a lattice of the given luma step.

        Parameters
        ----------
        colors : array_like
            Shape (n, 1), (n, 3) or (n, 4), samples of `depth` bits; kept exactly where `step` is 1.
        depth : int
            Bits of a sample, 8 to 16.
        """
        samples = np.asarray(colors)
        if samples.ndim != 2:
            raise ValueError(f"expected colours of shape (n, c), got {samples.shape}")
        lattice = ColorLattice.uniform(samples.shape[1], step, depth)
        return cls(
            width,
            height,
            np.asarray(vertices),
            np.asarray(triangles),
            lattice.levels_from_colors(samples),
            lattice,
            subdivision,
            metadata or Metadata(),
        )

    @property
    def n_vertices(self) -> int:
        """Number of vertices."""
        return int(self.vertices.shape[0])

    @property
    def n_triangles(self) -> int:
        """Number of triangles."""
        return int(self.triangles.shape[0])

    @property
    def n_components(self) -> int:
        """Number of colour components: 1 grey, 3 RGB, 4 RGB and alpha."""
        return self.lattice.n_components

    @property
    def unit(self) -> int:
        """Lattice units in a pixel."""
        return 1 << self.subdivision

    @property
    def depth(self) -> int:
        """Bits of a sample, 8 to 16."""
        return self.lattice.depth

    @property
    def colors(self) -> SampleArray:
        """Colours of the vertices: grey, RGB or RGBA, alpha not multiplied.

        Shape (n, c), uint8, or uint16 if samples have more than 8 bits.
        """
        return self.lattice.colors_from_levels(self.levels)

    @property
    def plain_colors(self) -> UInt8Array:
        """Colours of the vertices in 8 bits, rounded if they have more; shape (n, c), uint8."""
        return rescale(self.colors, self.depth, PLAIN_DEPTH)

    @property
    def points(self) -> Float64Array:
        """Positions of the vertices in pixels, shape (n, 2), float64, exact."""
        return self.vertices / float(self.unit)

    def doubled_areas(self) -> Int64Array:
        """Twice the signed area of every triangle in square lattice units, shape (m,), int64."""
        return doubled_areas(self.vertices, self.triangles)

    @property
    def covers_canvas(self) -> bool:
        """Whether the triangles' areas add up to the canvas."""
        whole = 2 * self.width * self.height * self.unit**2
        return bool(int(self.doubled_areas().sum()) == whole)

    def check(self) -> None:
        """Raise :class:`ValueError` unless this is a mesh that a file may hold.

        Shapes, indices and ranges are checked when a mesh is made; this checks its geometry. The
        area rule: vertices are distinct and in use, every triangle is positively
        oriented, and the areas add up to the canvas. With every inner edge shared by exactly two
        triangles and every other edge on the border, that means that each point of the canvas
        is covered exactly once. If there are tiles, no triangle crosses the lines between them.
        """
        if np.unique(raster_keys(self.vertices)).size != self.n_vertices:
            raise ValueError("two vertices share a position")
        self._check_area()
        self._check_edges()
        self._check_tiles()

    def canonical(self) -> Mesh:
        """The same mesh in the order that files use.

        Vertices come in raster order (by y, then x), each triangle starts with its lowest vertex,
        and triangles come in lexicographic order.
        """
        order = np.argsort(raster_keys(self.vertices), kind="stable")
        rank = np.empty(self.n_vertices, dtype=np.int32)
        rank[order] = np.arange(self.n_vertices, dtype=np.int32)
        return self.replaced(
            vertices=self.vertices[order],
            levels=self.levels[order],
            triangles=sorted_triangles(rank[self.triangles]),
        )

    def transform(self, matrix: Matrix) -> Mesh:
        """The mesh with its vertices moved by an affine map, its topology as it was.

        The canvas becomes the whole-pixel box around the moved canvas, and the mesh is placed in
        it; so a translation alone changes nothing. Scalings, reflections and quarter turns are
        stretched by less than half a pixel so that the mesh covers its new canvas exactly. After
        any other map corners of the canvas stay uncovered: such a mesh renders and exports, but a
        ``.vmesh`` file does not store it.

        Parameters
        ----------
        matrix : sequence of six float
            ``(a, b, c, d, e, f)`` in SVG's order, in pixels.

        Raises
        ------
        ValueError
            If the matrix is singular, or the result is too large or too small for its triangles
            to keep their areas on the finest lattice.
        """
        placement = Placement.of(self.width, self.height, matrix)
        subdivision = min(
            MAX_SUBDIVISION,
            int(np.log2(MAX_LATTICE_SIDE / max(placement.width, placement.height))),
        )
        points = placement.move(self.points)
        triangles = self.triangles if placement.keeps_turn else self.triangles[:, ::-1]
        moved = self.replaced(
            width=placement.width,
            height=placement.height,
            subdivision=subdivision,
            vertices=np.rint(points * (1 << subdivision)).astype(np.int32),
            triangles=triangles,
            tile=None,
        )
        if not (moved.doubled_areas() > 0).all():
            raise ValueError("the map makes triangles too small for the finest vertex lattice")
        return moved

    def replaced(self, **changes: Any) -> Mesh:
        """The mesh with some of its fields changed."""
        values = {item.name: getattr(self, item.name) for item in fields(self)}
        return Mesh(**{**values, **changes})

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Mesh):
            return NotImplemented
        arrays = ("vertices", "triangles", "levels")
        return all(
            np.array_equal(getattr(self, item.name), getattr(other, item.name))
            if item.name in arrays
            else getattr(self, item.name) == getattr(other, item.name)
            for item in fields(self)
        )

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return (
            f"Mesh({self.width} x {self.height} px, {self.n_vertices} vertices, "
            f"{self.n_triangles} triangles, {self.n_components} colour components)"
        )

    def _repr_png_(self) -> bytes:
        """The picture, for notebooks."""
        png: bytes = _preview().png_preview(self)
        return png

    def _repr_svg_(self) -> str | None:
        """The drawing, for notebooks, if it has few triangles."""
        svg: str | None = _preview().svg_preview(self)
        return svg

    def _check_header(self) -> None:
        if not (1 <= self.width <= MAX_SIDE and 1 <= self.height <= MAX_SIDE):
            raise ValueError(
                f"expected a canvas of 1 to {MAX_SIDE} pixels a side, "
                f"got {self.width} x {self.height}"
            )
        if not 0 <= self.subdivision <= MAX_SUBDIVISION:
            raise ValueError(
                f"expected a subdivision of 0 to {MAX_SUBDIVISION}, got {self.subdivision}"
            )
        side = max(self.width, self.height) * self.unit
        if side > MAX_LATTICE_SIDE:
            raise ValueError(
                f"expected a canvas side of at most {MAX_LATTICE_SIDE} lattice units, got {side}"
            )
        if self.tile is not None and not 1 <= self.tile <= MAX_TILE_SIDE >> self.subdivision:
            raise ValueError(
                f"expected tiles of 1 to {MAX_TILE_SIDE >> self.subdivision} pixels a side, "
                f"got {self.tile}"
            )

    def _check_arrays(self) -> None:
        expected = (
            ("vertices", self.vertices, self.n_vertices, 2),
            ("triangles", self.triangles, self.n_triangles, 3),
            ("levels", self.levels, self.n_vertices, self.n_components),
        )
        for name, array, rows, columns in expected:
            if array.shape != (rows, columns):
                raise ValueError(f"expected {name} of shape ({rows}, {columns}), got {array.shape}")
        far = np.array([self.width, self.height]) * self.unit
        if ((self.vertices < 0) | (self.vertices > far)).any():
            raise ValueError("a vertex lies outside the canvas")
        if ((self.triangles < 0) | (self.triangles >= self.n_vertices)).any():
            raise ValueError("a triangle names a vertex that does not exist")
        lowest, highest = self.lattice.level_bounds()
        if ((self.levels < lowest) | (self.levels > highest)).any():
            raise ValueError("a colour level lies outside its component's range")

    def _check_area(self) -> None:
        areas = self.doubled_areas()
        if (areas <= 0).any():
            raise ValueError("a triangle has no area or is turned the wrong way")
        whole = 2 * self.width * self.height * self.unit**2
        # Each area is at most 2**39: sums of 2**23 of them stay within 64 bits.
        blocks = range(0, self.n_triangles, 1 << 23)
        if sum(int(areas[first : first + (1 << 23)].sum()) for first in blocks) != whole:
            raise ValueError("the triangles do not cover the canvas exactly")

    def _check_edges(self) -> None:
        start = self.triangles.astype(np.int64)
        end = np.roll(start, -1, axis=1)
        forward = np.sort((start * self.n_vertices + end).ravel())
        if (forward[1:] == forward[:-1]).any():
            raise ValueError("two triangles lie on the same side of an edge")
        backward = (end * self.n_vertices + start).ravel()
        place = np.minimum(np.searchsorted(forward, backward), forward.size - 1)
        lone = forward[place] != backward
        ends = self.vertices[np.stack([start.ravel()[lone], end.ravel()[lone]], axis=1)]
        same = ends[:, 0] == ends[:, 1]
        far = np.array([self.width, self.height]) * self.unit
        on_border = same & ((ends[:, 0] == 0) | (ends[:, 0] == far))
        if not on_border.any(axis=1).all():
            raise ValueError("an inner edge belongs to only one triangle")
        if not np.bincount(self.triangles.ravel(), minlength=self.n_vertices).all():
            raise ValueError("a vertex belongs to no triangle")

    def _check_tiles(self) -> None:
        if self.tile is None:
            return
        corners = self.vertices[self.triangles]
        side = self.tile * self.unit
        # Counted from the line before the lowest corner.
        reach = corners.max(axis=1) - corners.min(axis=1) // side * side
        if (reach > side).any():
            raise ValueError("a triangle crosses the line between two tiles")


def _preview() -> ModuleType:
    """What draws meshes in notebooks, by its name: the mesh itself depends on no floor above it."""
    return import_module("vmesh.formats.preview")


@dataclass(frozen=True, slots=True)
class Placement:
    """An affine map of a canvas into the whole-pixel box around it.

    Parameters
    ----------
    width, height : int
        Size of the box in pixels.
    linear : ndarray
        Shape (2, 2), float64.
    offset : ndarray
        Shape (2,), float64, in pixels.
    fills : bool
        Whether the moved canvas fills the box.
    """

    width: int
    height: int
    linear: Float64Array
    offset: Float64Array
    fills: bool

    @classmethod
    def of(cls, width: int, height: int, matrix: Matrix) -> Placement:
        """Where a matrix puts a canvas of `width` x `height` pixels.

        A map that keeps the canvas upright is stretched by less than half a pixel so that it
        fills its box.
        """
        values = np.asarray(matrix, dtype=np.float64)
        if values.shape != (6,) or not (np.abs(values) <= _LARGEST_ENTRY).all():
            raise ValueError(
                f"expected a matrix of six finite numbers up to {_LARGEST_ENTRY:g}, got {matrix!r}"
            )
        linear = values[:4].reshape(2, 2).T
        if abs(np.linalg.det(linear)) < 1e-12:
            raise ValueError("the matrix is singular: it would flatten the mesh")
        canvas = np.array([[0, 0], [width, 0], [0, height], [width, height]]) @ linear.T
        low, extent = canvas.min(axis=0), np.ptp(canvas, axis=0)
        fills = not linear[[0, 1], [1, 0]].any() or not linear[[0, 1], [0, 1]].any()
        size = np.maximum(np.rint(extent) if fills else np.ceil(extent - 1e-9), 1)
        if size.max() > MAX_SIDE:
            raise ValueError(f"the moved canvas is wider or higher than {MAX_SIDE} pixels")
        stretch = size / extent if fills else np.ones(2)
        return cls(
            int(size[0]), int(size[1]), linear * stretch[:, None], -low * stretch, bool(fills)
        )

    @property
    def keeps_turn(self) -> bool:
        """Whether triangles keep their orientation."""
        return bool(np.linalg.det(self.linear) > 0)

    def move(self, points: Float64Array) -> Float64Array:
        """Points of shape (n, 2) in the box, in pixels."""
        moved: Float64Array = points @ self.linear.T + self.offset
        return moved


def doubled_areas(vertices: Int32Array, triangles: npt.NDArray[np.integer]) -> Int64Array:
    """Twice the signed area of every triangle, (m, 3), of vertices, (n, 2); shape (m,), int64."""
    corners = vertices.astype(np.int64)[triangles]
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    areas: Int64Array = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    return areas


def sorted_triangles(triangles: npt.NDArray[np.integer]) -> Int32Array:
    """Triangles in canonical order: lowest vertex first, then lexicographic; shape (m, 3)."""
    first, second, third = triangles.T
    lowest = np.minimum(first, np.minimum(second, third))
    rotated = np.where((lowest == second)[:, None], triangles[:, [1, 2, 0]], triangles)
    rotated = np.where((lowest == third)[:, None], triangles[:, [2, 0, 1]], rotated)
    # In a manifold mesh no two triangles share a directed edge: two indices decide the order.
    first_edges = (rotated[:, 0].astype(np.int64) << 32) | rotated[:, 1]
    result: Int32Array = rotated[np.argsort(first_edges)].astype(np.int32)
    return result


def raster_keys(vertices: Int32Array | Int64Array) -> Int64Array:
    """Integers that sort positions of shape (n, 2) in raster order, one for each; (n,), int64."""
    wide = vertices.astype(np.int64)
    keys: Int64Array = (wide[:, 1] << 32) | wide[:, 0]
    return keys
