"""Programs that the tests start: those of others, and ``vmesh`` as a command of its own."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

import pytest


def need_program(name: str, package: str) -> str:
    """Path of a program; the test is skipped by name where it is missing."""
    found = shutil.which(name)
    if found is None:
        pytest.skip(f"program {name} is missing (package {package})")
    return found


def place_vmesh(folder: Path) -> None:
    """Make the command ``vmesh`` of this very interpreter in a folder, for `PATH`."""
    folder.mkdir(exist_ok=True)
    program = folder / "vmesh"
    program.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m vmesh "$@"\n')
    program.chmod(0o755)
