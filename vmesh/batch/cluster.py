"""Tasks of a batch on an existing Dask cluster, whose machines see the same files."""

from __future__ import annotations

import logging
from collections.abc import Generator, Iterable

from vmesh.batch.task import Outcome, Task, run
from vmesh.errors import describe

_PATIENCE = "20s"  # for the scheduler to answer


def run_on_cluster(tasks: Iterable[Task], address: str) -> Generator[Outcome, None, None]:
    """Outcomes of tasks, as they are done by the workers of the scheduler at an address.

    A task whose worker is lost is done again by another one; Dask gives it up after some.

    Raises
    ------
    ValueError
        If the package distributed is not installed.
    OSError
        If no scheduler answers.
    """
    try:
        from distributed import Client, as_completed
    except ImportError:
        raise ValueError(
            "--scheduler needs the package distributed: pip install 'vmesh[dask]'"
        ) from None
    # What matters of its messages comes as an error.
    for name in ("distributed", "distributed.client"):
        logging.getLogger(name).setLevel(logging.CRITICAL)
    with Client(address, timeout=_PATIENCE) as client:
        # Not pure: to do it again is to write it again.
        waiting = {client.submit(run, task, pure=False): task for task in tasks}
        try:
            for future in as_completed(list(waiting)):
                task, error = waiting.pop(future), future.exception()
                yield (
                    future.result()
                    if error is None
                    else Outcome(task.source, "failed", error=describe(error))
                )
        finally:
            client.cancel(list(waiting))
