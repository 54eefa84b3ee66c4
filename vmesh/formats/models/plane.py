"""A flat surface in space -> Mesh: its box becomes the canvas, its places and colours a lattice's.

::

      y                                   (0, 0) ---- x --->
      |    .-----------. high                |  .-----------.
      |    |  surface  |           ->        y  |  canvas   |
      |    '-----------'                     v  '-----------'
      |   low                                           (width, height)
      '---------- x
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from vmesh.arrays import Float64Array, Int64Array, UInt8Array
from vmesh.formats.raster.rendering import raster_size, with_alpha
from vmesh.limits import DEFAULT_LIMITS, MAX_LATTICE_SIDE, MAX_SUBDIVISION, Limits
from vmesh.mesh import Mesh

_TOLERANCE: Final = 1e-3  # lattice units that other programs' arithmetic may be off


@dataclass(frozen=True, slots=True)
class Surface:
    """Coloured triangles in space.

    Parameters
    ----------
    points : ndarray
        Shape (n, 3), float64: x right, y up, z towards the viewer.
    triangles : ndarray
        Shape (m, 3), int64: indices into `points`.
    colors : ndarray
        Shape (n, 4), uint8: RGBA, alpha not multiplied.
    """

    points: Float64Array
    triangles: Int64Array
    colors: UInt8Array


def surface_of(mesh: Mesh) -> Surface:
    """A mesh upright in the plane z = 0, a unit for each pixel, its triangles counter-clockwise."""
    points = np.zeros((mesh.n_vertices, 3))
    points[:, 0] = mesh.points[:, 0]
    points[:, 1] = mesh.height - mesh.points[:, 1]
    triangles = mesh.triangles[:, ::-1].astype(np.int64)
    return Surface(points, triangles, with_alpha(mesh.plain_colors))


def mesh_of(
    surface: Surface,
    *,
    scale: float | None = None,
    width: int | None = None,
    height: int | None = None,
    step: int = 1,
    limits: Limits = DEFAULT_LIMITS,
) -> Mesh:
    """Mesh of a flat surface, its canvas the box around it; see `import_mesh`."""
    check_surface(surface)
    low, high = surface.points[:, :2].min(axis=0), surface.points[:, :2].max(axis=0)
    extent = high - low
    if not extent.all():
        raise ValueError("the mesh has no area")
    size = raster_size(float(extent[0]), float(extent[1]), scale, width, height)
    limits.check_pixels(*size)
    places = (surface.points[:, :2] - low) * (size / extent)
    places[:, 1] = size[1] - places[:, 1]
    subdivision = _subdivision_of(places, max(size))
    sites = np.rint(places * (1 << subdivision)).astype(np.int64)
    # Programs split a vertex where it has several normals: one remains of those that agree.
    rows, ranks = np.unique(
        np.concatenate([sites, surface.colors], axis=1), axis=0, return_inverse=True
    )
    vertices, colors = rows[:, :2], _fewest_components(rows[:, 2:])
    triangles = _turned(vertices, ranks.reshape(-1)[surface.triangles])
    mesh = Mesh.from_colors(
        *size, vertices, triangles, colors, step=step, subdivision=subdivision
    ).canonical()
    mesh.check()
    return mesh


def check_surface(surface: Surface) -> None:
    """Raise :class:`ValueError` unless these are flat triangles with indices of their points."""
    points, triangles = surface.points, surface.triangles
    if not len(points) or not len(triangles):
        raise ValueError("expected a mesh of triangles, found none")
    if not np.isfinite(points).all():
        raise ValueError("a coordinate is not a finite number")
    if triangles.min() < 0 or triangles.max() >= len(points):
        raise ValueError("a triangle names a vertex that does not exist")
    depth, across = np.ptp(points[:, 2]), np.ptp(points[:, :2])
    if depth > across * 1e-6:
        raise ValueError(f"expected a flat mesh, its z spans {depth:g} units")


def _subdivision_of(places: Float64Array, side: int) -> int:
    """The coarsest lattice that all places lie on, or the finest there is for this canvas side."""
    finest = min(MAX_SUBDIVISION, (MAX_LATTICE_SIDE // side).bit_length() - 1)
    for subdivision in range(finest):
        units = places * (1 << subdivision)
        if (np.abs(units - np.rint(units)) <= _TOLERANCE).all():
            return subdivision
    return finest


def _fewest_components(colors: Int64Array) -> Int64Array:
    """Grey, RGB or RGBA of RGBA colours: the fewest components that hold them all."""
    if (colors[:, 3] < 255).any():
        return colors
    is_grey = (colors[:, :1] == colors[:, :3]).all()
    return colors[:, : 1 if is_grey else 3]


def _turned(vertices: Int64Array, triangles: Int64Array) -> Int64Array:
    """Triangles that are all positively oriented, from x towards y."""
    corners = vertices[triangles]
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    is_wrong = first[:, 0] * second[:, 1] < first[:, 1] * second[:, 0]
    turned: Int64Array = np.where(is_wrong[:, None], triangles[:, ::-1], triangles)
    return turned
