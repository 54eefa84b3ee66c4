"""What the README shows is run."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from vmesh.cli.main import COMMANDS

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text("utf-8")


def test_the_python_example_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (code,) = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
    (tmp_path / "tests").symlink_to(ROOT / "tests")
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    exec(code, names)
    assert names["same"] == names["mesh"]
    assert names["pixels"].shape == (800, 1200, 3)  # type: ignore[attr-defined]
    assert (tmp_path / "turned.svg").read_bytes().startswith(b"<svg")


def test_the_overview_names_every_command_and_only_options_that_exist() -> None:
    (overview,) = re.findall(r"```\n(vmesh encode.*?)```", README, re.DOTALL)
    assert set(re.findall(r"^vmesh (\S+)", overview, re.MULTILINE)) == set(COMMANDS)
    known = ""
    for command in COMMANDS:
        arguments = [sys.executable, "-m", "vmesh", command, "--help"]
        known += subprocess.run(arguments, capture_output=True, check=True).stdout.decode()
    for option in set(re.findall(r"--[a-z-]+", overview)):
        assert option in known, option


def test_the_first_command_runs_once_vmesh_is_set_up(tmp_path: Path) -> None:
    (line,) = re.findall(r"^tools/setup && (.*)$", README, re.MULTILINE)
    (tmp_path / "tests").symlink_to(ROOT / "tests")
    folder = tmp_path / ".venv" / "bin"
    folder.mkdir(parents=True)
    program = folder / "vmesh"
    program.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m vmesh "$@"\n')
    program.chmod(0o755)
    subprocess.run(["sh", "-c", line], cwd=tmp_path, check=True, capture_output=True)
    made = {path.suffix for path in (tmp_path / "out").iterdir()}
    assert made == {".vmesh", ".png", ".svg", ".pdf"}
