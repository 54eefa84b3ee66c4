"""How kernels are compiled: one decorator, so that the flags stand in one place."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Final, TypeVar, cast

from numba import njit
from numba.core import event

if TYPE_CHECKING:
    from numba.core.event import Event

# No wrapper for C: nothing calls kernels from there.
_OPTIONS: Final[dict[str, Any]] = {"nogil": True, "no_cfunc_wrapper": True}
_INNER_OPTIONS: Final[dict[str, Any]] = {**_OPTIONS, "no_cpython_wrapper": True}

Function = TypeVar("Function", bound=Callable[..., Any])


def kernel(function: Function) -> Function:
    """Compile a function to machine code on its first call and keep the code on disk.

    No fast-math and no parallel loops: results depend neither on the machine's vector width nor
    on its number of threads. Where no cache folder is writable the code is compiled anew in each
    process.
    """
    try:
        return cast("Function", njit(cache=True, **_OPTIONS)(function))
    except RuntimeError:  # Numba found no folder that it may write its cache to.
        return cast("Function", njit(**_OPTIONS)(function))


def inner_kernel(function: Function) -> Function:
    """Compile a function that only kernels of its own file call: there is no way in from Python.

    Not making one takes up to half off the time that its compilation takes. A call from Python
    ends the process.
    """
    return cast("Function", njit(**_INNER_OPTIONS)(function))


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
