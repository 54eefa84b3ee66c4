"""Compilation: announced when it happens, kept when it can be."""

from __future__ import annotations

import os
import pickle
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from types import FunctionType
from typing import Any

import numba
import numpy as np
import pytest

import vmesh
from vmesh.kernels import jit
from vmesh.kernels.cache_files import TemporaryLocator

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


@pytest.mark.parametrize("ending", [".nbi", ".nbc"])
def test_a_byte_that_was_changed_in_kept_code_is_noticed(
    warm: Path, tmp_path: Path, ending: str
) -> None:
    cache = tmp_path / "cache"
    shutil.copytree(warm, cache)
    for path in cache.rglob(f"*{ending}"):
        data = bytearray(path.read_bytes())
        data[len(data) * 2 // 3] ^= 1
        path.write_bytes(data)
    assert run(cache) == ["compiling", "done"]
    assert run(cache) == ["done"]


def in_place_of(cache: Path, kind: str) -> None:
    """Put something else in the place of every file of a cache."""
    for path in [path for path in cache.rglob("*") if path.is_file()]:
        path.unlink()
        if kind == "pipe":
            os.mkfifo(path)
        elif kind == "device":
            path.symlink_to("/dev/zero")
        elif kind == "loop":
            path.symlink_to(path)
        else:
            path.mkdir()


@pytest.mark.skipif(sys.platform == "win32", reason="no such files")
@pytest.mark.parametrize("kind", ["pipe", "device", "loop"])
def test_what_is_no_file_is_exchanged_and_never_waited_for(
    warm: Path, tmp_path: Path, kind: str
) -> None:
    cache = tmp_path / "cache"
    shutil.copytree(warm, cache)
    in_place_of(cache, kind)
    assert run(cache) == ["compiling", "done"]
    assert run(cache) == ["done"]


# Where nothing can be kept.

TROUBLED = (
    SCRIPT
    + """
from vmesh.kernels.jit import take_trouble
print(take_trouble())
assert take_trouble() is None
"""
)


def trouble(start: str = "", **environment: str) -> str:
    """Why the code was not kept, told by a process that compiles it."""
    done = subprocess.run(
        [sys.executable, "-c", start + TROUBLED],
        env={**os.environ, **environment},
        capture_output=True,
        check=True,
        text=True,
    )
    assert done.stderr == ""
    first, second, told = done.stdout.splitlines()
    assert (first, second) == ("compiling", "done")
    return told


def test_a_full_disk_is_told_with_what_to_set(tmp_path: Path) -> None:
    pytest.importorskip("resource")
    start = (
        "import resource, signal\n"
        "signal.signal(signal.SIGXFSZ, signal.SIG_IGN)\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))\n"
    )
    told = trouble(start, NUMBA_CACHE_DIR=str(tmp_path))
    assert told.startswith(f"compiled code could not be kept in {tmp_path}")
    assert "File too large" in told
    assert "NUMBA_CACHE_DIR or XDG_CACHE_HOME" in told


def test_folders_in_the_place_of_files_are_told(warm: Path, tmp_path: Path) -> None:
    cache = tmp_path / "cache"
    shutil.copytree(warm, cache)
    in_place_of(cache, "folder")
    assert "could not be kept" in trouble(NUMBA_CACHE_DIR=str(cache))


def test_a_folder_that_goes_while_it_is_compiled_for_is_made_again_or_told(tmp_path: Path) -> None:
    start = (
        "import shutil, sys\n"
        "import vmesh.kernels.sobel\n"
        f"shutil.rmtree({str(tmp_path / 'cache')!r})\n"
        f"open({str(tmp_path / 'cache')!r}, 'x').close()\n"
    )
    told = trouble(start, NUMBA_CACHE_DIR=str(tmp_path / "cache"))
    assert "could not be kept" in told


def test_no_folder_at_all_is_told() -> None:
    # No locator finds a folder for it.
    start = (
        "from numba.core.caching import CompileResultCacheImpl\n"
        "from vmesh.kernels import jit\n"
        "jit._Cache._impl_class._locator_classes = []\n"
    )
    assert "no folder" in trouble(start)


# A folder of the user's own in the one for temporary files.


def temporary_folder(monkeypatch: pytest.MonkeyPatch, shared: Path) -> Path | None:
    """The folder that code is kept in below a folder for temporary files, if it is good enough."""
    monkeypatch.setattr(tempfile, "tempdir", str(shared))
    locator = TemporaryLocator.from_function(temporary_folder, __file__)
    return None if locator is None else Path(locator.get_cache_path()).parent


@pytest.mark.skipif(sys.platform == "win32", reason="no users")
def test_a_user_without_a_home_keeps_code_where_nobody_else_writes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tmp_path.chmod(0o1777)
    folder = temporary_folder(monkeypatch, tmp_path)
    assert folder is not None
    assert folder.stat().st_mode & 0o777 == 0o700
    assert temporary_folder(monkeypatch, tmp_path) == folder
    folder.chmod(0o770)
    assert temporary_folder(monkeypatch, tmp_path) is None


@pytest.mark.skipif(sys.platform == "win32", reason="no users")
def test_a_folder_that_others_could_have_made_or_exchanged_is_not_used(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tmp_path.chmod(0o1777)
    folder = temporary_folder(monkeypatch, tmp_path)
    assert folder is not None
    tmp_path.chmod(0o777)
    assert temporary_folder(monkeypatch, tmp_path) is None
    tmp_path.chmod(0o1777)
    shutil.move(folder, tmp_path / "elsewhere")
    folder.symlink_to(tmp_path / "elsewhere")
    assert temporary_folder(monkeypatch, tmp_path) is None
    folder.unlink()
    folder.touch()
    assert temporary_folder(monkeypatch, tmp_path) is None


def test_code_that_came_with_the_program_is_used_where_it_cannot_be_written(
    warm: Path, tmp_path: Path
) -> None:
    script = SCRIPT.replace(
        "import numpy as np\n",
        "import numpy as np\n"
        "from numba.core.caching import UserProvidedCacheLocator as Locator\n"
        "Locator.ensure_cache_path = lambda self: exec('raise PermissionError(13)')\n",
    )
    done = subprocess.run(
        [sys.executable, "-c", script],
        env={**os.environ, "NUMBA_CACHE_DIR": str(warm)},
        capture_output=True,
        check=True,
        text=True,
    )
    assert done.stdout.split() == ["done"]


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
    for name in (
        *("__init__.py", "errors.py"),
        *("kernels/__init__.py", "kernels/jit.py", "kernels/cache_files.py"),
    ):
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
