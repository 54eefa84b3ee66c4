"""Work on a mesh in shares that do not touch each other, for several threads.

A mesh is cut into bands of rows. Vertices whose neighbours are all in their own band come first,
every band at the same time; then those along the cuts, every cut at the same time; and last what is
left. What is done does not depend on the number of threads, only the time does.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any, Final

import numpy as np

from vmesh.arrays import BoolArray, Int64Array

_BAND: Final = 128  # rows of half pixels; not to be changed with the number of threads
_SHARE: Final = 4096  # items of a job that needs no order
_MAX_THREADS: Final = 16

Run = Callable[[Callable[..., Any], Iterable[Any]], Iterator[Any]]
"""Calls a function with each of some arguments; the results in their order, as they come."""


@contextmanager
def workers(n_threads: int | None) -> Iterator[Run]:
    """A way to run jobs on some threads, by default as many as there are processors."""
    if n_threads is None:
        n_threads = min(os.cpu_count() or 1, _MAX_THREADS)
    if n_threads == 1:
        yield run_here
        return
    pool = ThreadPoolExecutor(n_threads)
    try:
        yield pool.map
    finally:
        # After an error what has not begun is not worth waiting for.
        pool.shutdown(cancel_futures=True)


def run_here(function: Callable[..., Any], arguments: Iterable[Any]) -> Iterator[Any]:
    """Call a function with each of some arguments, one after the other."""
    return map(function, arguments)


def shares(n_items: int) -> list[tuple[int, int]]:
    """First and last of each share of some items, the last one excluded."""
    return [(first, min(first + _SHARE, n_items)) for first in range(0, n_items, _SHARE)]


def waves(points: Int64Array, triangles: Int64Array) -> list[list[Int64Array]]:
    """Vertices in groups that can be moved at the same time, wave by wave.

    Parameters
    ----------
    points : ndarray
        Shape (n, 2), int64, in half pixels.
    triangles : ndarray
        Shape (m, 3), int64.

    Returns
    -------
    list of lists of ndarray
        Each vertex is in one group. No edge joins two groups of a wave.
    """
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    left = np.ones(len(points), dtype=np.bool_)
    result = []
    for offset in (0, _BAND // 2):
        bands = (points[:, 1] + offset) // _BAND
        taken = left & ~_touches_another(bands, edges[left[edges].all(axis=1)])
        result.append(_groups(taken, bands))
        left &= ~taken
    result.append(_groups(left, np.zeros_like(bands)))
    return result


def _touches_another(bands: Int64Array, edges: Int64Array) -> BoolArray:
    """Whether an edge joins each vertex to another band."""
    touches = np.zeros(len(bands), dtype=np.bool_)
    touches[edges[bands[edges[:, 0]] != bands[edges[:, 1]]]] = True
    return touches


def _groups(taken: BoolArray, bands: Int64Array) -> list[Int64Array]:
    """The vertices that are taken, by band."""
    vertices = np.flatnonzero(taken)
    vertices = vertices[np.argsort(bands[vertices], kind="stable")]
    return np.split(vertices, np.flatnonzero(np.diff(bands[vertices])) + 1) if len(vertices) else []
