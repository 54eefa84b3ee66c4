from __future__ import annotations

import os
from pathlib import Path

import pytest

from vmesh.batch.plan import make_plan
from vmesh.batch.sources import Source
from vmesh.batch.task import Outcome, Recipe, Task
from vmesh.encoder.settings import Settings

RECIPE = Recipe(Settings(vertices=100, threads=1))


def plan(
    *sources: Source, output: Path, suffixes: tuple[str, ...] = (".vmesh",), force: bool = False
) -> tuple[list[Task], list[Outcome]]:
    return make_plan(sources, str(output), suffixes, RECIPE, force=force)


def source(folder: Path, name: str, below: str = "") -> Source:
    """A source that was written a while ago."""
    path = folder / name
    path.touch()
    os.utime(path, (1000, 1000))
    return Source(path, Path(below, name))


def test_every_source_has_its_place_and_all_its_formats(tmp_path: Path) -> None:
    photograph = source(tmp_path, "a.b.jpg", "sea/deep")
    tasks, skipped = plan(photograph, output=tmp_path / "out", suffixes=(".vmesh", ".svg"))
    place = tmp_path / "out" / "sea" / "deep"
    targets = (str(place / "a.b.vmesh"), str(place / "a.b.svg"))
    assert tasks == [Task(str(photograph.path), targets, RECIPE)]
    assert skipped == []


def test_only_outputs_that_are_older_than_their_source_are_made(tmp_path: Path) -> None:
    photograph, target = source(tmp_path, "a.jpg"), tmp_path / "a.svg"
    for time, is_made in ((999, True), (1000, False), (1001, False)):
        target.touch()
        os.utime(target, (time, time))
        tasks, skipped = plan(photograph, output=tmp_path, suffixes=(".svg",))
        assert [bool(tasks), bool(skipped)] == [is_made, not is_made]
    assert skipped == [Outcome(str(photograph.path), "skipped")]
    assert len(plan(photograph, output=tmp_path, suffixes=(".svg",), force=True)[0]) == 1


def test_what_is_missing_is_made_from_a_mesh_that_is_there(tmp_path: Path) -> None:
    photograph, mesh = source(tmp_path, "a.jpg"), tmp_path / "a.vmesh"
    mesh.touch()
    ((task,), _) = plan(photograph, output=tmp_path, suffixes=(".svg", ".vmesh"))
    assert task.targets == (str(tmp_path / "a.svg"),)
    assert task.mesh == str(mesh)
    ((task,), _) = plan(photograph, output=tmp_path, suffixes=(".svg", ".vmesh"), force=True)
    assert task.mesh is None
    ((task,), _) = plan(photograph, output=tmp_path, suffixes=(".svg",))
    assert task.mesh is None


def test_two_sources_with_one_output_are_refused(tmp_path: Path) -> None:
    first, second = source(tmp_path, "a.jpg"), source(tmp_path, "a.png")
    with pytest.raises(ValueError, match=r"a\.jpg and .*a\.png would both be written to .*a\.vm"):
        plan(first, second, output=tmp_path / "out")


def test_an_output_that_would_replace_a_source_is_refused(tmp_path: Path) -> None:
    first, second = source(tmp_path, "a.png"), source(tmp_path, "a.jpg", "other")
    with pytest.raises(ValueError, match=r"a\.png would replace itself"):
        plan(first, output=tmp_path, suffixes=(".png",))
    plan(first, second, output=tmp_path / "out", suffixes=(".png",))


def test_a_source_that_is_not_there_is_left_to_its_task(tmp_path: Path) -> None:
    missing = Source(tmp_path / "none.png", Path("none.png"))
    (tmp_path / "none.vmesh").touch()
    assert len(plan(missing, output=tmp_path)[0]) == 1
