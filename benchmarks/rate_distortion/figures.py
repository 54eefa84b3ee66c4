"""Figures of what the codecs made of the pictures, a row for each."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Final

from PIL import Image

from benchmarks.photographs import Photograph
from benchmarks.raster.codecs import available_codecs
from benchmarks.raster.search import Coded
from benchmarks.software import import_optional
from vmesh.arrays import UInt8Array
from vmesh.metrics import compare

VMESH: Final = "vmesh"


@dataclass(frozen=True, slots=True)
class Row:
    """Figures of a codec and a picture at one point: a rate, a size or a task of the part."""

    part: str
    picture: str
    point: str
    budget: int
    codec: str
    settings: str
    n_bytes: int
    psnr_rgb: float
    psnr_y: float
    ssim: float
    ssimulacra2: float
    encode_seconds: float
    decode_seconds: float


def row_of(
    part: str,
    photograph: Photograph,
    point: str,
    budget: int,
    coded: Coded,
    perceptual: bool = True,
) -> Row:
    """Row of a picture that came back from a file."""
    measures = compare(photograph.pixels, coded.pixels)
    return Row(
        part,
        photograph.name,
        point,
        budget,
        coded.codec,
        coded.settings,
        coded.n_bytes,
        measures["psnr_rgb"],
        measures["psnr_y"],
        measures["ssim"],
        ssimulacra2(photograph.pixels, coded.pixels) if perceptual else math.nan,
        coded.encode_seconds,
        coded.decode_seconds,
    )


def ssimulacra2(original: UInt8Array, decoded: UInt8Array) -> float:
    """The perceptual measure SSIMULACRA2, at most 100; not a number without its package."""
    module = import_optional("ssimulacra2")
    if module is None:
        return math.nan
    return float(module.compute_ssimulacra2(*map(as_file, (original, decoded))))


def as_file(pixels: UInt8Array) -> io.BytesIO:
    """A picture as a lossless file in memory."""
    stream = io.BytesIO()
    Image.fromarray(pixels).save(stream, "BMP")
    stream.seek(0)
    return stream


def write_rows(path: Path, rows: Sequence[Row]) -> None:
    """Write all rows as a table with commas."""
    with path.open("w", newline="") as stream:
        writer = csv.DictWriter(stream, [field.name for field in fields(Row)])
        writer.writeheader()
        writer.writerows(asdict(row) for row in rows)


def points_of(rows: Iterable[Row]) -> list[str]:
    """The rates or sizes of some rows."""
    return list(dict.fromkeys(row.point for row in rows))


def pictures_of(rows: Iterable[Row]) -> list[str]:
    """The pictures of some rows."""
    return list(dict.fromkeys(row.picture for row in rows))


def codecs_of(rows: Iterable[Row]) -> list[str]:
    """The codecs of some rows, vmesh first and the others in the order of `available_codecs`."""
    found = dict.fromkeys(row.codec for row in rows)
    order = [VMESH, *available_codecs()]
    return sorted(found, key=lambda codec: order.index(codec) if codec in order else len(order))
