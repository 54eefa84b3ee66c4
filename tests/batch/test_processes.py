from __future__ import annotations

import os
from dataclasses import dataclass
from multiprocessing import active_children
from pathlib import Path
from typing import Any

import vmesh
from tests.batch.pictures import tasks_of, write_pictures
from vmesh.arrays import UInt8Array
from vmesh.batch.processes import run_in_processes
from vmesh.batch.task import Task


@dataclass(frozen=True)
class DeadlyTask(Task):
    """A task of which any process dies that receives it."""

    def __reduce__(self) -> tuple[Any, ...]:
        return os._exit, (1,)


def test_every_task_is_done_once(tmp_path: Path, chelsea: UInt8Array) -> None:
    tasks = tasks_of(write_pictures(tmp_path, chelsea, 5))
    outcomes = list(run_in_processes(tasks, 2))
    assert sorted(outcome.source for outcome in outcomes) == [task.source for task in tasks]
    assert {outcome.status for outcome in outcomes} == {"done"}
    assert active_children() == []


def test_no_tasks_need_no_processes() -> None:
    assert list(run_in_processes([], 2)) == []


def test_a_process_that_is_killed_loses_nothing(tmp_path: Path, chelsea: UInt8Array) -> None:
    tasks = tasks_of(write_pictures(tmp_path, chelsea, 6))
    outcomes = run_in_processes(tasks, 2)
    done = [next(outcomes)]
    active_children()[0].kill()
    done += outcomes
    assert sorted(outcome.source for outcome in done) == [task.source for task in tasks]
    assert {outcome.status for outcome in done} == {"done"}
    assert all(vmesh.load(task.targets[0]) for task in tasks)


def test_a_task_that_kills_its_process_fails_alone(tmp_path: Path, chelsea: UInt8Array) -> None:
    tasks = tasks_of(write_pictures(tmp_path, chelsea, 4))
    tasks[1] = DeadlyTask(tasks[1].source, tasks[1].targets, tasks[1].recipe)
    outcomes = {outcome.source: outcome for outcome in run_in_processes(tasks, 2)}
    assert outcomes.keys() == {task.source for task in tasks}
    failed = outcomes.pop(tasks[1].source)
    assert (failed.status, failed.error) == ("failed", "the process that worked on it died")
    assert {outcome.status for outcome in outcomes.values()} == {"done"}


def test_processes_end_when_the_caller_stops(tmp_path: Path, chelsea: UInt8Array) -> None:
    tasks = tasks_of(write_pictures(tmp_path, chelsea, 6))
    outcomes = run_in_processes(tasks, 2)
    next(outcomes)
    outcomes.close()
    assert active_children() == []
    assert {path.suffix for path in tmp_path.iterdir()} == {".png", ".vmesh"}
