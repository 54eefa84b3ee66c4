"""Cairo's mesh patterns, which cairocffi declares but does not wrap."""

from __future__ import annotations

from types import ModuleType
from typing import Any

import numpy as np

from vmesh.arrays import Float64Array
from vmesh.errors import VmeshError


def import_cairo() -> ModuleType:
    """The module cairocffi.

    Raises
    ------
    VmeshError
        If it, or the cairo library that it calls, is not installed.
    """
    try:
        import cairocffi
    except ImportError:
        raise VmeshError("drawing with cairo needs cairocffi: pip install cairocffi") from None
    except OSError:
        raise VmeshError(
            "drawing with cairo needs the cairo library: install the package libcairo2"
        ) from None
    module: ModuleType = cairocffi
    return module


class MeshPattern:
    """A cairo mesh pattern made of triangles.

    Each triangle is a Coons patch with straight sides whose fourth side is a point, which makes
    its colour linear.

    References
    ----------
    S. A. Coons, "Surfaces for computer-aided design of space forms", MIT, MAC-TR-41, 1967.
    """

    def __init__(self) -> None:
        cairocffi = import_cairo()
        self._cairo: Any = cairocffi.cairo
        pointer = self._cairo.cairo_pattern_create_mesh()
        self.pointer: Any = cairocffi.ffi.gc(pointer, self._cairo.cairo_pattern_destroy)
        self._check = cairocffi._check_status

    def add_triangles(self, points: Float64Array, colors: Float64Array) -> None:
        """Add triangles.

        Parameters
        ----------
        points : ndarray
            Shape (m, 3, 2), float64: corners in user space.
        colors : ndarray
            Shape (m, 3, 4), float64: RGBA of the corners, 0 to 1, alpha not multiplied.
        """
        cairo, mesh = self._cairo, self.pointer
        set_color = cairo.cairo_mesh_pattern_set_corner_color_rgba
        for corners, paints in zip(np.asarray(points).tolist(), colors.tolist(), strict=True):
            cairo.cairo_mesh_pattern_begin_patch(mesh)
            cairo.cairo_mesh_pattern_move_to(mesh, *corners[0])
            cairo.cairo_mesh_pattern_line_to(mesh, *corners[1])
            cairo.cairo_mesh_pattern_line_to(mesh, *corners[2])
            for corner, paint in enumerate((*paints, paints[0])):
                set_color(mesh, corner, *paint)
            cairo.cairo_mesh_pattern_end_patch(mesh)
        self._check(cairo.cairo_pattern_status(mesh))

    def paint(self, context: Any) -> None:
        """Paint the pattern on a ``cairocffi.Context``."""
        self._cairo.cairo_set_source(context._pointer, self.pointer)
        context.paint()
