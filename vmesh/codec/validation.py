"""Everything that is wrong with a .vmesh file, where reading it stops at the first."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from vmesh.codec.container import read_file
from vmesh.codec.layout import CHUNK_NAMES
from vmesh.codec.reader import decode
from vmesh.errors import FormatError, LimitError
from vmesh.limits import DEFAULT_LIMITS, Limits


class Severity(StrEnum):
    """How bad a finding is."""

    ERROR = "error"
    """A rule of the format is broken, or could not be checked."""
    NOTE = "note"
    """Nothing is wrong, but a user may want to know."""


@dataclass(frozen=True, slots=True)
class Finding:
    """Something that was found in a file.

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
    found: dict[Finding, None] = {}  # In order, each once.

    def complain(error: FormatError | LimitError) -> None:
        """Note an error."""
        if isinstance(error, FormatError):
            finding = Finding(Severity.ERROR, error.code, error.message, error.offset)
        else:
            finding = Finding(Severity.ERROR, "limit", str(error), None)
        found[finding] = None

    try:
        container = read_file(bytes(memoryview(data)), complain, complain)
        for chunk in container.ancillary:
            if not chunk.is_critical and chunk.tag not in CHUNK_NAMES:
                text = f"ancillary chunk {chunk.tag.decode()} is unknown, and kept as it is"
                found[Finding(Severity.NOTE, "unknown", text, chunk.offset)] = None
        decode(container, limits, complain, complain)
    except (FormatError, LimitError) as error:
        complain(error)
    return list(found)
