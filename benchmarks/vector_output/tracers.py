"""Photographs as SVG by vtracer, from coarse to fine: what a user would pick instead."""

from __future__ import annotations

import io
import time
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from typing import Final

from PIL import Image

from benchmarks.photographs import Photograph
from benchmarks.software import import_optional

# What decides on size and quality: bits of a colour, levels between layers, area of specks that
# are left out. Finer than the first, files of photographs pass 20 MB.
_FINENESS: Final = ((8, 2, 1), (8, 8, 4), (6, 16, 4), (5, 32, 4), (4, 48, 8))
_SHAPES: Final = ("polygon", "spline")


@dataclass(frozen=True, slots=True)
class Tracing:
    """A traced photograph: how it was made, the document, and the seconds that it took."""

    settings: str
    svg: bytes
    seconds: float


def tracings_of(photograph: Photograph) -> Iterator[Tracing]:
    """Tracings of a photograph; none if vtracer is not installed."""
    vtracer = import_optional("vtracer")
    if vtracer is None:
        return
    stream = io.BytesIO()
    Image.fromarray(photograph.pixels).save(stream, "PNG")
    for (precision, difference, speckle), shape in product(_FINENESS, _SHAPES):
        started = time.perf_counter()
        svg = vtracer.convert_raw_image_to_svg(
            stream.getvalue(),
            img_format="png",
            colormode="color",
            hierarchical="stacked",
            mode=shape,
            filter_speckle=speckle,
            color_precision=precision,
            layer_difference=difference,
            path_precision=1,
        )
        seconds = time.perf_counter() - started
        settings = (
            f"vtracer, {shape}, {precision} bits, layers of {difference}, specks of {speckle}"
        )
        yield Tracing(settings, svg.encode(), seconds)
