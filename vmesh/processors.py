"""Processors that this process may use, which may be fewer than the machine has."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path, PurePosixPath

_ROOT = Path("/")


def count_processors() -> int:
    """Number of processors: those the process may run on, within its share of their time.

    A process may be bound to some of them, as by ``taskset``. A container may have them all and yet
    only as much of their time as some of them have; a part of one counts as one.
    """
    try:
        n_processors = len(os.sched_getaffinity(0))
    except (AttributeError, OSError):  # Not every system binds processes.
        n_processors = os.cpu_count() or 1
    share = quota()
    return n_processors if share is None else max(1, min(n_processors, math.ceil(share)))


def quota(root: Path = _ROOT) -> float | None:
    """Share of time that the control groups of Linux, of either version, leave to this process.

    Parameters
    ----------
    root : Path, optional
        Folder that holds ``proc`` and ``sys``.

    Returns
    -------
    float or None
        Processors, of which the last may be a part; None if there is no limit.

    References
    ----------
    Linux kernel documentation, "Control Group v2", interface file ``cpu.max``; "CFS Bandwidth
    Control", files ``cpu.cfs_quota_us`` and ``cpu.cfs_period_us``.
    """
    shares = []
    for folder in _control_groups(root):
        # Whatever is not there, or has another form, is no limit.
        with suppress(OSError, ValueError, ZeroDivisionError):
            most, period = (folder / "cpu.max").read_text().split()
            shares.append(int(most) / int(period))
        with suppress(OSError, ValueError, ZeroDivisionError):
            most = (folder / "cpu.cfs_quota_us").read_text()
            period = (folder / "cpu.cfs_period_us").read_text()
            shares.append(int(most) / int(period))
    return min((share for share in shares if share > 0), default=None)


def _control_groups(root: Path) -> Iterator[Path]:
    """Folders of the control groups of this process, and of those around them.

    In a container the file names paths outside of it; what is there is at the root then.
    """
    lines = ["0::/", "1:cpu:/"]
    with suppress(OSError):
        lines += (root / "proc" / "self" / "cgroup").read_text(errors="replace").splitlines()
    base = root / "sys" / "fs" / "cgroup"
    for line in lines:
        _, _, rest = line.partition(":")
        controllers, _, path = rest.partition(":")
        if controllers and "cpu" not in controllers.split(","):
            continue
        for mounted in (controllers, "cpu") if controllers else ("", "unified"):
            inner = PurePosixPath(path.lstrip("/"))
            if ".." not in inner.parts:
                for group in (inner, *inner.parents):
                    yield base / mounted / group
