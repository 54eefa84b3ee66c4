"""Findings in a .vmesh file: all that is wrong with it, where reading it stops at the first."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from vmesh.codec.layout import Chunk
from vmesh.codec.policy import Collecting
from vmesh.codec.reader import read
from vmesh.errors import FormatError, LimitError
from vmesh.limits import DEFAULT_LIMITS, Limits


class Severity(StrEnum):
    """Severity of a finding."""

    ERROR = "error"
    """A rule of the format is broken, or could not be checked."""
    NOTE = "note"
    """Nothing is wrong, but a user may want to know."""


@dataclass(frozen=True, slots=True)
class Finding:
    """Finding in a file: a rule that it breaks, or what a user may want to know.

    Parameters
    ----------
    severity : Severity
    code : str
        The stable name of the broken rule, from the error table of ``spec/vmesh.md``; ``limit`` if
        the file asks for more than was allowed; ``unknown`` for an ancillary chunk that is not
        known.
    message : str
        What was found and what was wanted.
    offset : int or None
        Byte offset in the file, None if it has none.
    """

    severity: Severity
    code: str
    message: str
    offset: int | None


def validate(
    data: bytes | bytearray | memoryview, *, limits: Limits = DEFAULT_LIMITS
) -> list[Finding]:
    """Findings in the bytes of a file, in the order of a reader; a file without errors conforms.

    It goes on after an error wherever what follows can still be told apart.

    Parameters
    ----------
    data : bytes-like
        A whole file.
    limits : Limits
        What the file may ask for.
    """
    policy = Collecting()
    last: list[FormatError | LimitError] = []
    try:
        read(data, policy, limits=limits)
    except (FormatError, LimitError) as error:
        last.append(error)
    # In order, each once.
    return list(dict.fromkeys(map(_finding_of, [*policy.found, *last])))


def _finding_of(found: FormatError | LimitError | Chunk) -> Finding:
    """Finding that tells of an error, or of a chunk that is unknown."""
    if isinstance(found, FormatError):
        return Finding(Severity.ERROR, found.code, found.message, found.offset)
    if isinstance(found, LimitError):
        return Finding(Severity.ERROR, "limit", str(found), None)
    text = f"ancillary {found.name} is unknown, and kept as it is"
    return Finding(Severity.NOTE, "unknown", text, found.offset)
