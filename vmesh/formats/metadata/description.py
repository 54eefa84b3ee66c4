"""The description of a picture in the documents that show it: PDF, SVG and pages."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Final
from xml.sax.saxutils import escape

from vmesh.formats.metadata.exif import read_exif
from vmesh.mesh import Metadata

_PRODUCER: Final = "vmesh"
_DESCRIPTION, _ARTIST, _COPYRIGHT = 270, 315, 33432
_DATES: Final = (36867, 306)  # when the picture was taken, when its file was changed
_DATE: Final = re.compile(r"(\d{4}):([01]\d):([0-3]\d) ([0-2]\d):([0-5]\d):([0-5]\d)")
_PACKET: Final = """<?xpacket begin="\ufeff" id="W5M0MpCehiHzreSzNTczkc9d"?>
<x:xmpmeta xmlns:x="adobe:ns:meta/">
<rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#">
<rdf:Description rdf:about=""
 xmlns:pdf="http://ns.adobe.com/pdf/1.3/"
 xmlns:xmp="http://ns.adobe.com/xap/1.0/"
 xmlns:dc="http://purl.org/dc/elements/1.1/">
{}
</rdf:Description>
</rdf:RDF>
</x:xmpmeta>
<?xpacket end="w"?>"""
_ITEM: Final = '<rdf:{0}><rdf:li xml:lang="x-default">{1}</rdf:li></rdf:{0}>'


@dataclass(frozen=True, slots=True)
class Description:
    """Facts about a picture, empty where nothing is known.

    No date is made up: the same mesh gives the same bytes.

    Parameters
    ----------
    title, author, rights : str
    date : tuple of str
        Year, month, day, hour, minute and second, as digits.
    """

    title: str = ""
    author: str = ""
    rights: str = ""
    date: tuple[str, ...] = ()

    @classmethod
    def of(cls, metadata: Metadata) -> Description:
        """Description by a picture's EXIF."""
        exif = read_exif(metadata.exif)
        title, author, rights = (
            _text(exif.get(tag)) for tag in (_DESCRIPTION, _ARTIST, _COPYRIGHT)
        )
        dates = (_DATE.fullmatch(_text(exif.get(tag))) for tag in _DATES)
        return cls(title, author, rights, next((date.groups() for date in dates if date), ()))

    def as_information(self) -> dict[str, str]:
        """Entries of the document information dictionary."""
        year_to_second = "".join(self.date)
        entries = {
            "Title": self.title,
            "Author": self.author,
            "CreationDate": f"D:{year_to_second}" if self.date else "",
            "Producer": _PRODUCER,
        }
        return {name: text for name, text in entries.items() if text}

    def as_xmp(self) -> bytes:
        """The XMP packet of the document."""
        lines = [
            f"<pdf:Producer>{_PRODUCER}</pdf:Producer>",
            "<dc:format>application/pdf</dc:format>",
        ]
        if self.title:
            lines.append(f"<dc:title>{_ITEM.format('Alt', escape(self.title))}</dc:title>")
        if self.author:
            author = f"<rdf:Seq><rdf:li>{escape(self.author)}</rdf:li></rdf:Seq>"
            lines.append(f"<dc:creator>{author}</dc:creator>")
        if self.rights:
            lines.append(f"<dc:rights>{_ITEM.format('Alt', escape(self.rights))}</dc:rights>")
        if self.date:
            date = "{}-{}-{}T{}:{}:{}".format(*self.date)
            lines.append(f"<xmp:CreateDate>{date}</xmp:CreateDate>")
        return _PACKET.format("\n".join(lines)).encode()


def _text(value: object) -> str:
    """An entry as text, without what XML and one line do not hold."""
    if not isinstance(value, str):
        return ""
    return "".join(letter for letter in value.strip() if letter.isprintable())
