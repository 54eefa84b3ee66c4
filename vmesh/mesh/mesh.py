"""The mesh: integer vertices on a lattice, a colour level at each, triangles that cover a canvas.

::

    (0, 0) ---- x ---->  (width, 0)         pixels; a pixel's centre is at +1/2, +1/2
      |    .       .                        vertices are multiples of 1 / 2**subdivision pixel
      y       .                             triangles turn from x towards y: clockwise on a
      v   .        .                        screen, a positive cross product in these axes
    (0, height)          (width, height)
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace
from operator import index
from typing import TypedDict, Unpack

import numpy as np
import numpy.typing as npt

from vmesh.arrays import Float64Array, Int32Array, Int64Array, SampleArray, UInt8Array
from vmesh.color_lattice import ColorLattice, rescale
from vmesh.limits import MAX_LATTICE_SIDE, MAX_SUBDIVISION, PLAIN_DEPTH
from vmesh.mesh.areas import doubled_areas
from vmesh.mesh.canonical_order import raster_keys, sorted_triangles
from vmesh.mesh.checks import check_arrays, check_canvas, check_geometry
from vmesh.mesh.metadata import Metadata
from vmesh.mesh.placement import Matrix, Placement


class MeshFields(TypedDict, total=False):
    """Fields of a :class:`Mesh`, some of them."""

    width: int
    height: int
    vertices: Int32Array
    triangles: Int32Array
    levels: Int32Array
    lattice: ColorLattice
    subdivision: int
    metadata: Metadata
    tile: int | None


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
        check_canvas(self)
        check_arrays(self)

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
        """Agreement of the triangles' areas, all together, with that of the canvas."""
        whole = 2 * self.width * self.height * self.unit**2
        return bool(int(self.doubled_areas().sum()) == whole)

    def check(self) -> None:
        """Refuse a mesh that no file may hold with a :class:`ValueError`.

        Shapes, indices and ranges are checked when a mesh is made; this checks its geometry. The
        area rule: vertices are distinct and in use, every triangle is positively
        oriented, and the areas add up to the canvas. With every inner edge shared by exactly two
        triangles and every other edge on the border, that means that each point of the canvas
        is covered exactly once. If there are tiles, no triangle crosses the lines between them.
        """
        check_geometry(self)

    def canonical(self) -> Mesh:
        """Mesh in canonical order, that of files.

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
        """Mesh with its vertices moved by an affine map, its topology as it was.

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

    def replaced(self, **changes: Unpack[MeshFields]) -> Mesh:
        """Mesh with some of its fields, given by their names, changed."""
        return replace(self, **changes)

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
        from vmesh.formats.preview import png_preview

        return png_preview(self)

    def _repr_svg_(self) -> str | None:
        """The drawing, for notebooks, if it has few triangles."""
        from vmesh.formats.preview import svg_preview

        return svg_preview(self)


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
