"""Metadata of a phone, in which all that is private holds one word."""

from __future__ import annotations

from typing import Any, Final

from PIL import Image
from PIL.TiffImagePlugin import IFDRational as Rational

from vmesh.mesh import Metadata

SECRET: Final = "S3CRET"
TITLE: Final = "Harbour at dusk"

_DETAILS, _PLACE, _INTEROPERABILITY = 0x8769, 0x8825, 0xA005
_WORD: Final = SECRET.encode()


def exif_block() -> bytes:
    """An EXIF block, from its TIFF header on."""
    exif = Image.Exif()
    exif[270], exif[271], exif[272], exif[315], exif[33432] = TITLE, "Make", "Model", "Me", "(c) Me"
    exif[306], exif[305], exif[18246] = "2021:02:03 04:05:06", "software", 4
    exif[282] = exif[283] = Rational(300)
    exif[296] = 2
    exif[316] = SECRET  # the computer's name
    exif[700], exif[33723], exif[34377], exif[50740] = _WORD, _WORD, _WORD, _WORD * 3
    exif[33550], exif[50735] = (1.0, 2.0, 3.0), SECRET  # a place on a map, a serial number
    details = exif.get_ifd(_DETAILS)
    details.update(
        {
            33434: Rational(1, 125),
            33437: Rational(28, 10),
            34855: 400,
            36864: b"0232",
            36867: "2021:02:03 04:05:06",
            37380: Rational(-2, 3),
            37386: Rational(50),
            42036: "Lens 50",
        }
    )
    details[37500] = 50 * _WORD  # the maker's note
    details.update({42016: SECRET, 42032: SECRET, 42033: SECRET, 42037: SECRET})
    details[_INTEROPERABILITY] = {1: "R98", 2: b"0100", 4096: SECRET}
    place = exif.get_ifd(_PLACE)
    place.update({1: "N", 2: (Rational(48), Rational(51), Rational(30)), 29: SECRET})
    return exif.tobytes().removeprefix(b"Exif\0\0")


def xmp_packet() -> bytes:
    """An XMP packet with properties as attributes, as text, as lists and as structures."""
    spaces = {
        "dc": "http://purl.org/dc/elements/1.1/",
        "xmp": "http://ns.adobe.com/xap/1.0/",
        "xmpMM": "http://ns.adobe.com/xap/1.0/mm/",
        "stEvt": "http://ns.adobe.com/xap/1.0/sType/ResourceEvent#",
        "exif": "http://ns.adobe.com/exif/1.0/",
        "aux": "http://ns.adobe.com/exif/1.0/aux/",
        "photoshop": "http://ns.adobe.com/photoshop/1.0/",
        "core": "http://iptc.org/std/Iptc4xmpCore/1.0/xmlns/",
        "ext": "http://iptc.org/std/Iptc4xmpExt/2008-02-29/",
        "maker": "http://maker.example/notes/",
    }
    named = " ".join(f'xmlns:{prefix}="{space}"' for prefix, space in spaces.items())
    return f"""<?xpacket begin="\ufeff" id="W5M0MpCehiHzreSzNTczkc9d"?>
<x:xmpmeta xmlns:x="adobe:ns:meta/" x:xmptk="{SECRET}">
<rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#">
<rdf:Description rdf:about="uuid:{SECRET}" {named} xmp:Rating="4" xmp:CreateDate="2021-02-03"
  exif:GPSLatitude="48,51.5N {SECRET}" photoshop:City="{SECRET}" photoshop:Country="{SECRET}"
  xmpMM:DocumentID="{SECRET}" aux:SerialNumber="{SECRET}" aux:OwnerName="{SECRET}"
  core:Location="{SECRET}" maker:note="{SECRET}">
<dc:title><rdf:Alt><rdf:li xml:lang="x-default">{TITLE}</rdf:li></rdf:Alt></dc:title>
<dc:creator><rdf:Seq><rdf:li>Me</rdf:li></rdf:Seq></dc:creator>
<dc:rights><rdf:Alt><rdf:li xml:lang="x-default">(c) Me &amp; you</rdf:li></rdf:Alt></dc:rights>
<dc:subject><rdf:Bag><rdf:li>ships</rdf:li>
  <rdf:li rdf:parseType="Resource"><maker:deep>{SECRET}</maker:deep></rdf:li></rdf:Bag></dc:subject>
<xmpMM:History><rdf:Seq><rdf:li stEvt:softwareAgent="{SECRET}"/></rdf:Seq></xmpMM:History>
<ext:LocationCreated><rdf:Bag><rdf:li rdf:parseType="Resource"><ext:City>{SECRET}</ext:City>
  </rdf:li></rdf:Bag></ext:LocationCreated>
<photoshop:Source rdf:parseType="Resource"><maker:x>{SECRET}</maker:x></photoshop:Source>
</rdf:Description>
<rdf:Description rdf:about="" xmlns:photoshop="http://ns.adobe.com/photoshop/1.0/">
<photoshop:State>{SECRET}</photoshop:State><!-- {SECRET} -->
<photoshop:Headline>Ships</photoshop:Headline>
</rdf:Description>
</rdf:RDF></x:xmpmeta><?xpacket end="w"?>""".encode()


def private_metadata(icc: bytes = b"") -> Metadata:
    """Metadata with a secret in every block that may have one."""
    unknown = ((b"q", _WORD),)
    return Metadata(icc=icc, exif=exif_block(), xmp=xmp_packet(), unknown=unknown)


def entries(block: bytes) -> dict[int, Any]:
    """Entries of the first two directories of an EXIF block, as Pillow reads them."""
    exif = Image.Exif()
    exif.load(b"Exif\0\0" + block)
    return {**exif, **exif.get_ifd(_DETAILS)}
