"""Meshes in tiles, of random vertices."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from vmesh.color_lattice import ColorLattice
from vmesh.grid import Grid
from vmesh.kernels.delaunay import delaunay
from vmesh.mesh import Mesh
from vmesh.mesh.canonical_order import raster_keys


def tiled(
    width: int,
    height: int,
    side: int,
    n_components: int,
    *,
    n_vertices: int = 0,
    subdivision: int = 0,
    step: int = 1,
    depth: int = 8,
    change: Callable[[Mesh], Mesh] = lambda piece: piece,
) -> Mesh:
    """A mesh in tiles, of which each is Delaunay, and then changed but for its vertices.

    It has the corners of the tiles, so many vertices elsewhere, and some on the lines between them.
    """
    random = np.random.default_rng(width + 100 * height + n_vertices)
    unit = 1 << subdivision
    xs, ys = ([*range(0, size, side), size] for size in (width, height))
    corners = np.array([(x * unit, y * unit) for y in ys for x in xs])
    inner = random.integers(0, [width * unit + 1, height * unit + 1], (n_vertices, 2))
    upright, level = inner[: n_vertices // 6].copy(), inner[: n_vertices // 6].copy()
    upright[:, 0] = random.choice(xs, len(upright)) * unit
    level[:, 1] = random.choice(ys, len(level)) * unit
    points = np.concatenate([corners, inner, upright, level]).astype(np.int32)
    points = points[np.unique(raster_keys(points), return_index=True)[1]]
    lattice = ColorLattice.uniform(n_components, step, depth)
    samples = random.integers(0, 1 << depth, (len(points), n_components))
    levels = lattice.levels_from_colors(samples)
    triangles = []
    for tile in Grid(width, height, side).tiles():
        corner, size = np.array([tile[:2], tile[2:]]) * unit
        within = ((points >= corner) & (points <= corner + size)).all(axis=1)
        own = (points[within] - corner).astype(np.int32)
        piece = Mesh(
            tile.width, tile.height, own, delaunay(own), levels[within], lattice, subdivision
        )
        triangles.append(np.flatnonzero(within)[change(piece).triangles])
    faces = np.concatenate(triangles).astype(np.int32)
    return Mesh(width, height, points, faces, levels, lattice, subdivision, tile=side).canonical()
