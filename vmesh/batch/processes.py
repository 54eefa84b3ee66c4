"""Tasks of a batch on the processors of this machine, by as many processes."""

from __future__ import annotations

import os
import signal
import sys
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import active_children, connection, get_context, parent_process
from threading import Thread, current_thread, main_thread
from types import FrameType
from typing import Final

from vmesh.batch.task import WRITING, Outcome, Task, run

_SECONDS_TO_INTERRUPT: Final = 0.2


def run_in_processes(tasks: Iterable[Task], n_jobs: int) -> Generator[Outcome, None, None]:
    """Outcomes of tasks, as they are done, by at most so many processes.

    Where a process dies, as for want of memory, the tasks that it may have died of are done again,
    each by a process of its own; one that this process dies of too has failed. If the caller stops
    before the end, the processes stop too and leave nothing half done.
    """
    waiting = deque(tasks)
    while waiting:
        suspects = yield from _run_until_one_dies(waiting, n_jobs)
        for task in suspects:
            if (yield from _run_until_one_dies(deque([task]), 1)):
                yield Outcome(task.source, "failed", error="the process that worked on it died")


def _run_until_one_dies(waiting: deque[Task], n_jobs: int) -> Generator[Outcome, None, list[Task]]:
    """Take tasks and yield their outcomes; returns those that were begun and have none.

    No more are handed over than are worked on, so that these are few.
    """
    begun: dict[Future[Outcome], Task] = {}
    with _interrupts_noted() as check, _pool(min(n_jobs, len(waiting))) as pool:
        while waiting or begun:
            try:
                while waiting and len(begun) < n_jobs:
                    begun[_submit(pool, waiting[0])] = waiting[0]
                    waiting.popleft()
            except BrokenProcessPool:
                break
            done: set[Future[Outcome]] = set()
            while not done:
                check()
                done = wait(begun, _SECONDS_TO_INTERRUPT, FIRST_COMPLETED).done
            whole = [future for future in done if future.exception() is None]
            for future in whole:
                del begun[future]
                yield future.result()
            if len(whole) < len(done):
                break
    return list(begun.values())


@contextmanager
def _interrupts_noted() -> Iterator[Callable[[], None]]:
    """Check that raises the interrupt that has come in the block, if any.

    Raised wherever the program happens to be, it could leave a lock of the pool half taken, and end
    as another error. Where interrupts are handled in another way, or by another thread, they stay
    as they are.
    """
    noted: list[int] = []

    def check() -> None:
        if noted:
            raise KeyboardInterrupt

    is_ours = current_thread() is main_thread()
    if not is_ours or signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        yield check
        return
    signal.signal(signal.SIGINT, lambda number, _: noted.append(number))
    try:
        yield check
        check()
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)


@contextmanager
def _pool(n_jobs: int) -> Iterator[ProcessPoolExecutor]:
    """Processes that end with the block, at once if it is left by an error or an interrupt."""
    others = set(active_children())
    # Spawned, as every system can: a fork would copy the locks of threads that it does not copy.
    pool = ProcessPoolExecutor(n_jobs, get_context("spawn"), _prepare_process)
    try:
        yield pool
    except BaseException:
        for process in set(active_children()) - others:
            process.terminate()
        raise
    finally:
        pool.shutdown(cancel_futures=True)


def _submit(pool: ProcessPoolExecutor, task: Task) -> Future[Outcome]:
    """Hand a task to a pool, which may start a process.

    A terminal sends an interrupt to all processes. It is for us to stop the others; one that has
    just started would show where it was. So they inherit that interrupts wait, where there is such
    a thing.
    """
    if sys.platform == "win32":
        return pool.submit(run, task)
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        return pool.submit(run, task)
    finally:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})


def _prepare_process() -> None:
    """Leave interrupts to the process that started this one, and end when it says so or is gone."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, _end)
    starter = parent_process()
    assert starter is not None
    Thread(target=_end_after, args=(starter.sentinel,), daemon=True).start()


def _end_after(sentinel: int) -> None:
    """End when the process of a sentinel has, by whatever signal: it could not say so."""
    connection.wait([sentinel])
    _exit_between_files()


def _end(_: int, __: FrameType | None) -> None:
    """End at once, or after the file that is being written.

    An exception would be lost where Python calls back from machine code.
    """
    Thread(target=_exit_between_files).start()


def _exit_between_files() -> None:
    with WRITING:
        os._exit(1)
