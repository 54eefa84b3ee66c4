"""The errors a caller may catch.

::

    Exception
    ├── VmeshError               everything this library raises on purpose about data
    │   ├── FormatError          the bytes are not a conforming .vmesh file (also a ValueError)
    │   ├── LimitError           conforming, but more than the caller allows
    │   ├── ImageError           the file is not a photograph that can be read
    │   └── MeshError            another program's mesh cannot be read (also a ValueError)
    ├── ValueError, TypeError    a wrong argument
    ├── OSError                  the operating system refused
    └── PartialFileWarning       not raised, but shown: a file that was cut off is read in part
"""

from __future__ import annotations

import os
import unicodedata
from typing import Final

# Controls, directions and other formats, halves of surrogate pairs, ends of lines and paragraphs.
_UNSEEN: Final = frozenset(("Cc", "Cf", "Cs", "Zl", "Zp"))
_JOINERS: Final = "\u200c\u200d"  # Formats that languages and pictograms are written with.


class VmeshError(Exception):
    """Base of all errors about the data that vmesh was given."""


class FormatError(VmeshError, ValueError):
    """The bytes are not a conforming ``.vmesh`` file.

    Parameters
    ----------
    code : str
        The stable name of the broken rule, from the error table of ``spec/vmesh.md``.
    message : str
        What was found and what was wanted.
    offset : int
        Byte offset in the file at which the rule is broken.
    """

    def __init__(self, code: str, message: str, offset: int) -> None:
        super().__init__(f"{message} (code {code}, at byte {offset})")
        self.code = code
        self.message = message
        self.offset = offset


class LimitError(VmeshError):
    """The data conform, but ask for more than the caller's :class:`vmesh.Limits` allow."""


class ImageError(VmeshError):
    """The file is not a photograph that can be read."""


class MeshError(VmeshError, ValueError):
    """The file of another program is not a mesh that can be read."""


class PartialFileWarning(UserWarning):
    """A file ends too early, and its mesh holds what its start could tell."""


def describe(error: BaseException) -> str:
    """One line that says what went wrong."""
    if isinstance(error, MemoryError):
        return "not enough memory"
    if isinstance(error, OSError) and error.strerror and error.filename is not None:
        name = error.filename
        path = os.fsdecode(name) if isinstance(name, bytes) else name
        return shown(f"{path}: {error.strerror}")
    text = shown(" ".join(str(error).split())) or type(error).__name__
    if isinstance(error, VmeshError | OSError | ValueError):
        return text
    return f"{type(error).__name__}: {text}"


def shown(text: str) -> str:
    """A text as a line that a terminal shows and does not obey, such as the name of a file.

    What moves the cursor, ends a line or turns the direction of writing is written as an escape
    sequence of Python's, and so is a byte of a name that is no character of the system's encoding.
    """
    return text if text.isprintable() else "".join(map(_shown_character, text))


def _shown_character(character: str) -> str:
    if "\udc80" <= character <= "\udcff":
        return f"\\x{ord(character) - 0xDC00:02x}"
    if character in _JOINERS or unicodedata.category(character) not in _UNSEEN:
        return character
    return character.encode("unicode_escape").decode()
