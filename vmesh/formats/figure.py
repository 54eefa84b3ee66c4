"""Pictures of the encoder's stages, and sheets of them: the paper's Figure 4 for any photograph."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from vmesh.arrays import Int32Array, UInt8Array, UInt16Array
from vmesh.mesh import Mesh

_PAPER: Final = (255, 255, 255)
_INK: Final = (32, 32, 32)
_LINE: Final = (40, 90, 160)
_GAP: Final = 12
_CAPTION_SIZE: Final = 16
_SAMPLES: Final = 3  # per pixel and direction, for smooth lines
_ERROR_GAIN: Final = 4


@dataclass(frozen=True, slots=True)
class Panel:
    """One picture of a sheet: shape (h, w, 3), uint8, and what it shows."""

    picture: UInt8Array
    caption: str


def draw_salience(salience: UInt16Array) -> UInt8Array:
    """Salience maps as a colour picture, shape (h, w, 3), dark where there is much.

    `salience` has shape (c, h, w), in 1/256 level; grey is repeated, alpha left out.
    """
    levels = 255 - (np.minimum(salience, 255 * 256) >> 8).astype(np.uint8)
    planes = levels[:3] if len(levels) >= 3 else np.repeat(levels[:1], 3, axis=0)
    return np.ascontiguousarray(planes.transpose(1, 2, 0))


def draw_points(
    points: Int32Array, unit: int, width: int, height: int, colors: UInt8Array
) -> UInt8Array:
    """Points as dots, shape (h, w, 3).

    Parameters
    ----------
    points : ndarray
        Shape (n, 2), int32, in lattice units of 1 / `unit` pixel.
    colors : ndarray
        Shape (n, 3), uint8: the dots' colours.
    """
    canvas = Image.new("RGB", (width * _SAMPLES, height * _SAMPLES), _PAPER)
    draw = ImageDraw.Draw(canvas)
    for (x, y), color in zip((points * (_SAMPLES / unit)).tolist(), colors.tolist(), strict=True):
        draw.ellipse((x - 1.8, y - 1.8, x + 1.8, y + 1.8), fill=tuple(color))
    return _reduced(canvas, width, height)


def draw_wireframe(mesh: Mesh) -> UInt8Array:
    """Edges of a mesh, shape (h, w, 3)."""
    canvas = Image.new("RGB", (mesh.width * _SAMPLES, mesh.height * _SAMPLES), _PAPER)
    draw = ImageDraw.Draw(canvas)
    ends = np.concatenate([mesh.triangles[:, [0, 1]], mesh.triangles[:, [1, 2]]])
    ends = np.concatenate([ends, mesh.triangles[:, [2, 0]]])
    edges = np.unique(np.sort(ends, axis=1), axis=0)
    limit = np.array([mesh.width, mesh.height]) * _SAMPLES - 1
    points = np.minimum(mesh.points * _SAMPLES, limit)
    for line in points[edges].reshape(-1, 4).tolist():
        draw.line(line, fill=_LINE, width=1)
    return _reduced(canvas, mesh.width, mesh.height)


def draw_error(first: UInt8Array, second: UInt8Array) -> UInt8Array:
    """Differences of two pictures of shape (h, w, 3), times four, dark where they are large."""
    difference = np.abs(first.astype(np.int64) - second)
    dark: UInt8Array = (255 - np.minimum(difference * _ERROR_GAIN, 255)).astype(np.uint8)
    return dark


def compose_sheet(panels: Sequence[Panel], columns: int) -> UInt8Array:
    """Panels of one size side by side, with captions; shape (h, w, 3), uint8."""
    height, width = panels[0].picture.shape[:2]
    rows = -(-len(panels) // columns)
    caption_height = _CAPTION_SIZE + _GAP
    size = (
        columns * width + (columns + 1) * _GAP,
        rows * (height + caption_height) + (rows + 1) * _GAP,
    )
    sheet = Image.new("RGB", size, _PAPER)
    draw = ImageDraw.Draw(sheet)
    font = ImageFont.load_default(size=_CAPTION_SIZE)
    for i, panel in enumerate(panels):
        x = _GAP + (i % columns) * (width + _GAP)
        y = _GAP + (i // columns) * (height + caption_height + _GAP)
        sheet.paste(Image.fromarray(panel.picture), (x, y))
        draw.text((x, y + height + _GAP // 3), panel.caption, fill=_INK, font=font)
    return np.asarray(sheet)


def _reduced(canvas: Image.Image, width: int, height: int) -> UInt8Array:
    return np.asarray(canvas.resize((width, height), Image.Resampling.BOX))
