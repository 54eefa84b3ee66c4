"""Small meshes whose files the tests of the codec take apart."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from tests.pictures import disc, grey_ramp, noise
from tests.strategies import flipped as randomly_flipped
from tests.strategies import raster_sorted
from vmesh.arrays import UInt8Array
from vmesh.color_lattice import ColorLattice
from vmesh.encoder.pipeline import encode
from vmesh.mesh import Mesh, Metadata

LISTED_COLUMNS: Final = 24
"""Spaces between the vertices of a row in the mesh that is listed."""


def smallest() -> Mesh:
    """One grey pixel: four corners and two triangles."""
    vertices = np.array([[0, 0], [1, 0], [0, 1], [1, 1]])
    triangles = np.array([[0, 1, 3], [0, 3, 2]])
    levels = np.array([[0], [40], [80], [255]])
    return Mesh(1, 1, vertices, triangles, levels, ColorLattice((1,)))


def grey() -> Mesh:
    return implied(grey_ramp(9, 13), 20)


def color() -> Mesh:
    return implied(noise(16, 16), 60)


def transparent() -> Mesh:
    return implied(disc(20, 20, hidden=(255, 0, 0), visible=(0, 90, 200)), 50)


def implied(picture: UInt8Array, n_vertices: int) -> Mesh:
    """A mesh with the canonical Delaunay triangles."""
    return encode(picture, method="blue-noise", vertices=n_vertices)


def flipped(mesh: Mesh | None = None) -> Mesh:
    """A mesh with some edges flipped, so that its triangles are not those of Delaunay."""
    mesh = mesh or color()
    random = np.random.default_rng(1)
    return mesh.replaced(triangles=randomly_flipped(mesh.vertices, mesh.triangles, 12, random))


def listed(n_components: int = 3) -> Mesh:
    """A mesh so far from the Delaunay triangles that flips would be more than the triangles.

    There are two rows of vertices. The upper ones are joined to the lower left corner, the lower
    ones to the upper right corner. Delaunay triangles go to and fro between the rows, and each
    flip moves one vertex by one place: their number grows with the square of that of the vertices.
    """
    k = LISTED_COLUMNS
    vertices = [(x, y) for y in (0, 1) for x in range(k + 1)]
    triangles = [(x, x + 1, k + 1) for x in range(k)]
    triangles += [(k, k + 1 + x + 1, k + 1 + x) for x in range(k)]
    colors = np.random.default_rng(3).integers(0, 256, (len(vertices), n_components))
    points = raster_sorted(np.array(vertices, dtype=np.int32))
    return Mesh.from_colors(k, 1, points, np.array(triangles), colors, step=8).canonical()


def with_metadata() -> Mesh:
    blocks = Metadata(b"profile" * 20, b"exif\0\1", b"<x:xmpmeta/>", ((b"n", b"hello"),))
    return grey().replaced(metadata=blocks)


CASES: Final[dict[str, Callable[[], Mesh]]] = {
    "smallest": smallest,
    "grey, implied": grey,
    "RGB, implied": color,
    "RGBA, implied": transparent,
    "grey, flipped": lambda: flipped(grey()),
    "RGB, flipped": flipped,
    "RGBA, flipped": lambda: flipped(transparent()),
    "grey, listed": lambda: listed(1),
    "RGB, listed": listed,
    "RGBA, listed": lambda: listed(4),
    "with metadata": with_metadata,
}
"""Meshes of every number of components and every way of telling the triangles, by name."""
