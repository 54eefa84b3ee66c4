"""Times and memory of what is measured, and bounds that they are held against."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from statistics import median
from typing import Final

# In a small process of its own: the peak that a process is charged with starts at its parent's.
_MEASURE_CHILD: Final = """
import resource, subprocess, sys
subprocess.run(sys.argv[1:], check=True)
peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
print(peak if sys.platform == "darwin" else 1024 * peak)
"""


@dataclass(frozen=True, slots=True)
class Timing:
    """Seconds that an action took: the median of its runs, the shortest and the longest."""

    median: float
    shortest: float
    longest: float

    def cells(self, unit: float = 1e-3) -> tuple[str, str, str]:
        """The three figures in units of `unit` seconds."""
        figures = (self.median, self.shortest, self.longest)
        first, second, third = (f"{seconds / unit:.2f}" for seconds in figures)
        return first, second, third


def time_actions(actions: Mapping[str, Callable[[], object]], runs: int) -> dict[str, Timing]:
    """Times of several actions, taken in turns so that other load falls on all of them alike.

    Each is run once before, so that its code is compiled and its data are in the caches.
    """
    for action in actions.values():
        action()
    seconds: dict[str, list[float]] = {name: [] for name in actions}
    for _ in range(runs):
        for name, action in actions.items():
            started = time.perf_counter()
            action()
            seconds[name].append(time.perf_counter() - started)
    return {name: Timing(median(own), min(own), max(own)) for name, own in seconds.items()}


def measure_process(*command: str, environment: Mapping[str, str] | None = None) -> tuple[str, int]:
    """Output of a process, and the most memory that it held, in bytes."""
    measuring = (sys.executable, "-c", _MEASURE_CHILD, *command)
    printed = subprocess.run(
        measuring, check=True, env=environment, stdout=subprocess.PIPE, text=True
    ).stdout
    own, _, peak = printed.rstrip().rpartition("\n")
    return own, int(peak)


def judge(found: float, most: float) -> str:
    """Verdict on a figure that should be small: "met", or by how much its bound is missed."""
    return "met" if found <= most else f"missed by {found / most - 1:.0%}"


def judge_speed(found: float, least: float) -> str:
    """Verdict on a speed: "met", or by how much its bound is missed."""
    return "met" if found >= least else f"missed by {1 - found / least:.0%}"
