"""The name of an ICC profile, read without a library: a figure of a file, not of its colours.

::

    header (128)   count   tag offset size   tag offset size   ...
                           "desc" ----> "desc" .... length  ASCII                    (version 2)
                                        "mluc" .... count size  language length offset   (4)

References
----------
ICC.1:2001-04, 6.5.17 (textDescriptionType); ICC.1:2022, 9.2.41, 10.15 (multiLocalizedUnicodeType).
"""

from __future__ import annotations

import struct
from typing import Final

_TABLE: Final = 128  # where the count of tags stands, before their rows
_ROW: Final = struct.Struct(">4sII")
_MOST_TAGS: Final = 200
_LONGEST: Final = 80  # characters that a line has room for


def profile_name(profile: bytes) -> str:
    """Name of an ICC profile by its description, empty if it has none that makes sense."""
    (count,) = struct.unpack(">I", profile[_TABLE : _TABLE + 4].ljust(4, b"\0"))
    for i in range(min(count, _MOST_TAGS)):
        row = profile[_TABLE + 4 + _ROW.size * i :][: _ROW.size]
        if len(row) < _ROW.size:
            break
        tag, offset, size = _ROW.unpack(row)
        if tag == b"desc":
            return _line(_text(profile[offset : offset + size]))
    return ""


def _text(content: bytes) -> str:
    """The text of a description."""
    kind = content[:4]
    if kind == b"desc":
        (length,) = struct.unpack(">I", content[8:12].ljust(4, b"\0"))
        return content[12 : 12 + length].partition(b"\0")[0].decode("latin-1")
    if kind == b"text":
        return content[8:].partition(b"\0")[0].decode("latin-1")
    if kind == b"mluc" and len(content) >= 28:
        length, offset = struct.unpack(">II", content[20:28])  # of the first language
        return content[offset : offset + length].decode("utf-16-be", "replace")
    return ""


def _line(text: str) -> str:
    """A text without what does not print, and no longer than a line has room for."""
    return "".join(letter for letter in text.strip() if letter.isprintable())[:_LONGEST].rstrip()
