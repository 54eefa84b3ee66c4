"""Whole processes: the time from start to end, and the most memory that they hold."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Final

from PIL import Image

from benchmarks.measurement import Timing, judge, measure_process, time_actions
from benchmarks.tables import Printer, Table
from vmesh.arrays import UInt8Array
from vmesh.formats.picture.conversion import resize

SMALL_SIDE: Final = 128
TARGET_START: Final = 300.0  # ms
HELP: Final = "`vmesh --help`"
INFO: Final = "`vmesh info`"

VMESH: Final = (sys.executable, "-m", "vmesh")


class CommandLine:
    """The command ``vmesh`` in processes of its own, on a small and on a large picture."""

    def __init__(self, folder: Path, pixels: UInt8Array, large: tuple[int, int]) -> None:
        self.small = folder / "small.png"
        self.large = folder / "large.png"
        self.mesh = folder / "photo.vmesh"
        self._empty_cache = os.environ | {"NUMBA_CACHE_DIR": str(folder / "cache")}
        Image.fromarray(pixels[:SMALL_SIDE, :SMALL_SIDE]).save(self.small)
        Image.fromarray(resize(pixels, large)).save(self.large, compress_level=1)

    def run(self, *command: str) -> None:
        """Run a process."""
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)

    def encode(self) -> None:
        """Encode the small picture with the default settings."""
        self.run(*self._encoding(self.small))

    def encode_first(self) -> None:
        """Encode the small picture with nothing compiled before."""
        command = self._encoding(self.small)
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL, env=self._empty_cache)

    def encode_measured(self, picture: Path) -> tuple[dict[str, Any], int]:
        """Figures of an encoding and the most memory that its process held, in bytes."""
        figures, peak = measure_process(*self._encoding(picture))
        return json.loads(figures), peak

    def _encoding(self, picture: Path) -> tuple[str, ...]:
        return (*VMESH, "encode", str(picture), str(self.mesh), "--json")


def report_starts(printer: Printer, bench: CommandLine, runs: int) -> None:
    """Print how long processes take from their start to their end."""
    actions: dict[str, Callable[[], object]] = {
        "an empty Python program": lambda: bench.run(sys.executable, "-c", "pass"),
        "`import vmesh`": lambda: bench.run(sys.executable, "-c", "import vmesh"),
        HELP: lambda: bench.run(*VMESH, "--help"),
        "`vmesh encode`": bench.encode,
        INFO: lambda: bench.run(*VMESH, "info", str(bench.mesh)),
    }
    timings = time_actions(actions, runs)
    printer.heading("Cold starts")
    header = ("process", "median", "min", "max", "target", "median against target")
    rows = [
        (name, *timing.cells(), *start_target(name, timing)) for name, timing in timings.items()
    ]
    printer.table(Table("Whole processes, in ms", header, rows))
    printer.paragraph(
        f"Runs of each: {runs}, in turns after one that is not counted. Encoded are at most "
        f"{SMALL_SIDE} x {SMALL_SIDE} pixels."
    )


def report_first_run(printer: Printer, bench: CommandLine) -> None:
    """Print how long the first encoding of an installation takes."""
    started = time.perf_counter()
    bench.encode_first()
    seconds = time.perf_counter() - started
    printer.heading("The first run")
    rows = [("`vmesh encode`, compiling everything", f"{seconds:.1f}")]
    printer.table(Table("A whole process, in s", ("process", "one run"), rows))
    printer.paragraph("The same small picture, with an empty `NUMBA_CACHE_DIR`.")


def start_target(name: str, timing: Timing) -> tuple[str, str]:
    """Target and verdict of a process's row."""
    if name not in (HELP, INFO):
        return "-", "-"
    return f"{TARGET_START:.0f}", judge(timing.median * 1e3, TARGET_START)


def report_memory(printer: Printer, bench: CommandLine) -> None:
    """Print the peak memory of encodings of a small and of a large picture."""
    printer.heading("Memory")
    rows = list(memory_rows(bench))
    header = ("picture", "vertices", "seconds", "peak, MB", "bytes per pixel over the first")
    printer.table(Table("`vmesh encode` at default settings", header, rows))
    printer.paragraph(
        "The most resident memory of the process, Python and its libraries included; seconds are "
        "of one run, from reading to writing. The large picture is the photograph enlarged."
    )


def memory_rows(bench: CommandLine) -> Iterator[tuple[str, ...]]:
    """Figures of a picture too small to matter and of a large one."""
    bench.encode()  # what it compiles is no memory of an encoding
    base = 0
    for picture in (bench.small, bench.large):
        figures, peak = bench.encode_measured(picture)
        pixels = figures["width"] * figures["height"]
        yield (
            f"{figures['width']} x {figures['height']}",
            str(figures["vertices"]),
            f"{figures['seconds']:.2f}",
            f"{peak / 1e6:.0f}",
            f"{(peak - base) / pixels:.0f}" if base else "-",
        )
        base = peak
