from __future__ import annotations

import os
from pathlib import Path

import pytest

from vmesh.batch.journal import NAME, Journal
from vmesh.batch.plan import Rules, make_plan
from vmesh.batch.sources import Source
from vmesh.batch.task import Outcome, Recipe, Task
from vmesh.encoder.settings import Settings

RECIPE = Recipe(Settings(vertices=100, threads=1))


def plan(
    *sources: Source,
    output: Path,
    suffixes: tuple[str, ...] = (".vmesh",),
    recipe: Recipe = RECIPE,
    force: bool = False,
    overwrite: bool | None = None,
    journal: Journal | None = None,
) -> tuple[list[Task], list[Outcome]]:
    """Tasks and settled outcomes; what is adopted is noted."""
    kept = Journal(str(output)) if journal is None else journal
    rules = Rules(force=force, overwrite=overwrite)
    made = make_plan(sources, str(output), suffixes, recipe, kept, rules)
    kept.add(made.adopted)
    return made.tasks, made.settled


def done(*sources: Source, output: Path, recipe: Recipe = RECIPE) -> None:
    """Do as a batch does that makes all outputs anew, but leave them empty."""
    journal = Journal(str(output))
    made = make_plan(sources, str(output), (".vmesh",), recipe, journal, Rules(force=True))
    for target in made.origins:
        target.touch()
    journal.add(made.origins)


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


def test_a_source_that_an_older_file_replaced_is_worked_on_again(tmp_path: Path) -> None:
    photograph = source(tmp_path, "a.jpg")
    done(photograph, output=tmp_path)
    assert plan(photograph, output=tmp_path)[0] == []
    os.utime(photograph.path, (500, 500))
    assert len(plan(photograph, output=tmp_path)[0]) == 1
    os.utime(photograph.path, (1000, 1000))
    assert plan(photograph, output=tmp_path)[0] == []
    photograph.path.write_bytes(b"longer")
    os.utime(photograph.path, (1000, 1000))
    assert len(plan(photograph, output=tmp_path)[0]) == 1


def test_outputs_of_other_settings_are_made_anew(tmp_path: Path) -> None:
    photograph, mesh = source(tmp_path, "a.jpg"), source(tmp_path, "b.vmesh")
    other = Recipe(Settings(vertices=200, threads=1))
    same = Recipe(Settings(vertices=100, threads=4))
    out = tmp_path
    done(photograph, output=out)
    assert len(plan(photograph, output=out, recipe=other)[0]) == 1
    assert plan(photograph, output=out, recipe=same)[0] == []
    # The settings of the encoder have nothing to do with what is made of a mesh.
    (tmp_path / "b.svg").touch()
    journal = Journal(str(out))
    made = make_plan([mesh], str(out), (".svg",), RECIPE, journal, Rules(force=True))
    journal.add(made.origins)
    assert plan(mesh, output=out, suffixes=(".svg",), recipe=other)[0] == []
    stripped = Recipe(Settings(), strip="all")
    assert len(plan(mesh, output=out, suffixes=(".svg",), recipe=stripped)[0]) == 1


def test_outputs_that_were_there_without_a_journal_are_adopted(tmp_path: Path) -> None:
    photograph = source(tmp_path, "a.jpg")
    (tmp_path / "a.vmesh").touch()
    assert plan(photograph, output=tmp_path)[0] == []
    os.utime(photograph.path, (500, 500))
    assert len(plan(photograph, output=tmp_path)[0]) == 1


def test_without_a_sound_journal_outputs_count_by_their_time(tmp_path: Path) -> None:
    photograph, journal = source(tmp_path, "a.jpg"), tmp_path / NAME
    entry = b'{"output": "a.vmesh", "size": %s, "mtime_ns": 3, "recipe": ""}'
    for damaged in (b"", b"\0\xff", b"[]\n{}\n7\n", b"[" * 100_000, entry % b'"x"', b"{\n"):
        journal.write_bytes(damaged)
        (tmp_path / "a.vmesh").unlink(missing_ok=True)
        assert len(plan(photograph, output=tmp_path)[0]) == 1
        done(photograph, output=tmp_path)
        assert plan(photograph, output=tmp_path)[0] == []
        os.utime(photograph.path, (500, 500))
        assert len(plan(photograph, output=tmp_path)[0]) == 1
        os.utime(photograph.path, (1000, 1000))
    journal.unlink()
    journal.mkdir()
    assert plan(photograph, output=tmp_path)[0] == []


def test_a_journal_does_not_grow_with_every_batch(tmp_path: Path) -> None:
    photograph = source(tmp_path, "a.jpg")
    for time in range(1000, 1300):
        os.utime(photograph.path, (time, time))
        done(photograph, output=tmp_path)
    assert (tmp_path / NAME).read_bytes().count(b"\n") < 150
    assert plan(photograph, output=tmp_path)[0] == []


def test_an_output_that_is_there_can_be_kept_whatever_its_age(tmp_path: Path) -> None:
    photograph, target = source(tmp_path, "a.jpg"), tmp_path / "a.vmesh"
    target.touch()
    os.utime(target, (500, 500))
    tasks, settled = plan(photograph, output=tmp_path, overwrite=False)
    assert (tasks, settled) == ([], [Outcome(str(photograph.path), "skipped")])
    ((task,), _) = plan(photograph, output=tmp_path, suffixes=(".vmesh", ".svg"), overwrite=False)
    assert task.targets == (str(tmp_path / "a.svg"),)
    assert not task.replace
    assert len(plan(photograph, output=tmp_path)[0]) == 1


def test_a_write_protected_output_is_told_before_any_work(tmp_path: Path) -> None:
    photograph, target = source(tmp_path, "a.jpg"), tmp_path / "a.vmesh"
    target.touch(mode=0o444)
    assert plan(photograph, output=tmp_path)[0] == []
    os.utime(target, (500, 500))
    (tmp_path / NAME).unlink()
    tasks, (outcome,) = plan(photograph, output=tmp_path)
    assert (tasks, outcome.status) == ([], "failed")
    assert "write-protected" in str(outcome.error)
    assert len(plan(photograph, output=tmp_path, overwrite=True)[0]) == 1
