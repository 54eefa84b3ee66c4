"""The size at which an SVG document shows, which is told beside its canvas."""

from __future__ import annotations

import re
from typing import Final

import numpy as np

from vmesh.mesh import Mesh

_LENGTH: Final = re.compile(r"(\d+\.?\d*|\.\d+)(px|pt|pc|mm|cm|in|em|ex|%)?")
_LARGEST: Final = 1e6
_DIGITS: Final = 6

Length = str | float


def size_attributes(
    mesh: Mesh, width: Length | None = None, height: Length | None = None
) -> dict[str, str]:
    """Attributes ``width`` and ``height``: as they are asked for, else the canvas in pixels.

    One of them alone keeps the proportions, and a percentage leaves the other to the program that
    shows the document. With both, programs show the picture in the middle of a box of that size, as
    large as it fits.
    """
    if width is None and height is None:
        width = mesh.width
    asked = {"width": width, "height": height}
    lengths = {name: parse_length(given) for name, given in asked.items() if given is not None}
    name, (number, unit) = next(iter(lengths.items()))
    if len(lengths) == 1 and unit != "%":
        scale = number / getattr(mesh, name)
        lengths = {side: (scale * getattr(mesh, side), unit) for side in asked}
    return {name: f"{_shortest(number)}{unit}" for name, (number, unit) in lengths.items()}


def parse_length(length: Length) -> tuple[float, str]:
    """Number and unit of a length of CSS, such as ``800``, ``"210mm"`` or ``"100%"``.

    Raises
    ------
    ValueError
        If it is not a positive number, of at most a million, alone or with a unit that SVG has.
    """
    match = _LENGTH.fullmatch(str(length).strip().lower())
    number = float(match[1]) if match else 0.0
    if match is None or not 0 < number <= _LARGEST:
        raise ValueError(f"expected a length such as 800, 210mm or 100%, got {str(length)!r}")
    return number, match[2] or ""


def _shortest(number: float) -> str:
    """A number as text without an exponent, which not all programs read."""
    return np.format_float_positional(number, _DIGITS, fractional=False, trim="-")
