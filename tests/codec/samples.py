"""Small meshes whose files the tests of the codec take apart."""

from __future__ import annotations

import numpy as np

from tests.pictures import disc, grey_ramp, noise
from tests.strategies import flipped
from vmesh.color_lattice import ColorLattice
from vmesh.encoder.pipeline import encode
from vmesh.mesh import Mesh, Metadata


def smallest() -> Mesh:
    """One grey pixel: four corners and two triangles."""
    vertices = np.array([[0, 0], [1, 0], [0, 1], [1, 1]])
    triangles = np.array([[0, 1, 3], [0, 3, 2]])
    levels = np.array([[0], [40], [80], [255]])
    return Mesh(1, 1, vertices, triangles, levels, ColorLattice((1,)))


def grey() -> Mesh:
    return encode(grey_ramp(9, 13), vertices=20)


def color() -> Mesh:
    return encode(noise(16, 16), vertices=60)


def transparent() -> Mesh:
    return encode(disc(20, 20, hidden=(255, 0, 0), visible=(0, 90, 200)), vertices=50)


def listed() -> Mesh:
    """A mesh with triangles that are not those of Delaunay."""
    mesh = color()
    random = np.random.default_rng(1)
    return mesh.replaced(triangles=flipped(mesh.vertices, mesh.triangles, 12, random))


def with_metadata() -> Mesh:
    blocks = Metadata(b"profile" * 20, b"exif\0\1", b"<x:xmpmeta/>", ((b"n", b"hello"),))
    return grey().replaced(metadata=blocks)
