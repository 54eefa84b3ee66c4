"""The command line, run as a program."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from vmesh.cli.main import main
from vmesh.kernels.jit import take_trouble


def run(*arguments: str | Path, given: bytes = b"") -> subprocess.CompletedProcess[bytes]:
    """The program with these arguments and this standard input."""
    command = [sys.executable, "-m", "vmesh", *map(str, arguments)]
    return subprocess.run(command, input=given, capture_output=True, check=False)


def succeed(*arguments: str | Path, given: bytes = b"") -> bytes:
    """What the program writes to standard output when it does its work in silence."""
    done = run(*arguments, given=given)
    assert done.returncode == 0, done.stderr.decode()
    assert done.stderr == b""
    return done.stdout


def fail(status: int, *arguments: str | Path, given: bytes = b"") -> str:
    """What the program says when it fails, without a traceback."""
    done = run(*arguments, given=given)
    text = done.stderr.decode()
    assert done.returncode == status, text
    assert "Traceback" not in text
    if status == 1:
        assert text.startswith("vmesh: ")
        assert text.count("\n") == 1
    return text


class Program:
    """The program in this process, which spares the time of starting another one."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> None:
        self._monkeypatch = monkeypatch
        self._capfd = capfd

    def run(self, *arguments: str | Path) -> tuple[int, str, str]:
        """Status, and what is written to standard output and standard error."""
        self._monkeypatch.setattr(sys, "argv", ["vmesh", *map(str, arguments)])
        self._capfd.readouterr()
        take_trouble()  # of what this process did before
        try:
            main()
            status = 0
        except SystemExit as stop:
            assert stop.code is None or isinstance(stop.code, int)
            status = stop.code or 0
        return status, *self._capfd.readouterr()

    def succeed(self, *arguments: str | Path) -> str:
        """What is written to standard output when the work is done in silence."""
        status, output, told = self.run(*arguments)
        assert (status, told) == (0, ""), told
        return output

    def fail(self, status: int, *arguments: str | Path) -> str:
        """What is said of a failure."""
        found, _, told = self.run(*arguments)
        assert found == status, told
        assert "Traceback" not in told
        if status == 1:
            assert all(line.startswith("vmesh: ") for line in told.splitlines())
        return told
