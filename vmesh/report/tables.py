"""The tables of a report: PSNR at equal bytes, bytes by part, times."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from typing import Any

from vmesh.report.rivals import Curve


def sizes_table(curves: Sequence[Curve]) -> str:
    """PSNR by codec for each size of the first one's files: of the largest file within it."""
    drawn = [curve for curve in curves if curve.points]
    rows = []
    for budget, _ in curves[0].points:
        fits = ([p.psnr for p in curve.points if p.n_bytes <= budget] for curve in drawn)
        rows.append([f"{budget:,}", *(decibels(found[-1]) if found else "–" for found in fits)])
    codecs = [curve.codec for curve in drawn]
    return _table("PSNR in dB at equal bytes", ["bytes", *codecs], rows)


def parts_table(figures: Mapping[str, Any]) -> str:
    """Bytes of each part of a file, by the figures of the file, and last those of the file."""
    parts = [*figures["parts"], {"part": "file", **figures}]
    rows = [(x["part"], f"{x['bytes']:,}", f"{x['bits_per_vertex']:.2f}") for x in parts]
    return _table("Bytes by part", ["part", "bytes", "bits per vertex"], rows)


def times_table(seconds: Mapping[str, float]) -> str:
    """Seconds that each stage took."""
    rows = [(stage, f"{duration:.3f}") for stage, duration in seconds.items()]
    return _table("Time", ["stage", "seconds"], rows)


def decibels(value: float) -> str:
    """A PSNR as text: infinite if the pictures are equal."""
    return f"{value:.2f}" if math.isfinite(value) else "∞"


def _table(caption: str, head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table of text; the first cell of each row names it."""
    names = "".join(f'<th scope="col">{escape(cell)}</th>' for cell in head)
    lines = [f"<table><caption>{escape(caption)}</caption>", f"<tr>{names}</tr>"]
    for first, *rest in rows:
        cells = "".join(f"<td>{escape(cell)}</td>" for cell in rest)
        lines.append(f'<tr><th scope="row">{escape(first)}</th>{cells}</tr>')
    return "\n".join([*lines, "</table>"])
