from __future__ import annotations

import pickle
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import vmesh
from tests.batch.pictures import SETTINGS, tasks_of, write_pictures
from vmesh.arrays import UInt8Array
from vmesh.batch.task import Task, run
from vmesh.limits import Limits


@pytest.fixture
def task(tmp_path: Path, chelsea: UInt8Array) -> Task:
    return tasks_of(write_pictures(tmp_path, chelsea, 1))[0]


def test_a_task_writes_what_the_library_writes(task: Task, tmp_path: Path) -> None:
    suffixes = (".vmesh", ".png", ".svg")
    targets = tuple(str(tmp_path / "out" / f"a{suffix}") for suffix in suffixes)
    outcome = run(replace(task, targets=targets))
    assert (outcome.status, outcome.outputs, outcome.error) == ("done", targets, None)
    assert outcome.bytes == sum(Path(path).stat().st_size for path in targets)
    mesh = vmesh.encode(np.asarray(Image.open(task.source)), **asdict(SETTINGS))
    assert vmesh.load(targets[0]) == mesh
    assert np.array_equal(np.asarray(Image.open(targets[1])), vmesh.render(mesh))
    vmesh.export(mesh, tmp_path / "b.svg")
    assert (tmp_path / "b.svg").read_bytes() == Path(targets[2]).read_bytes()


def test_tasks_and_outcomes_travel(task: Task) -> None:
    assert pickle.loads(pickle.dumps(task)) == task
    outcome = run(task)
    assert pickle.loads(pickle.dumps(outcome)) == outcome


def test_a_mesh_that_is_there_is_not_made_again(task: Task, tmp_path: Path) -> None:
    other = vmesh.encode(np.zeros((3, 5), np.uint8), vertices=4)
    vmesh.dump(other, tmp_path / "other.vmesh")
    target = str(tmp_path / "a.png")
    run(replace(task, targets=(target,), mesh=str(tmp_path / "other.vmesh")))
    with Image.open(target) as image:
        assert image.size == (5, 3)


def test_a_mesh_as_the_source_is_converted_but_not_encoded(task: Task, tmp_path: Path) -> None:
    run(task)
    (mesh,) = task.targets
    assert run(replace(task, source=mesh, targets=(str(tmp_path / "a.pdf"),))).status == "done"
    outcome = run(replace(task, source=mesh, targets=(str(tmp_path / "b.vmesh"),)))
    assert outcome.error == "this is a .vmesh file, a photograph is needed"
    assert not (tmp_path / "b.vmesh").exists()


def test_what_goes_wrong_is_told_and_harms_no_earlier_output(task: Task, tmp_path: Path) -> None:
    (target,) = map(Path, task.targets)
    target.write_bytes(b"an earlier file")
    (tmp_path / "empty.png").touch()
    (tmp_path / "text.png").write_text("this is not an image")
    (tmp_path / "text.vmesh").write_text("this is not a mesh")
    for source, error in (
        ("empty.png", "the file is empty"),
        ("text.png", "not an image"),
        ("text.vmesh", "signature"),
        ("none.png", "none.png: No such file"),
    ):
        wanted = (str(tmp_path / "out.png"),) if source.endswith("vmesh") else task.targets
        outcome = run(replace(task, source=str(tmp_path / source), targets=wanted))
        assert outcome.status == "failed"
        assert outcome.outputs == ()
        assert error in str(outcome.error)
    for limits in (Limits(max_pixels=10), Limits(max_vertices=10)):
        recipe = replace(task.recipe, limits=limits)
        assert "limit" in str(run(replace(task, recipe=recipe)).error)
    assert target.read_bytes() == b"an earlier file"


def test_an_error_that_nobody_expects_is_told_by_its_kind(
    task: Task, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object, **__: object) -> None:
        raise KeyError("what")

    monkeypatch.setattr("vmesh.encoder.pipeline.encode_with", fail)
    assert run(task).error == "KeyError: 'what'"
