"""What the README shows is run."""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path

import pytest
from PIL import Image

import vmesh
from tests.programs import place_vmesh

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text("utf-8")


def test_the_python_example_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (code,) = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
    (tmp_path / "tests").symlink_to(ROOT / "tests")
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    exec(code, names)
    assert vmesh.load(tmp_path / "coffee.vmesh") == names["mesh"]
    assert names["pixels"].shape == (800, 1200, 3)  # type: ignore[attr-defined]
    assert (tmp_path / "coffee.svg").read_bytes().startswith(b"<svg")


def test_the_commands_of_the_first_screen_run(tmp_path: Path) -> None:
    (commands,) = re.findall(r"```sh\n(vmesh encode.*?)```", README, re.DOTALL)
    with Image.open(ROOT / "tests" / "images" / "coffee.png") as image:
        image.resize((300, 200)).save(tmp_path / "photo.jpg")
    place_vmesh(tmp_path / "bin")
    path = f"{tmp_path / 'bin'}{os.pathsep}{os.environ['PATH']}"
    subprocess.run(
        ["sh", "-ec", commands],
        cwd=tmp_path,
        env={**os.environ, "PATH": path},
        check=True,
        capture_output=True,
    )
    made = {path.name for path in tmp_path.iterdir() if path.is_file()}
    assert made == {"photo.jpg", "photo.vmesh", "large.png", "photo.svg", "photo.html"}


def test_the_first_command_shows_what_it_does_once_vmesh_is_set_up(tmp_path: Path) -> None:
    (line,) = re.findall(r"^tools/setup && (.*)$", README, re.MULTILINE)
    for name in ("tests", "tools"):
        (tmp_path / name).symlink_to(ROOT / name)
    (tmp_path / ".venv").mkdir()
    place_vmesh(tmp_path / ".venv" / "bin")
    done = subprocess.run(["sh", "-c", line], cwd=tmp_path, check=True, capture_output=True)
    assert b"+ vmesh encode tests/images/coffee.png out/coffee.vmesh" in done.stderr
    made = {path.suffix for path in (tmp_path / "out").iterdir()}
    assert made == {".vmesh", ".png", ".svg", ".pdf"}
