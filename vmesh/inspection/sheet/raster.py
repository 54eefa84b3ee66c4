"""Sheet -> pixels."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

import numpy as np
from PIL import Image, ImageDraw

from vmesh.arrays import UInt8Array
from vmesh.inspection.sheet.items import (
    PAPER,
    Frame,
    Label,
    MeshPart,
    Pixels,
    Sheet,
    Strokes,
    font_of,
)
from vmesh.limits import DEFAULT_LIMITS, Limits

_SAMPLES: Final = 3  # per unit and direction, for smooth strokes


def draw_sheet(sheet: Sheet, *, limits: Limits = DEFAULT_LIMITS) -> UInt8Array:
    """Pixels of a sheet, shape (h, w, 3), uint8.

    Raises
    ------
    LimitError
        If it has more of them than `limits` allow.
    """
    limits.check_pixels(sheet.width, sheet.height)
    canvas = Image.new("RGB", (sheet.width, sheet.height), PAPER)
    for item in sheet.items:
        _PAINTERS[type(item)](canvas, item)
    return np.asarray(canvas)


def _paste(canvas: Image.Image, item: Pixels) -> None:
    canvas.paste(Image.fromarray(item.array), (item.x, item.y))


def _paste_mesh(canvas: Image.Image, item: MeshPart) -> None:
    canvas.paste(Image.fromarray(item.pixels), (item.view.x, item.view.y))


def _stroke(canvas: Image.Image, item: Strokes) -> None:
    """Draw strokes on a larger mask, whose means say how much of a pixel they cover."""
    view = item.view
    mask = Image.new("L", (view.width * _SAMPLES, view.height * _SAMPLES))
    draw = ImageDraw.Draw(mask)
    width = max(1, round(item.width * _SAMPLES))
    radius = item.width * _SAMPLES / 2
    # Pillow counts from the middle of the first sample.
    for x0, y0, x1, y1 in (item.placed.reshape(-1, 4) * _SAMPLES - 0.5).tolist():
        if (x0, y0) == (x1, y1):
            draw.ellipse((x0 - radius, y0 - radius, x0 + radius, y0 + radius), fill=255)
        else:
            draw.line((x0, y0, x1, y1), fill=255, width=width)
    canvas.paste(item.color, (view.x, view.y), mask.reduce(_SAMPLES))


def _frame(canvas: Image.Image, item: Frame) -> None:
    corners = (item.x - 1, item.y - 1, item.x + item.width, item.y + item.height)
    ImageDraw.Draw(canvas).rectangle(corners, outline=item.color)


def _write(canvas: Image.Image, item: Label) -> None:
    place = (item.left, item.y)
    font = font_of(item.size)
    ImageDraw.Draw(canvas).text(place, item.text, fill=item.color, font=font, anchor="ls")


_PAINTERS: Final[dict[type, Callable[[Image.Image, Any], None]]] = {
    Pixels: _paste,
    MeshPart: _paste_mesh,
    Strokes: _stroke,
    Frame: _frame,
    Label: _write,
}
