"""Compilation: announced when it happens, kept when it can be."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

SCRIPT = """
import numpy as np
from vmesh.kernels.jit import on_first_compilation
from vmesh.kernels.sobel import sobel4
with on_first_compilation(lambda: print("compiling")):
    sobel4(np.zeros((4, 4), dtype=np.uint8))
    sobel4(np.zeros((4, 4), dtype=np.uint8))
print("done")
"""


def run(cache: Path) -> list[str]:
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT],
        env={**os.environ, "NUMBA_CACHE_DIR": str(cache)},
        capture_output=True,
        check=True,
        text=True,
    )
    return done.stdout.split()


def test_the_first_run_announces_that_it_compiles_and_the_second_does_not(tmp_path: Path) -> None:
    assert run(tmp_path) == ["compiling", "done"]
    assert run(tmp_path) == ["done"]


def test_kernels_work_without_a_writable_cache(tmp_path: Path) -> None:
    blocked = tmp_path / "file"
    blocked.touch()
    assert run(blocked / "cache") == ["compiling", "done"]
