"""Steps of drawing a mesh: our own, those of cairo, and those of Skia."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

import vmesh
from vmesh.arrays import Float64Array, UInt8Array
from vmesh.formats.pdf.cairo_patterns import MeshPattern, import_cairo
from vmesh.formats.raster.rendering import with_alpha
from vmesh.kernels.scanline import SUBPIXEL, fill
from vmesh.mesh import Mesh

Size = tuple[int, int]  # columns and rows of pixels

RENDER: Final = "`vmesh.render`, whole call"
KERNEL: Final = "`scanline.fill` alone"


@dataclass(frozen=True, slots=True)
class Step:
    """A step of drawing a mesh; one that draws can say what is on its raster."""

    name: str
    run: Callable[[], object]
    pixels: Callable[[], UInt8Array] | None = None


def scaled_points(mesh: Mesh, size: Size) -> Float64Array:
    """Vertices in pixels of the raster, shape (n, 2)."""
    points: Float64Array = mesh.points * (size[0] / mesh.width, size[1] / mesh.height)
    return points


def vmesh_steps(mesh: Mesh, size: Size) -> list[Step]:
    """Our own raster: the whole call, and its inner loop with everything prepared."""
    positions = np.floor(scaled_points(mesh, size) * SUBPIXEL + 0.5).astype(np.int64)
    triangles, colors = mesh.triangles, mesh.colors
    width, height = size
    raster = np.zeros((height, width, 3), dtype=np.uint8)

    def whole() -> UInt8Array:
        return vmesh.render(mesh, width=width, height=height)

    return [
        Step(RENDER, whole, whole),
        Step(KERNEL, lambda: fill(positions, triangles, colors, raster), lambda: raster),
    ]


def cairo_steps(mesh: Mesh, size: Size) -> list[Step]:
    """A cairo mesh pattern: built, and painted on an image surface."""
    cairocffi = import_cairo()
    corners = scaled_points(mesh, size)[mesh.triangles]
    colors = (with_alpha(mesh.colors) / 255.0)[mesh.triangles]
    surface = cairocffi.ImageSurface(cairocffi.FORMAT_RGB24, *size)
    context = cairocffi.Context(surface)

    def build() -> MeshPattern:
        pattern = MeshPattern()
        pattern.add_triangles(corners, colors)
        return pattern

    def pixels() -> UInt8Array:
        surface.flush()
        data = np.frombuffer(surface.get_data(), dtype=np.uint8)
        return data.reshape(size[1], size[0], 4)[:, :, channels_of_native_rgb()]

    pattern = build()
    return [
        Step("cairo mesh pattern, build", build),
        Step("cairo mesh pattern, paint", lambda: pattern.paint(context), pixels),
    ]


def channels_of_native_rgb() -> list[int]:
    """Bytes of red, green and blue in cairo's 32-bit words, which are of the machine's order."""
    return [2, 1, 0] if sys.byteorder == "little" else [1, 2, 3]


def skia_steps(skia: Any, mesh: Mesh, size: Size) -> list[Step]:
    """Skia's drawVertices: the vertices built, and drawn on a raster surface."""
    points, colors = scaled_points(mesh, size), mesh.colors.astype(np.int64)
    words = (255 << 24) | (colors[:, 0] << 16) | (colors[:, 1] << 8) | colors[:, 2]
    indices: list[int] | None = mesh.triangles.ravel().tolist()
    if mesh.n_vertices > 1 << 16:  # Skia's indices have 16 bits: every triangle has its own corners
        points, words = points[mesh.triangles].reshape(-1, 2), words[mesh.triangles].ravel()
        indices = None
    buffer = np.zeros((size[1], size[0], 4), dtype=np.uint8)
    canvas = skia.Surface(buffer).getCanvas()
    paint = skia.Paint(AntiAlias=False)

    def build() -> object:
        corners = [skia.Point(x, y) for x, y in points.tolist()]
        mode = skia.Vertices.kTriangles_VertexMode
        return skia.Vertices(mode, corners, colors=words.tolist(), indices=indices)

    def draw() -> None:
        canvas.drawVertices(vertices, paint, skia.BlendMode.kDst)  # the vertices' colours alone

    vertices = build()
    return [
        Step("skia-python vertices, build", build),
        Step("skia-python drawVertices", draw, lambda: buffer[:, :, :3]),
    ]
