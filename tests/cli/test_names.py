"""Names of files in what is printed, and standard output that cannot be written."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import vmesh
from tests.cli.program import Program
from tests.codec import samples

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="no such names")

# A colour, a title, the end of a line, directions of writing, a byte that is no character.
BAD = os.fsdecode(b"a\x1b[31m\x07\n\xc2\x9b\xe2\x80\xae\xe2\x81\xa6\xff")
SHOWN = r"a\x1b[31m\x07\n\x9b\u202e\u2066\xff"


@pytest.fixture
def mesh(tmp_path: Path) -> Path:
    """A mesh in a file with a name that a terminal would obey."""
    path = tmp_path / f"{BAD}.vmesh"
    vmesh.dump(samples.color(), path)
    return path


def is_plain(text: str) -> bool:
    """Check of lines: true if a terminal shows them all, and as they are."""
    return all(line.isprintable() for line in text.splitlines()) and "\udcff" not in text


def test_commands_print_names_that_a_terminal_does_not_obey(
    mesh: Path, tmp_path: Path, program: Program
) -> None:
    missing = tmp_path / f"missing{BAD}.vmesh"
    folder = tmp_path / BAD
    folder.mkdir()
    texts = [
        program.succeed("validate", mesh),
        program.succeed("info", mesh, mesh.parent),
        program.succeed("dump", mesh, mesh.parent),
        program.fail(1, "info", missing),
        program.fail(1, "decode", missing, tmp_path / "out.png"),
        program.fail(2, "decode", mesh, tmp_path / f"{BAD}.xyz"),
        program.fail(1, "decode", mesh, folder / "none" / "out.png"),
        program.fail(1, "info", folder),
        program.fail(1, "decode", mesh, missing, "-o", tmp_path / "out"),
        program.fail(1, "batch", missing, "-o", tmp_path / "batch", "--to", "png"),
        program.fail(2, "batch", mesh, "-o", mesh),
        program.fail(1, "encode", mesh),
        program.fail(1, "encode", mesh, tmp_path / "out.vmesh"),
        program.fail(1, "decode", mesh, "-o", tmp_path / "out"),
    ]
    for text in texts:
        assert SHOWN in text
        assert is_plain(text)
    for arguments in (("to-svg", mesh, "--mode", BAD), (BAD,)):
        assert is_plain(program.fail(2, *arguments))


def test_json_has_the_names_as_they_are(mesh: Path, program: Program) -> None:
    lines = program.succeed("info", mesh, mesh, "--json").splitlines()
    assert {json.loads(line)["source"] for line in lines} == {str(mesh)}


@pytest.mark.parametrize("encoding", ["ascii", "latin-1", "utf-8"])
def test_a_terminal_of_any_encoding_is_no_reason_to_fail(tmp_path: Path, encoding: str) -> None:
    path = tmp_path / "größe 日本.vmesh"
    vmesh.dump(samples.color(), path)
    environment = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONIOENCODING": encoding}
    for arguments, status in (
        (["validate", path], 0),
        (["info", path, path], 0),
        (["info", f"{path}.png"], 1),
    ):
        done = subprocess.run(
            [sys.executable, "-m", "vmesh", *arguments],
            env={**os.environ, **environment},
            capture_output=True,
            check=False,
        )
        assert done.returncode == status
        assert b"Traceback" not in done.stderr
        assert done.stderr.count(b"\n") == status


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no such device")
@pytest.mark.parametrize(
    "arguments",
    [
        ["info", "m.vmesh"],
        ["info", "m.vmesh", "m.vmesh"],
        ["dump", "m.vmesh", "--mesh"],
        ["to-svg", "m.vmesh", "-"],
        ["--version"],
        ["--help"],
    ],
)
def test_an_error_of_standard_output_names_it_in_one_line(
    tmp_path: Path, arguments: list[str]
) -> None:
    vmesh.dump(samples.color(), tmp_path / "m.vmesh")
    with Path("/dev/full").open("wb") as full:
        done = subprocess.run(
            [sys.executable, "-m", "vmesh", *arguments],
            cwd=tmp_path,
            stdout=full,
            stderr=subprocess.PIPE,
            check=False,
        )
    assert done.stderr == b"vmesh: standard output: No space left on device\n"
    assert done.returncode == 1


def test_an_output_that_is_a_full_device_is_named(mesh: Path, program: Program) -> None:
    if not Path("/dev/full").exists():
        pytest.skip("no such device")
    link = mesh.with_name("full.png")
    link.symlink_to("/dev/full")
    assert program.fail(1, "decode", mesh, link) == f"vmesh: {link}: No space left on device\n"


def test_a_reader_that_goes_is_told_nothing(mesh: Path) -> None:
    command = f'{sys.executable} -m vmesh dump --mesh "$0" | head -c 10'
    done = subprocess.run(["sh", "-c", command, str(mesh)], capture_output=True, check=False)
    assert done.stderr == b""


def test_code_that_cannot_be_kept_is_told_beside_what_was_asked_for(
    mesh: Path, tmp_path: Path, program: Program, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("vmesh.kernels.jit.take_trouble", lambda: "compiled code was not kept")
    status, output, told = program.run("decode", mesh, tmp_path / "out.png")
    assert (status, output, told) == (0, "", "vmesh: compiled code was not kept\n")
    assert (tmp_path / "out.png").exists()
