"""Policies of reading a file: what becomes of damage after which it can still be read on.

::

                 complain: a field    lose: a tile is    keep: a chunk
                 breaks a rule        damaged            is unknown
    Strict       raise                raise              -
    Partial      raise, if not cut    note               -
    Collecting   note                 note               note

What ends the reading in any case is raised past the policy.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from vmesh.errors import FormatError

if TYPE_CHECKING:
    from vmesh.codec.layout import Chunk


class Policy(Protocol):
    """Policy of reading a file.

    Attributes
    ----------
    errors : list of FormatError
        Errors that were noted instead of raised, in the order of a reader.
    """

    errors: list[FormatError]

    def complain(self, error: FormatError) -> None:
        """Raise or note an error after which the file can still be read on."""

    def lose(self, error: FormatError) -> None:
        """Raise or note an error by which a tile is lost."""

    def keep(self, chunk: Chunk) -> None:
        """Note an ancillary chunk that is unknown, which breaks no rule, or pass over it."""


class Strict:
    """Policy that refuses a file with its first error."""

    def __init__(self) -> None:
        self.errors: list[FormatError] = []

    def complain(self, error: FormatError) -> None:
        """Raise it."""
        raise error

    def lose(self, error: FormatError) -> None:
        """Raise it."""
        raise error

    def keep(self, chunk: Chunk) -> None:
        """Pass over it."""


class Partial:
    """Policy that takes what there is of a file that was cut off, or has lost tiles."""

    def __init__(self) -> None:
        self.errors: list[FormatError] = []

    def complain(self, error: FormatError) -> None:
        """Note that the file was cut off; raise all else."""
        if error.code != "truncated":
            raise error
        self.errors.append(error)

    def lose(self, error: FormatError) -> None:
        """Note it."""
        self.errors.append(error)

    def keep(self, chunk: Chunk) -> None:
        """Pass over it."""


class Collecting:
    """Policy that reads on wherever that can be, and notes all there is to say.

    Attributes
    ----------
    errors : list of FormatError
    found : list of FormatError or Chunk
        The errors and, among them in the order of a reader, chunks that are unknown.
    """

    def __init__(self) -> None:
        self.errors: list[FormatError] = []
        self.found: list[FormatError | Chunk] = []

    def complain(self, error: FormatError) -> None:
        """Note it."""
        self.errors.append(error)
        self.found.append(error)

    lose = complain

    def keep(self, chunk: Chunk) -> None:
        """Note it."""
        self.found.append(chunk)
