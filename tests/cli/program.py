"""The command line, run as a program."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path


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
