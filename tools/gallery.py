"""Write ``docs/gallery.md``: photographs beside their meshes, with figures.

``python -m tools.gallery --images DIR`` takes the pictures that it knows the source and licence of
from a folder, such as ``skimage/data`` of an installed scikit-image.
"""

from __future__ import annotations

import io
import textwrap
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import click
import numpy as np
from PIL import Image

import vmesh
from benchmarks.options import images_option
from benchmarks.photographs import load_photographs
from benchmarks.raster.codecs import JPEG, WEBP
from benchmarks.raster.search import CodecSearch
from vmesh.arrays import UInt8Array
from vmesh.formats.picture.conversion import flatten
from vmesh.metrics import psnr

TARGET: Final = Path(__file__).parents[1] / "docs" / "gallery.md"

_SIDE: Final = 400  # pixels of a picture's longer side in the document
_GAP: Final = 8
_MOST_BYTES: Final = 40_000
_QUALITIES: Final = range(80, 20, -5)
_START: Final = """# Gallery

Each photograph is on the left and its mesh on the right, at {bits:g} bits per pixel and effort
{effort}: `vmesh encode PHOTO out.vmesh --target-size BYTES --effort {effort}`. Both are reduced to
at most {side} pixels a side here. PSNR is over RGB, in dB and at full size; JPEG and WebP are the
best that the searches of [rate-distortion.md](rate-distortion.md) find in as many bytes. When to
use meshes, and when not, is in the [tutorial](tutorial.md#when-to-use-it).

Written by `python -m tools.gallery --images DIR`, from the data of
[scikit-image](https://scikit-image.org) 0.26, whose notes the sources and licences are taken from.
"""


@dataclass(frozen=True, slots=True)
class Entry:
    """Text about a picture: its kind, its source with the licence, and what to look at."""

    kind: str
    source: str
    remark: str


ENTRIES: Final = {
    "astronaut": Entry(
        "A portrait",
        "Eileen Collins, by [NASA](https://flic.kr/p/r9qvLn); public domain",
        "Skin and cloth are smooth and take few triangles; letters on patches are lost.",
    ),
    "chelsea": Entry(
        "An animal",
        "Chelsea the cat, by Stéfan van der Walt; CC0",
        "The eyes keep their shape; of the fur a few strokes are left.",
    ),
    "coffee": Entry(
        "Food",
        "A cup of coffee, by Rachel Michetti; CC0",
        "Long edges and soft shadows suit triangles; the grain of the wood is gone.",
    ),
    "rocket": Entry(
        "A sky",
        "The launch of DSCOVR, by "
        "[SpaceX](https://www.flickr.com/photos/spacexphotos/16511594820/); public domain",
        "The sky takes few triangles, so that the bytes go to rocket and lights; of the "
        "lattices of the towers little is left.",
    ),
    "hubble_deep_field": Entry(
        "Stars",
        "The eXtreme Deep Field, by [NASA and ESA]"
        "(http://hubblesite.org/newscenter/archive/releases/2012/37/image/a/); public domain",
        "A hard case: each point of light needs several vertices of its own. The faint ones are "
        "left out, and stains show on the black. PSNR, by which it is ahead, says little where "
        "most of a picture is dark.",
    ),
    "grass": Entry(
        "A texture",
        "Grass, by [linolafett](https://www.deviantart.com/linolafett/art/Grass-01-434853879); CC0",
        "The worst case: detail everywhere, where meshes are behind JPEG and WebP, and look it.",
    ),
}


@click.command()
@images_option
@click.option("--bits", type=click.FloatRange(0.01, 8), default=0.2, help="Bits for each pixel.")
@click.option("--effort", type=click.IntRange(1, 9), default=7, help="Of the encoder.")
@click.option(
    "--output", "target", type=click.Path(path_type=Path), default=TARGET, help="The document."
)
def main(folder: Path, bits: float, effort: int, target: Path) -> None:
    """Write the gallery; its pictures stand in a folder of its name beside it."""
    found = {photo.name: photo.pixels for photo in load_photographs(folder, names=tuple(ENTRIES))}
    pictures = target.with_suffix("")
    pictures.mkdir(exist_ok=True)
    parts = [_START.format(bits=bits, effort=effort, side=_SIDE)]
    for name in (name for name in ENTRIES if name in found):
        pixels = found[name]
        data = encode(pixels, bits, effort)
        drawn = flatten(vmesh.render(vmesh.loads(data)))
        (pictures / f"{name}.webp").write_bytes(side_by_side(pixels, drawn))
        parts.append(section(f"{pictures.name}/{name}.webp", ENTRIES[name], pixels, data, drawn))
        click.echo(name)
    target.write_text("\n".join(parts), "utf-8", newline="\n")


def encode(pixels: UInt8Array, bits: float, effort: int) -> bytes:
    """The file of a picture with so many bits for each of its pixels."""
    budget = round(bits * pixels.shape[0] * pixels.shape[1] / 8)
    return vmesh.dumps(vmesh.encode(pixels, target_size=budget, effort=effort))


def section(picture: str, entry: Entry, pixels: UInt8Array, data: bytes, drawn: UInt8Array) -> str:
    """The part of the document about a picture."""
    mesh = vmesh.loads(data)
    n_pixels = mesh.width * mesh.height
    search = CodecSearch(pixels)
    others = {codec: search.best(codec, len(data)) for codec in (JPEG, WEBP)}
    cells = {
        "pixels": f"{mesh.width} x {mesh.height}",
        "bytes": f"{len(data):,}",
        "bits per pixel": f"{8 * len(data) / n_pixels:.3f}",
        "vertices": f"{mesh.n_vertices:,}",
        "triangles": f"{mesh.n_triangles:,}",
        "PSNR": f"{psnr(pixels, drawn):.2f}",
        **{
            codec: f"{psnr(pixels, coded.pixels):.2f}" if coded else "no file so small"
            for codec, coded in others.items()
        },
    }
    lines = (list(cells), ["---:"] * len(cells), list(cells.values()))
    table = "\n".join(f"| {' | '.join(line)} |" for line in lines)
    return (
        f"## {entry.kind}\n\n![{entry.kind}: the photograph, and its mesh]({picture})\n\n"
        f"{_wrapped(f'{entry.source}. {entry.remark}')}\n\n{table}\n"
    )


def _wrapped(text: str) -> str:
    return textwrap.fill(text, 100, break_long_words=False, break_on_hyphens=False)


def side_by_side(first: UInt8Array, second: UInt8Array) -> bytes:
    """WebP file of two pictures, reduced, side by side, of at most 40,000 bytes."""
    images = [Image.fromarray(pixels) for pixels in (first, second)]
    for image in images:
        image.thumbnail((_SIDE, _SIDE), Image.Resampling.LANCZOS)
    width, height = images[0].size
    joined = np.full((height, 2 * width + _GAP, 3), 255, np.uint8)
    joined[:, :width], joined[:, -width:] = (np.asarray(image) for image in images)
    for quality in _QUALITIES:
        stream = io.BytesIO()
        Image.fromarray(joined).save(stream, "WEBP", quality=quality, method=6)
        if stream.tell() <= _MOST_BYTES:
            break
    return stream.getvalue()


if __name__ == "__main__":
    main()
