"""The compilation of kernels: a decorator for each kind, so that the flags stand in one place."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from hashlib import blake2b
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Final, TypeVar, cast

from numba import njit
from numba.core import config, event
from numba.core.caching import (
    CompileResultCacheImpl,
    FunctionCache,
    InTreeCacheLocator,
    NullCache,
    UserProvidedCacheLocator,
)

from vmesh.errors import shown
from vmesh.kernels.cache_files import CacheFile, TemporaryLocator

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


def take_trouble() -> str | None:
    """A sentence on why compiled code was not kept, once after each time that it was not."""
    sentence = _trouble[-1] if _trouble else None
    _trouble.clear()
    return sentence


_trouble: Final[list[str]] = []


def _cached(function: Function, options: dict[str, Any]) -> Function:
    """Compile a function, and keep it where there is a place for that."""
    dispatcher = njit(**options)(function)
    if hasattr(dispatcher, "_cache"):  # It has none where Numba is told not to compile.
        try:
            dispatcher._cache = _Cache(function)
        except (RuntimeError, OSError):  # There is no folder that could be written.
            dispatcher._cache = _NoCache()
    return cast("Function", dispatcher)


class _Cache(FunctionCache):  # type: ignore[misc]
    """Compiled code of a function, kept on disk as Numba does, and never an obstacle.

    Numba compares the stamp of the function's own file, but the code of the kernels that it calls,
    from whatever file, is part of what is kept. And it fails at files that are damaged, or name
    what an earlier version had, and where nothing can be written; here such a file counts as none,
    and code that cannot be kept is compiled again by the next process.
    """

    class _impl_class(CompileResultCacheImpl):  # type: ignore[misc]
        _locator_classes: ClassVar = [*CompileResultCacheImpl._locator_classes, TemporaryLocator]

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)
        stamp = self._impl.locator.get_source_stamp(), _digest_of_sources()
        self._cache_file = CacheFile(self.cache_path, self._impl.filename_base, stamp)
        # What others filled and we may only read, such as what came with a container.
        self._given = [
            CacheFile(path, self._impl.filename_base, stamp)
            for path in _paths_before(self._impl.locator, function)
        ]

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Compiled code for a signature, or None."""
        target_context.refresh()
        key = self._index_key(sig, target_context.codegen())
        for file in (self._cache_file, *self._given):
            with suppress(Exception):  # Whatever another version may raise.
                kept = file.load(key)
                if kept is not None:
                    return self._impl.rebuild(target_context, kept)
        return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep compiled code, if that can be."""
        try:
            self._save_overload(sig, data)
        except Exception as error:
            reason = error.strerror if isinstance(error, OSError) else None
            _tell(f"in {shown(self.cache_path)}: {reason or type(error).__name__}")


class _NoCache(NullCache):  # type: ignore[misc]
    """No place for the compiled code of a function."""

    def save_overload(self, sig: Any, cres: Any) -> None:
        """Say that it is not kept."""
        _tell("as no folder for it can be written")


def _tell(reason: str) -> None:
    _trouble.append(
        f"compiled code could not be kept {reason}; every run compiles it anew until "
        "NUMBA_CACHE_DIR or XDG_CACHE_HOME names a folder that can be written"
    )


def _paths_before(locator: Any, function: Callable[..., Any]) -> list[str]:
    """Folders that Numba would rather have kept a function's code in, but could not write."""
    if isinstance(locator, UserProvidedCacheLocator):
        return []
    before = [UserProvidedCacheLocator] if getattr(config, "CACHE_DIR", "") else []
    if type(locator) is not InTreeCacheLocator:
        before.append(InTreeCacheLocator)
    return [cls(function, inspect.getfile(function)).get_cache_path() for cls in before]


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
