"""What the codecs made of the pictures: rows of figures, and the tables that compare vmesh."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from statistics import mean
from typing import Final

from PIL import Image

from benchmarks.measurement import Photograph, Table, import_optional
from benchmarks.raster_codecs import Coded, available_codecs
from vmesh.arrays import UInt8Array
from vmesh.metrics import compare

VMESH: Final = "vmesh"
METRICS: Final = {
    "psnr_rgb": ("PSNR (RGB), dB", 2),
    "psnr_y": ("PSNR (luma), dB", 2),
    "ssim": ("SSIM", 4),
    "ssimulacra2": ("SSIMULACRA2", 1),
}


@dataclass(frozen=True, slots=True)
class Row:
    """What one codec made of one picture at one point: a rate, a size or a task of the part."""

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


def means_table(rows: list[Row], metric: str) -> Table:
    """Means of a metric: a row for each codec, a column for each point."""
    name, digits = METRICS[metric]
    points = points_of(rows)
    n_pictures = len(pictures_of(rows))
    lines = [
        (
            codec,
            *(
                mean_cell(Figures(rows, point, metric), codec, digits, n_pictures)
                for point in points
            ),
        )
        for codec in codecs_of(rows)
    ]
    title = f"{name}: mean of {n_pictures} picture{'s' * (n_pictures != 1)} (vmesh less the codec)"
    return Table(title, ("codec", *points), lines)


class Figures:
    """A metric of every picture and codec at one point."""

    def __init__(self, rows: Iterable[Row], point: str, metric: str) -> None:
        self._values = {
            (row.picture, row.codec): float(getattr(row, metric))
            for row in rows
            if row.point == point
        }

    def of(self, codec: str) -> list[float]:
        """The codec's figures, of the pictures that it reached."""
        return [value for (_, own), value in self._values.items() if own == codec]

    def gains(self, codec: str) -> list[float]:
        """What vmesh has more than the codec, of the pictures that both reached."""
        return [
            self._values[picture, VMESH] - value
            for (picture, own), value in self._values.items()
            if own == codec and (picture, VMESH) in self._values
        ]


def mean_cell(figures: Figures, codec: str, digits: int, n_pictures: int) -> str:
    """A codec's mean, that of vmesh less it, and how many pictures it reached if not all."""
    reached = figures.of(codec)
    if not reached:
        return "-"
    cell = f"{mean(reached):.{digits}f}"
    gains = figures.gains(codec)
    if codec != VMESH and gains:
        cell += f" ({mean(gains):+.{digits}f})"
    return cell if len(reached) == n_pictures else f"{cell} of {len(reached)}"


def seconds_table(rows: list[Row]) -> Table:
    """Mean seconds of encoding and decoding: a row for each codec, a column for each point."""
    title = "Seconds of one encoding / milliseconds of one decoding, means (searches not counted)"
    return table_of_points(rows, title, seconds_cell)


def seconds_cell(rows: list[Row]) -> str:
    """Mean seconds of encoding and milliseconds of decoding of a codec at a point."""
    encoding = mean(row.encode_seconds for row in rows)
    decoding = mean(row.decode_seconds for row in rows)
    return f"{encoding:.2f} / {1e3 * decoding:.0f}"


def shares_table(rows: list[Row]) -> Table:
    """Mean share of the budget that was used: a row for each codec, a column for each point."""
    return table_of_points(rows, "Bytes used of those allowed, means", share_cell)


def share_cell(rows: list[Row]) -> str:
    """Mean share of the budget that a codec used at a point."""
    return f"{mean(row.n_bytes / row.budget for row in rows):.1%}"


def table_of_points(rows: list[Row], title: str, cell: Callable[[list[Row]], str]) -> Table:
    """A row for each codec, a column for each point, a dash where the codec did not reach it."""
    points = points_of(rows)
    lines = []
    for codec in codecs_of(rows):
        cells = []
        for point in points:
            own = [row for row in rows if (row.codec, row.point) == (codec, point)]
            cells.append(cell(own) if own else "-")
        lines.append((codec, *cells))
    return Table(title, ("codec", *points), lines)


def pictures_table(rows: list[Row], point: str) -> Table:
    """PSNR of every picture at one point: a row for each picture, a column for each codec."""
    codecs = [codec for codec in codecs_of(rows) if codec != VMESH]
    lines = []
    for picture in pictures_of(rows):
        own = {row.codec: row for row in rows if row.picture == picture}
        ours = own.get(VMESH)
        cells = [str(next(iter(own.values())).budget)]
        cells.append("-" if ours is None else f"{ours.psnr_rgb:.2f}")
        cells += [picture_cell(own.get(codec), ours) for codec in codecs]
        lines.append((picture, *cells))
    title = f"{point}: PSNR (RGB) in dB (vmesh less the codec)"
    return Table(title, ("picture", "bytes", VMESH, *codecs), lines)


def picture_cell(row: Row | None, ours: Row | None) -> str:
    """A codec's PSNR of a picture, starred at half its size, and that of vmesh less it."""
    if row is None:
        return "-"
    cell = f"{row.psnr_rgb:.2f}" + "*" * row.settings.endswith("half")
    return cell if ours is None else f"{cell} ({ours.psnr_rgb - row.psnr_rgb:+.2f})"


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
