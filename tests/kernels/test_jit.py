"""Compilation: announced when it happens, kept when it can be."""

from __future__ import annotations

import os
import pickle
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from types import FunctionType
from typing import Any

import numba
import numpy as np
import pytest

import vmesh
from vmesh.kernels import jit

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


@pytest.fixture(scope="module")
def warm(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A cache that holds what the script needs."""
    folder = tmp_path_factory.mktemp("cache")
    run(folder)
    return folder


GONE = pickle.dumps(numba.__version__) + b"cvmesh\nwhat_is_gone\n."


@pytest.mark.parametrize(
    ("ending", "damaged"), [(".nbi", b""), (".nbi", GONE), (".nbc", b"no code"), (".nbc", GONE)]
)
def test_a_damaged_or_foreign_cache_is_written_anew(
    warm: Path, tmp_path: Path, ending: str, damaged: bytes
) -> None:
    cache = tmp_path / "cache"
    shutil.copytree(warm, cache)
    kept = list(cache.rglob(f"*{ending}"))
    assert kept
    for path in kept:
        path.write_bytes(damaged)
    assert run(cache) == ["compiling", "done"]
    assert run(cache) == ["done"]


CALLER = """
from vmesh.kernels.callee import factor
from vmesh.kernels.jit import kernel, on_first_compilation

@kernel
def multiplied(x):
    return factor() * x

with on_first_compilation(lambda: print("compiling")):
    print(multiplied(7))
"""
CALLEE = """
from vmesh.kernels.jit import inner_kernel

@inner_kernel
def factor():
    return {}
"""


def test_a_change_in_a_kernel_recompiles_its_callers_in_other_files(tmp_path: Path) -> None:
    package = tmp_path / "vmesh"
    kernels = package / "kernels"
    kernels.mkdir(parents=True)
    for name in ("__init__.py", "kernels/__init__.py", "kernels/jit.py"):
        shutil.copy(Path(vmesh.__file__).parent / name, package / name)
    (kernels / "caller.py").write_text(CALLER)

    def run_caller(factor: int) -> list[str]:
        (kernels / "callee.py").write_text(CALLEE.format(factor))
        done = subprocess.run(
            [sys.executable, "-m", "vmesh.kernels.caller"],
            env={**os.environ, "PYTHONPATH": str(tmp_path), "NUMBA_CACHE_DIR": str(tmp_path)},
            cwd=tmp_path,
            capture_output=True,
            check=True,
            text=True,
        )
        return done.stdout.split()

    assert run_caller(6) == ["compiling", "42"]
    assert run_caller(6) == ["42"]
    assert run_caller(5) == ["compiling", "35"]


def without_file(function: Callable[..., Any]) -> Any:
    """The function as if typed at a prompt: Numba finds no folder to keep its code in."""
    return FunctionType(function.__code__.replace(co_filename="<stdin>"), function.__globals__)


def test_kernels_work_without_a_writable_cache() -> None:
    def double(x: int) -> int:
        return 2 * x

    with pytest.raises(RuntimeError, match="no locator available"):
        numba.njit(cache=True)(without_file(double))
    assert jit.kernel(without_file(double))(21) == 42


def test_only_a_kernel_that_may_make_arrays_counts_references() -> None:
    def first(values: Any) -> Any:
        while values[0] < 0:
            values[0] += 1
        return values[0]

    def counts(decorate: Any) -> bool:
        compiled = decorate(without_file(first))  # Code from a cache cannot be looked at.
        assert compiled(np.array([-3, 5])) == 0
        return "NRT_decref" in next(iter(compiled.inspect_llvm().values()))

    assert counts(jit.kernel)
    assert not counts(jit.lean_kernel)
