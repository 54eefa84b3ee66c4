"""A PDF file that is written as its objects come, so that hardly more than one is held in memory.

pydyf says how objects look. Its own document holds all of them until the end, and then joins them
once more; an album of a thousand photographs is hundreds of megabytes.

The version is 1.4, of which soft masks and XMP are; shadings of type 4 are of 1.3. Pages that count
in larger units need 1.6. Profiles may be newer: programs read them whatever the version, or take
the device's colours in their place. Object streams, of 1.5, would save 50 to 130 bytes.

References
----------
ISO 32000-2, 7.5: header, body, cross-reference table and trailer; 12.3.3: outlines.
"""

from __future__ import annotations

import hashlib
from itertools import count
from typing import Any, BinaryIO, Final

import pydyf

_VERSION: Final = "1.4"
_USER_UNIT_VERSION: Final = "1.6"
_COMMENT: Final = b"%\xf0\x9f\x96\xa4"  # bytes beyond ASCII: this is no text


class PdfFile:
    """A PDF file that is being written.

    Parameters
    ----------
    stream : binary file
    """

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream
        self._position = 0
        self._digest = hashlib.md5(usedforsecurity=False)
        self._offsets = [0]  # number 0 is no object
        self._page_references: Any = pydyf.Array()
        self._titles: list[str] = []
        self.info: Any = pydyf.Dictionary()
        self.pages: Any = self._numbered(pydyf.Dictionary({"Type": "/Pages"}))
        self.catalog: Any = self._numbered(pydyf.Dictionary({"Type": "/Catalog"}))
        self._write(b"%%PDF-%s" % _VERSION.encode("ascii"))
        self._write(_COMMENT)

    def add_object(self, item: Any) -> None:
        """Write an object, which is complete; it gets a number to refer to it by."""
        self._write_object(self._numbered(item))

    def add_page(self, page: Any, title: str = "") -> None:
        """Write a page; a title is for the outline."""
        if "UserUnit" in page:
            self.catalog["Version"] = f"/{_USER_UNIT_VERSION}"
        self.add_object(page)
        self._page_references.append(page.reference)
        self._titles.append(title)

    def close(self, *, has_outline: bool = False) -> None:
        """Write what tells where the objects are."""
        self.pages["Kids"], self.pages["Count"] = self._page_references, len(self._page_references)
        self.catalog["Pages"] = self.pages.reference
        if has_outline:
            self.catalog["Outlines"] = self._add_outline()
        self._write_object(self.pages)
        self._write_object(self.catalog)
        if self.info:
            self.add_object(self.info)
        start = self._position
        rows = "".join(f"{offset:010} 00000 n \n" for offset in self._offsets[1:])
        self._write(f"xref\n0 {len(self._offsets)}\n0000000000 65535 f \n{rows}trailer".encode())
        name = pydyf.String(self._digest.hexdigest()).data
        trailer = pydyf.Dictionary({"Size": len(self._offsets), "Root": self.catalog.reference})
        if self.info:
            trailer["Info"] = self.info.reference
        trailer["ID"] = pydyf.Array([name, name])
        self._write(trailer.data)
        self._write(f"startxref\n{start}\n%%EOF".encode("ascii"))

    def _add_outline(self) -> bytes:
        """Write an outline with the titles of the pages; returns a reference to it."""
        root: Any = self._numbered(pydyf.Dictionary({"Type": "/Outlines"}))
        items: list[Any] = [self._numbered(pydyf.Dictionary()) for _ in self._titles]
        root.update(First=items[0].reference, Last=items[-1].reference, Count=len(items))
        for item, title, page, i in zip(
            items, self._titles, self._page_references, count(), strict=False
        ):
            item.update(Title=pydyf.String(title), Parent=root.reference)
            item["Dest"] = pydyf.Array([page, "/Fit"])
            if i > 0:
                item["Prev"] = items[i - 1].reference
            if i + 1 < len(items):
                item["Next"] = items[i + 1].reference
        for item in (root, *items):
            self._write_object(item)
        reference: bytes = root.reference
        return reference

    def _numbered(self, item: Any) -> Any:
        """An object with a number, that is written later."""
        item.number = len(self._offsets)
        self._offsets.append(0)
        return item

    def _write_object(self, item: Any) -> None:
        self._offsets[item.number] = self._position
        self._write(item.indirect)

    def _write(self, line: bytes) -> None:
        self._digest.update(line)
        self._stream.write(line + b"\n")
        self._position += len(line) + 1
