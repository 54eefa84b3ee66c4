"""Threads of an encoding: jobs that do not depend on each other, run side by side or in turn."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any, Final

from vmesh.processors import count_processors

_SHARE: Final = 4096  # items of a job that needs no order
_MAX_THREADS: Final = 16

Run = Callable[[Callable[..., Any], Iterable[Any]], Iterator[Any]]
"""A runner: calls a function with each of some arguments, and yields the results in their order."""


@contextmanager
def workers(n_threads: int | None) -> Iterator[Run]:
    """Runner of jobs on some threads, by default as many as there are processors to use."""
    if n_threads is None:
        n_threads = min(count_processors(), _MAX_THREADS)
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
    """Shares of some items: the first of each, and the one after its last."""
    return [(first, min(first + _SHARE, n_items)) for first in range(0, n_items, _SHARE)]
