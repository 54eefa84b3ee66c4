"""The compilation of kernels: a decorator for each kind, so that the flags stand in one place."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from hashlib import blake2b
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, TypeVar, cast

from numba import njit
from numba.core import event
from numba.core.caching import IndexDataCacheFile

if TYPE_CHECKING:
    from numba.core.event import Event

# No wrapper for C: nothing calls kernels from there.
_OPTIONS: Final[dict[str, Any]] = {"nogil": True, "no_cfunc_wrapper": True}
# No counting of references: it would take up to six locked instructions in each call of a kernel
# with arrays, most of the time of a small one.
_LEAN_OPTIONS: Final[dict[str, Any]] = {**_OPTIONS, "_nrt": False}
_INNER_OPTIONS: Final[dict[str, Any]] = {**_LEAN_OPTIONS, "no_cpython_wrapper": True}

Function = TypeVar("Function", bound=Callable[..., Any])


def kernel(function: Function) -> Function:
    """Compile a function to machine code on its first call and keep the code on disk.

    No fast-math and no parallel loops: results depend neither on the machine's vector width nor
    on its number of threads. Where no cache folder is writable the code is compiled anew in each
    process.
    """
    return _cached(function, _OPTIONS)


def lean_kernel(function: Function) -> Function:
    """Compile a kernel that makes no arrays, for other kernels to call in their loops."""
    return _cached(function, _LEAN_OPTIONS)


def inner_kernel(function: Function) -> Function:
    """Compile a lean kernel that only kernels call: it has no entry point for Python.

    Leaving that out takes up to half off the time of its compilation. A call from Python ends the
    process.
    """
    return cast("Function", njit(**_INNER_OPTIONS)(function))


def _cached(function: Function, options: dict[str, Any]) -> Function:
    """Compile a function, and keep it where there is a place for that."""
    try:
        dispatcher = njit(cache=True, **options)(function)
    except RuntimeError:  # Numba found no folder that it may write its cache to.
        return cast("Function", njit(**options)(function))
    kept = getattr(dispatcher, "_cache", None)  # None where Numba is told not to compile.
    if kept is not None:
        stamp = kept._impl.locator.get_source_stamp(), _digest_of_sources()
        kept._cache_file = _CacheFile(kept.cache_path, kept._impl.filename_base, stamp)
    return cast("Function", dispatcher)


class _CacheFile(IndexDataCacheFile):  # type: ignore[misc]
    """Compiled code on disk that is good for one state of all kernels, and never an obstacle.

    Numba compares the stamp of the function's own file, but the code of the kernels that it calls,
    from whatever file, is part of what is kept. And it fails at files that are damaged, or name
    what an earlier version had; here they count as none, and are written anew.
    """

    def _load_index(self) -> dict[Any, str]:
        try:
            index: dict[Any, str] = super()._load_index()
        except Exception:  # Whatever the unpickling of bytes may raise.
            return {}
        return index

    def _load_data(self, name: str) -> tuple[Any, ...]:
        try:
            code: tuple[Any, ...] = super()._load_data(name)
            if not isinstance(code, tuple):
                raise TypeError(f"expected a tuple, got {code!r}")
        except Exception as error:
            raise OSError(f"{name} is no compiled code") from error  # Then Numba compiles.
        return code

    def save(self, key: Any, data: Any) -> None:
        with suppress(OSError):
            super().save(key, data)


@cache
def _digest_of_sources() -> str:
    """Digest of all kernels' sources: any change in them makes what is kept out of date."""
    folder = Path(__file__).parent
    digest = blake2b(digest_size=16)
    for path in sorted(folder.rglob("*.py")):
        source = path.read_bytes()
        digest.update(f"{path.relative_to(folder).as_posix()} {len(source)}\n".encode() + source)
    return digest.hexdigest()


class _FirstCompilation(event.Listener):
    """Calls `announce` when the first kernel is about to be compiled."""

    def __init__(self, announce: Callable[[], None]) -> None:
        self.announce: Callable[[], None] | None = announce

    def on_start(self, event: Event) -> None:
        if self.announce is not None:
            announce, self.announce = self.announce, None
            announce()

    def on_end(self, event: Event) -> None:
        pass


@contextmanager
def on_first_compilation(notify: Callable[[], None]) -> Iterator[None]:
    """Call `notify` once if a kernel inside the block is not in the cache and must be compiled."""
    with event.install_listener("numba:compile", _FirstCompilation(notify)):
        yield
