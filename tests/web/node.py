"""Node, and the packages that `tests/web/package.json` pins."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path
from typing import Final

import pytest

from tests.programs import need_program

ROOT: Final = Path(__file__).parents[2]
PACKAGES: Final = ROOT / "tests" / "web" / "node_modules"


def need_package(name: str) -> Path:
    """Folder of a package; the test is skipped by name where it is missing."""
    found = PACKAGES / name
    if not found.is_dir():
        pytest.skip(f"the package {name} is missing (npm ci --prefix tests/web)")
    return found


def run_node(*arguments: str | Path, folder: Path | None = None, data: bytes = b"") -> str:
    """What a script for Node prints; the test fails where the script does."""
    return run(need_program("node", "nodejs"), *arguments, folder=folder, data=data)


def run_npm(*arguments: str | Path, folder: Path) -> str:
    """What npm prints, which is given no network."""
    settings = {"npm_config_offline": "true", "npm_config_cache": str(folder / ".npm")}
    options = ("--no-audit", "--no-fund", "--no-update-notifier")
    npm = need_program("npm", "npm")
    return run(npm, *arguments, *options, folder=folder, settings=settings)


def run(
    program: str,
    *arguments: str | Path,
    folder: Path | None = None,
    data: bytes = b"",
    settings: dict[str, str] | None = None,
) -> str:
    """What a program prints; the test fails where the program does."""
    done = subprocess.run(
        [program, *map(str, arguments)],
        input=data,
        cwd=folder,
        env={**os.environ, **(settings or {})},
        capture_output=True,
        check=False,
    )
    assert done.returncode == 0, (done.stdout + done.stderr).decode()
    return done.stdout.decode()
