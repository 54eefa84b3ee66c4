"""A small mesh to change and to break."""

from __future__ import annotations

from typing import Any

import numpy as np

from vmesh.color_lattice import ColorLattice
from vmesh.mesh import Mesh

FAN = [[0, 1, 4], [1, 3, 4], [3, 2, 4], [2, 0, 4]]


def square(**changes: Any) -> Mesh:
    """A canvas of 4 x 4 pixels: four corners, the centre, and four triangles around it."""
    vertices = [[0, 0], [4, 0], [0, 4], [4, 4], [2, 2]]
    levels = [[0], [10], [20], [30], [40]]
    mesh = Mesh(4, 4, np.array(vertices), np.array(FAN), np.array(levels), ColorLattice((1,)))
    arrays: dict[str, Any] = {
        name: np.array(value) for name, value in changes.items() if type(value) is list
    }
    return mesh.replaced(**{**changes, **arrays})
