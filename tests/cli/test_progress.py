"""What a terminal shows while the program works; elsewhere it is silent, which all tests see."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

import vmesh
from tests.pictures import noise

pty = pytest.importorskip("pty", reason="no pseudo-terminals")


def shown_on_a_terminal(*arguments: str | Path) -> str:
    """What the program writes to a terminal on standard error."""
    ours, its = pty.openpty()
    command = [sys.executable, "-m", "vmesh", *map(str, arguments)]
    # A width, so that no stage is cut short.
    environment = {**os.environ, "TERM": "xterm", "COLUMNS": "120"}
    with subprocess.Popen(command, stderr=its, env=environment) as running:
        os.close(its)
        parts = []
        while part := _read(ours):
            parts.append(part)
    os.close(ours)
    assert running.returncode == 0, b"".join(parts).decode()
    return b"".join(parts).decode()


def _read(terminal: int) -> bytes:
    """What is written next; nothing when all ends of the other side are closed."""
    try:
        return os.read(terminal, 65_536)
    except OSError:  # Linux's way to say so
        return b""


@pytest.fixture
def mesh(tmp_path: Path) -> Path:
    path = tmp_path / "picture.vmesh"
    vmesh.dump(vmesh.encode(noise(48, 48), vertices=500, effort=1), path)
    return path


def test_a_terminal_shows_the_stages_of_a_drawing(mesh: Path, tmp_path: Path) -> None:
    shown = shown_on_a_terminal("to-svg", mesh, tmp_path / "a.svg", "--mode", "exact")
    assert "converting: paths" in shown
    assert (tmp_path / "a.svg").exists()


def test_a_quiet_program_shows_none(mesh: Path, tmp_path: Path) -> None:
    assert shown_on_a_terminal("to-svg", mesh, tmp_path / "a.svg", "--quiet") == ""
