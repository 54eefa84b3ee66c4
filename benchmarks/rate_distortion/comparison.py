"""Tables that compare vmesh with the codecs by their figures."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from statistics import mean
from typing import Final

from benchmarks.photographs import n_pictures
from benchmarks.rate_distortion.figures import VMESH, Row, codecs_of, pictures_of, points_of
from benchmarks.tables import Table

METRICS: Final = {
    "psnr_rgb": ("PSNR (RGB), dB", 2),
    "psnr_y": ("PSNR (luma), dB", 2),
    "ssim": ("SSIM", 4),
    "ssimulacra2": ("SSIMULACRA2", 1),
}


def means_table(rows: list[Row], metric: str) -> Table:
    """Means of a metric: a row for each codec, a column for each point."""
    name, digits = METRICS[metric]
    points = points_of(rows)
    n = len(pictures_of(rows))
    lines = [
        (
            codec,
            *(mean_cell(Figures(rows, point, metric), codec, digits, n) for point in points),
        )
        for codec in codecs_of(rows)
    ]
    title = f"{name}: mean of {n_pictures(n)} (vmesh less the codec)"
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
        """Gains of vmesh over the codec, of the pictures that both reached."""
        return [
            self._values[picture, VMESH] - value
            for (picture, own), value in self._values.items()
            if own == codec and (picture, VMESH) in self._values
        ]


def mean_cell(figures: Figures, codec: str, digits: int, n: int) -> str:
    """A codec's mean, that of vmesh less it, and how many pictures it reached if not all `n`."""
    reached = figures.of(codec)
    if not reached:
        return "-"
    cell = f"{mean(reached):.{digits}f}"
    gains = figures.gains(codec)
    if codec != VMESH and gains:
        cell += f" ({mean(gains):+.{digits}f})"
    return cell if len(reached) == n else f"{cell} of {len(reached)}"


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
