"""Write ``docs/equal-bytes.webp``: a photograph by vmesh, WebP and JPEG, in equal bytes.

``python -m tools.equal_bytes`` takes a photograph of the tests. WebP and JPEG are the best by PSNR
that the search of the benchmarks finds in the bytes of the mesh, at full size or at half of it.
"""

from __future__ import annotations

import io
from pathlib import Path
from typing import Final, NamedTuple

import click
import numpy as np
from PIL import Image, ImageDraw, ImageFont

import vmesh
from benchmarks.raster.codecs import JPEG, WEBP
from benchmarks.raster.search import CodecSearch
from tools.gallery import encode
from vmesh.arrays import UInt8Array
from vmesh.formats.picture.conversion import flatten
from vmesh.formats.picture.picture import read_picture
from vmesh.metrics import psnr

_ROOT: Final = Path(__file__).parents[1]
_PHOTOGRAPH: Final = _ROOT / "tests" / "images" / "astronaut.png"
_TARGET: Final = _ROOT / "docs" / "equal-bytes.webp"

_GAP: Final = 8  # pixels between panels
_LINE: Final = 26  # pixels of a label's height
_LETTERS: Final = 16
_QUALITY: Final = 95  # high enough to add nothing to see to what the codecs did


class Panel(NamedTuple):
    """A photograph that came back from a file: shape (h, w, 3), uint8, and the file's bytes."""

    name: str
    n_bytes: int
    pixels: UInt8Array


@click.command()
@click.option(
    "--photograph",
    type=click.Path(exists=True, dir_okay=False, path_type=Path),
    default=_PHOTOGRAPH,
    help="A photograph; one of the tests unless given.",
)
@click.option("--bits", type=click.FloatRange(0.01, 8), default=0.15, help="Bits for each pixel.")
@click.option("--effort", type=click.IntRange(1, 9), default=9, help="Of the encoder.")
@click.option(
    "--region",
    type=click.IntRange(min=0),
    nargs=4,
    default=(110, 0, 300, 300),
    help="What is shown: x, y, width, height. The whole photograph is encoded.",
)
@click.option("--output", type=click.Path(path_type=Path), default=_TARGET, help="The picture.")
def main(
    photograph: Path, bits: float, effort: int, region: tuple[int, int, int, int], output: Path
) -> None:
    """Write a region of a photograph as vmesh, WebP and JPEG show it in equal bytes."""
    with photograph.open("rb") as stream:
        pixels = flatten(read_picture(stream).array)
    panels = panels_of(pixels, bits, effort)
    output.write_bytes(side_by_side(pixels, panels, region))
    for panel in panels:
        click.echo(label_of(panel, pixels))


def panels_of(pixels: UInt8Array, bits: float, effort: int) -> list[Panel]:
    """Panels of a mesh and the other codecs; none of a codec without so small a file."""
    data = encode(pixels, bits, effort)
    search = CodecSearch(pixels)
    others = [search.best(codec, len(data)) for codec in (WEBP, JPEG)]
    return [
        Panel("vmesh", len(data), flatten(vmesh.render(vmesh.loads(data)))),
        *(Panel(coded.codec, coded.n_bytes, coded.pixels) for coded in others if coded),
    ]


def label_of(panel: Panel, pixels: UInt8Array) -> str:
    """Name, bytes and PSNR over all of the photograph."""
    return f"{panel.name}: {panel.n_bytes:,} bytes, {psnr(pixels, panel.pixels):.1f} dB"


def side_by_side(
    pixels: UInt8Array, panels: list[Panel], region: tuple[int, int, int, int]
) -> bytes:
    """WebP file of the panels' regions, each above its label."""
    x, y, width, height = region
    size = (len(panels) * (width + _GAP) - _GAP, height + _LINE)
    sheet = Image.new("RGB", size, "white")
    draw, font = ImageDraw.Draw(sheet), ImageFont.load_default(_LETTERS)
    for number, panel in enumerate(panels):
        left = number * (width + _GAP)
        shown = np.ascontiguousarray(panel.pixels[y : y + height, x : x + width])
        sheet.paste(Image.fromarray(shown), (left, 0))
        middle = (left + width / 2, height + _LINE / 2)
        draw.text(middle, label_of(panel, pixels), "black", font, anchor="mm")
    stream = io.BytesIO()
    sheet.save(stream, "WEBP", quality=_QUALITY, method=6)
    return stream.getvalue()


if __name__ == "__main__":
    main()
