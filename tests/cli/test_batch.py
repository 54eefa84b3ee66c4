from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

import vmesh
from tests.batch.pictures import write_pictures
from tests.cli.program import Program, fail, run, succeed
from vmesh.arrays import UInt8Array
from vmesh.batch.journal import NAME
from vmesh.batch.task import Outcome, Task

FAST = ("-e", "1", "--vertices", "60", "-j", "2")


def lines(output: bytes) -> dict[str, dict[str, Any]]:
    """Figures of each source, by its path."""
    return {figures["source"]: figures for figures in map(json.loads, output.splitlines())}


def files_in(folder: Path) -> set[str]:
    """Files below a folder, but for what is hidden, such as the journal."""
    return {path.relative_to(folder).as_posix() for path in folder.rglob("[!.]*") if path.is_file()}


@pytest.fixture
def photos(tmp_path: Path, chelsea: UInt8Array) -> Path:
    """Two photographs in a folder and one in a folder below it."""
    write_pictures(tmp_path / "photos", chelsea, 2)
    write_pictures(tmp_path / "photos" / "sea", chelsea, 1)
    return tmp_path / "photos"


def test_a_folder_is_encoded_and_not_encoded_again(photos: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert succeed("batch", photos, "-o", out, *FAST) == b""
    assert files_in(out) == {"00.vmesh", "01.vmesh", "sea/00.vmesh"}
    succeed("encode", photos / "01.png", tmp_path / "one.vmesh", *FAST)
    assert (out / "01.vmesh").read_bytes() == (tmp_path / "one.vmesh").read_bytes()
    (out / "01.vmesh").unlink()
    again = run("batch", photos, "-o", out, "--json", *FAST)
    assert again.stderr == b"vmesh: 2 of 3 skipped: their outputs are there\n"
    figures = lines(again.stdout)
    assert {source: line["status"] for source, line in figures.items()} == {
        str(photos / "00.png"): "skipped",
        str(photos / "01.png"): "done",
        str(photos / "sea" / "00.png"): "skipped",
    }
    forced = lines(succeed("batch", photos, "-o", out, "--json", "--force", *FAST))
    assert {line["status"] for line in forced.values()} == {"done"}


def test_every_format_is_written_and_reported(photos: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    pattern = str(photos / "0*.png")
    formats = ["--to", "vmesh,svg,PDF, png"]
    figures = lines(succeed("batch", pattern, "-o", out, *formats, "--json", *FAST))
    outputs = [str(out / f"01.{suffix}") for suffix in ("vmesh", "svg", "pdf", "png")]
    line = figures[str(photos / "01.png")]
    assert line["outputs"] == outputs
    assert line["bytes"] == sum(Path(path).stat().st_size for path in outputs)
    assert line["seconds"] > 0
    assert line["error"] is None
    assert list(line) == ["source", "status", "outputs", "bytes", "seconds", "error", "notes"]
    assert len(files_in(out)) == 8


def test_what_cannot_be_read_is_told_and_the_rest_is_done(photos: Path, tmp_path: Path) -> None:
    bad = photos / "bad.png"
    bad.write_text("this is not an image")
    missing = photos / "missing.jpg"
    done = run("batch", photos, missing, "-o", tmp_path / "out", "--json", *FAST)
    assert done.returncode == 1
    assert sorted(done.stderr.decode().splitlines()) == [
        f"vmesh: {bad}: not an image in a format that can be read",
        f"vmesh: {missing}: No such file or directory",
    ]
    figures = lines(done.stdout)
    assert figures[str(bad)]["status"] == "failed"
    assert "not an image" in figures[str(bad)]["error"]
    assert files_in(tmp_path / "out") == {"00.vmesh", "01.vmesh", "sea/00.vmesh"}


def test_two_sources_for_one_output_are_refused_before_anything_is_done(
    photos: Path, tmp_path: Path
) -> None:
    text = fail(1, "batch", photos / "00.png", photos / "sea" / "00.png", "-o", tmp_path / "out")
    assert "would both be written to" in text
    assert not (tmp_path / "out").exists()
    assert "would replace" in fail(1, "batch", photos, "-o", photos, "--to", "png")


def test_what_makes_no_sense_is_wrong_usage(photos: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert "standard input" in fail(2, "batch", "-", "-o", out)
    assert "vmesh, png" in fail(2, "batch", photos, "-o", out, "--to", "vmesh,docx")
    assert "is a file" in fail(2, "batch", photos, "-o", photos / "00.png")
    assert "--output" in fail(2, "batch", photos)
    assert "quality and vertices" in fail(2, "batch", photos, "-o", out, "-q", "5", *FAST)
    assert not out.exists()


@pytest.mark.skipif(
    sys.platform == "win32" or os.geteuid() == 0, reason="root may write everywhere"
)
def test_a_folder_that_cannot_be_written_is_told_at_once(photos: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    out.mkdir(mode=0o500)
    assert "denied" in fail(1, "batch", photos, "-o", out)


@pytest.mark.skipif(sys.platform == "win32", reason="no signals but one")
@pytest.mark.parametrize("number", ["SIGKILL", "SIGTERM", "SIGHUP"])
def test_the_processes_of_a_batch_end_with_it(
    photos: Path, tmp_path: Path, chelsea: UInt8Array, number: str
) -> None:
    Image.fromarray(chelsea).save(photos / "long.png")
    out = tmp_path / "out"
    command = [sys.executable, "-m", "vmesh", "batch", str(photos), "-o", str(out), "--json"]
    with subprocess.Popen(
        [*command, "-e", "9", "-q", "95", "-j", "2"], stdout=subprocess.PIPE
    ) as process:
        assert process.stdout is not None
        process.stdout.readline()
        process.send_signal(signal.Signals[number])
        # It ends when nobody is left who could write to it.
        process.communicate(timeout=20)
    left = files_in(out)
    assert "long.vmesh" not in left
    assert all(vmesh.load(out / name) for name in left)


@pytest.mark.skipif(sys.platform == "win32", reason="no interrupts of process groups")
def test_an_interrupted_batch_leaves_no_half_files_and_goes_on(
    photos: Path, tmp_path: Path, chelsea: UInt8Array
) -> None:
    Image.fromarray(chelsea).save(photos / "long.png")
    out = tmp_path / "out"
    command = [sys.executable, "-m", "vmesh", "batch", str(photos), "-o", str(out), "--json"]
    with subprocess.Popen(
        [*command, "-e", "9", "-q", "95", "-j", "2"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        process_group=0,
    ) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        first = json.loads(process.stdout.readline())
        # As a terminal does: to the program and to the processes that it has started.
        os.killpg(process.pid, signal.SIGINT)
        assert process.stderr.read().strip() == b""
        assert process.wait() == 130
    assert first["status"] == "done"
    left = files_in(out)
    assert "long.vmesh" not in left
    assert all(vmesh.load(out / name) for name in left)
    (photos / "long.png").write_bytes((photos / "00.png").read_bytes())
    figures = lines(succeed(*command[3:], "-e", "9", "-q", "95", "--quiet"))
    assert figures[first["source"]]["status"] == "skipped"
    assert figures[str(photos / "long.png")]["status"] == "done"
    assert files_in(out) == {"00.vmesh", "01.vmesh", "long.vmesh", "sea/00.vmesh"}


def test_a_folder_of_meshes_is_converted(photos: Path, tmp_path: Path) -> None:
    meshes, out = tmp_path / "meshes", tmp_path / "out"
    succeed("batch", photos, "-o", meshes, *FAST)
    assert succeed("batch", meshes, "-o", out, "--to", "png,svg") == b""
    names = ("00", "01", "sea/00")
    assert files_in(out) == {f"{name}.{suffix}" for name in names for suffix in ("png", "svg")}
    text = fail(1, "batch", meshes, "-o", tmp_path / "none")
    assert "no pictures were found" in text
    assert ".vmesh" in text


def test_a_photograph_is_taken_rather_than_its_mesh_beside_it(photos: Path, tmp_path: Path) -> None:
    succeed("batch", photos, "-o", photos, *FAST)
    alone = photos / "alone.vmesh"
    alone.write_bytes((photos / "00.vmesh").read_bytes())
    figures = lines(
        succeed("batch", photos, "-o", tmp_path / "out", "--to", "svg", "--json", *FAST)
    )
    assert set(figures) == {
        str(alone), *(str(photos / name) for name in ("00.png", "01.png", "sea/00.png"))
    }  # fmt: skip


def test_what_is_passed_over_in_folders_is_named_and_counted(photos: Path, tmp_path: Path) -> None:
    for name in ("notes.txt", "a\x1b[31m.mov", "c.doc", "d.doc", "e.doc", "sea/f.doc"):
        (photos / name).touch()
    for name in (".hidden.txt", "00.xmp"):  # hidden, and of a photograph
        (photos / name).touch()
    done = run("batch", photos, "-o", tmp_path / "out", *FAST)
    assert done.returncode == 0
    assert done.stderr.decode() == (
        "vmesh: passed over in folders: a\\x1b[31m.mov, c.doc, d.doc, e.doc, notes.txt and 1 more\n"
    )
    succeed("batch", photos, "-o", tmp_path / "out", "--quiet", *FAST)


def test_a_photograph_that_an_older_one_replaced_is_made_again_and_so_are_other_settings(
    photos: Path, tmp_path: Path
) -> None:
    out, photo = tmp_path / "out", photos / "00.png"
    command = ("batch", photo, "-o", out, "--json", "--quiet")

    def status(*options: str) -> str:
        return str(lines(succeed(*command, *options))[str(photo)]["status"])

    assert status(*FAST) == "done"
    photo.write_bytes((photos / "01.png").read_bytes())
    os.utime(photo, (1_000_000_000, 1_000_000_000))
    assert status(*FAST) == "done"
    succeed("encode", photos / "01.png", tmp_path / "one.vmesh", *FAST)
    assert (out / "00.vmesh").read_bytes() == (tmp_path / "one.vmesh").read_bytes()
    assert status(*FAST) == "skipped"
    assert status("-e", "1", "--vertices", "30") == "done"
    assert status("-e", "1", "--vertices", "30") == "skipped"


def test_times_are_kept_if_asked_for_and_outputs_are_up_to_date_then(
    photos: Path, tmp_path: Path
) -> None:
    out, photo = tmp_path / "out", photos / "00.png"
    os.utime(photo, (1_000_000_000, 1_000_000_000))
    succeed("batch", photo, "-o", out, "--preserve", *FAST)
    assert (out / "00.vmesh").stat().st_mtime == 1_000_000_000
    for _ in range(2):
        figures = lines(run("batch", photo, "-o", out, "--json", *FAST).stdout)
        assert figures[str(photo)]["status"] == "skipped"
        (out / NAME).unlink()


def test_what_is_there_is_kept_if_asked_for_and_what_is_protected_unless_asked_for(
    photos: Path, tmp_path: Path
) -> None:
    out, photo = tmp_path / "out", photos / "00.png"
    out.mkdir()
    target = out / "00.vmesh"
    target.write_bytes(b"mine")
    os.utime(target, (1, 1))
    done = run("batch", photo, "-o", out, "--no-overwrite", *FAST)
    assert (done.returncode, done.stderr) == (
        0, b"vmesh: 1 of 1 skipped: their outputs are there\n"
    )  # fmt: skip
    target.chmod(0o444)
    assert "00.vmesh: is write-protected" in fail(1, "batch", photo, "-o", out, *FAST)
    assert target.read_bytes() == b"mine"
    succeed("batch", photo, "-o", out, "--overwrite", *FAST)
    assert vmesh.load(target).n_vertices > 0
    assert "--force" in fail(2, "batch", photo, "-o", out, "--force", "--no-overwrite")


def test_code_that_cannot_be_kept_is_told_once_and_not_for_every_process(
    photos: Path, tmp_path: Path, program: Program, monkeypatch: pytest.MonkeyPatch
) -> None:
    def troubled(tasks: Iterable[Task], _: int) -> Iterator[Outcome]:
        for task in tasks:
            yield Outcome(task.source, "done", trouble="compiled code could not be kept")

    monkeypatch.setattr("vmesh.cli.batch.run_in_processes", troubled)
    status, output, told = program.run("batch", photos, "-o", tmp_path / "out", "--json")
    assert (status, told) == (0, "vmesh: compiled code could not be kept\n")
    assert len(output.splitlines()) == 3


def test_what_is_to_be_told_of_a_photograph_is_told(
    photos: Path, tmp_path: Path, program: Program, monkeypatch: pytest.MonkeyPatch
) -> None:
    def noted(tasks: Iterable[Task], _: int) -> Iterator[Outcome]:
        for task in tasks:
            yield Outcome(task.source, "done", notes=("its profile was left out",))

    monkeypatch.setattr("vmesh.cli.batch.run_in_processes", noted)
    photo = photos / "00.png"
    status, _, told = program.run("batch", photo, "-o", tmp_path / "out")
    assert (status, told) == (0, f"vmesh: {photo}: its profile was left out\n")


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="processes are not bound")
def test_as_many_processes_work_as_there_are_processors_to_use(
    photos: Path, tmp_path: Path, program: Program, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[int] = []

    def counted(_: Iterable[Task], n_jobs: int) -> Iterator[Outcome]:
        asked.append(n_jobs)
        yield from ()

    monkeypatch.setattr("vmesh.cli.batch.run_in_processes", counted)
    before = os.sched_getaffinity(0)
    try:
        os.sched_setaffinity(0, {min(before)})
        program.succeed("batch", photos, "-o", tmp_path / "out")
    finally:
        os.sched_setaffinity(0, before)
    assert asked == [1]
