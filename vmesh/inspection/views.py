"""Drawings of the stages of an encoding, each in a place of a sheet."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Final, TypeVar

import numpy as np
from PIL import Image

from vmesh.arrays import Float64Array, Int64Array, UInt8Array
from vmesh.inspection.heat import heat_colors, scale_top
from vmesh.inspection.sheet.items import Color, Item, MeshPart, Pixels, Strokes, View
from vmesh.inspection.stages import Inspection
from vmesh.mesh import Mesh

INK: Final[Color] = (32, 32, 32)
_LINE: Final[Color] = (40, 90, 160)
_SATURATED: Final = 220  # of the plane's own channel, as in the figures of Zhao, Feng and Zhou
_LINE_WIDTH: Final = 0.4  # at the picture's own scale
_DOT_WIDTH: Final = 1.2
_MOST_WEIGHT: Final = 4.0
_PALE: Final = 0.35  # of a picture's contrast under lines

Samples = TypeVar("Samples", UInt8Array, Float64Array)
Draw = Callable[[Inspection, View], Iterator[Item]]


def draw_original(inspection: Inspection, view: View) -> Iterator[Item]:
    """The photograph, its pixels as squares where it is enlarged."""
    yield _shown(inspection.original, view)


def draw_bicubic(inspection: Inspection, view: View) -> Iterator[Item]:
    """The photograph, enlarged as most programs do it."""
    box = (view.left, view.top, view.left + view.across, view.top + view.down)
    image = Image.fromarray(inspection.original)
    resized = image.resize((view.width, view.height), Image.Resampling.BICUBIC, box=box)
    yield Pixels(view.x, view.y, np.asarray(resized))


def draw_salience(inspection: Inspection, view: View) -> Iterator[Item]:
    """The salience in colours, dark where it is large; alpha left out."""
    levels = 255 - (np.minimum(inspection.salience, 255 * 256) >> 8).astype(np.uint8)
    planes = levels[:3] if len(levels) >= 3 else np.repeat(levels[:1], 3, axis=0)
    yield _shown(planes.transpose(1, 2, 0), view)


def draw_points(inspection: Inspection, view: View) -> Iterator[Item]:
    """The vertices; samples are in the colours of their planes."""
    points = inspection.mesh.points
    colors = _point_colors(inspection)
    for color in np.unique(colors, axis=0):
        own = points[np.all(colors == color, axis=1)]
        red, green, blue = color.tolist()
        ends = np.stack([own, own], axis=1)
        yield Strokes(view, ends, (red, green, blue), _DOT_WIDTH * _weight(view))


def draw_triangles(inspection: Inspection, view: View) -> Iterator[Item]:
    """The edges of the mesh, over pale pixels of the photograph if that is enlarged."""
    if view.scale[0] > 1:
        squares = _shown(inspection.original, view)
        pale = np.rint(255 - _PALE * (255.0 - squares.array)).astype(np.uint8)
        yield Pixels(view.x, view.y, pale)
    mesh = inspection.mesh
    yield Strokes(view, mesh.points[edges_of(mesh)], _LINE, _LINE_WIDTH * _weight(view))


def draw_render(inspection: Inspection, view: View) -> Iterator[Item]:
    """The mesh itself."""
    yield MeshPart(view, inspection.shown, inspection.limits)


def draw_error(inspection: Inspection, view: View) -> Iterator[Item]:
    """The error of the mesh at each pixel, in colours up to :func:`error_top`."""
    levels = _part(inspection.errors, view) / error_top(inspection, view)
    colors = heat_colors(levels)
    yield Pixels(view.x, view.y, _fitted(colors, view))


DRAWINGS: Final[dict[str, Draw]] = {
    "original": draw_original,
    "salience": draw_salience,
    "points": draw_points,
    "mesh": draw_triangles,
    "render": draw_render,
    "error": draw_error,
}


def error_top(inspection: Inspection, view: View) -> int:
    """Levels at the top of the colours of errors."""
    return scale_top(_part(inspection.errors, view))


def edges_of(mesh: Mesh) -> Int64Array:
    """Each edge of a mesh once, shape (n, 2): indices of its vertices, the lower first."""
    ends = np.concatenate([mesh.triangles[:, [i, (i + 1) % 3]] for i in range(3)])
    low, high = np.sort(ends.astype(np.int64), axis=1).T
    edges: Int64Array = np.stack(np.divmod(np.unique(low << 32 | high), 1 << 32), axis=1)
    return edges


def _point_colors(inspection: Inspection) -> UInt8Array:
    """Colours of the vertices, shape (n, 3)."""
    mesh, classes = inspection.mesh, inspection.classes
    if classes is None or mesh.n_components == 1:
        return np.full((mesh.n_vertices, 3), INK, dtype=np.uint8)
    last = (mesh.width - 1, mesh.height - 1)
    x, y = np.minimum(mesh.vertices // mesh.unit, last).T
    planes = np.stack([classes[y, x] >> i & 1 for i in range(3)], axis=1)
    # A point of the border has no plane; the colour of all three would be too pale.
    is_mixed = np.isin(planes.sum(axis=1), (0, 3))
    colors = np.where(is_mixed[:, None], INK, planes * _SATURATED)
    return colors.astype(np.uint8)


def _weight(view: View) -> float:
    """Factor by which strokes are wider than at the picture's own scale."""
    return min(float(view.scale[0] ** 0.5), _MOST_WEIGHT)


def _part(array: Samples, view: View) -> Samples:
    """The part of an array of shape (h, w, ...) that a view shows."""
    return array[view.top : view.top + view.down, view.left : view.left + view.across]


def _shown(picture: UInt8Array, view: View) -> Pixels:
    """The part of a picture of shape (h, w, 3) that a view shows, filling the view."""
    return Pixels(view.x, view.y, _fitted(_part(picture, view), view))


def _fitted(part: UInt8Array, view: View) -> UInt8Array:
    """A picture that fills a view: its pixels as squares, or means of them."""
    size = (view.width, view.height)
    is_enlarged = size[0] >= part.shape[1] and size[1] >= part.shape[0]
    way = Image.Resampling.NEAREST if is_enlarged else Image.Resampling.BOX
    return np.asarray(Image.fromarray(np.ascontiguousarray(part)).resize(size, way))
