"""XMP packets: one of what may be shown, of another.

Only properties of the list below are taken over, and of them only text: alone, or as items of a
list. So no structure, with whatever it may hold, is.

References
----------
ISO 16684-1:2019, 7: serialisation as RDF/XML. IPTC Photo Metadata Standard 2023.1.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from typing import Final

from lxml import etree

_RDF: Final = "http://www.w3.org/1999/02/22-rdf-syntax-ns#"
_META: Final = "adobe:ns:meta/"
_LANGUAGE: Final = "{http://www.w3.org/XML/1998/namespace}lang"
_LISTS: Final = tuple(f"{{{_RDF}}}{kind}" for kind in ("Alt", "Seq", "Bag"))
_ITEM: Final = f"{{{_RDF}}}li"
_DESCRIPTION: Final = f"{{{_RDF}}}Description"
_ABOUT: Final = f"{{{_RDF}}}about"
_MOST_BYTES: Final = 1 << 24  # of a packet that is worth its time
_START: Final = '<?xpacket begin="\ufeff" id="W5M0MpCehiHzreSzNTczkc9d"?>\n'
_END: Final = '\n<?xpacket end="w"?>'

# Namespace -> its usual prefix, and the names of properties that may be shown.
_PUBLIC: Final = {
    "http://purl.org/dc/elements/1.1/": (
        "dc",
        "title creator description rights subject date publisher contributor language type format",
    ),
    "http://ns.adobe.com/xap/1.0/": (
        "xmp",
        "CreateDate ModifyDate MetadataDate CreatorTool Rating Label",
    ),
    "http://ns.adobe.com/xap/1.0/rights/": ("xmpRights", "Marked UsageTerms WebStatement Owner"),
    "http://ns.adobe.com/photoshop/1.0/": (
        "photoshop",
        "DateCreated Headline Credit Source AuthorsPosition CaptionWriter",
    ),
    "http://iptc.org/std/Iptc4xmpCore/1.0/xmlns/": (
        "Iptc4xmpCore",
        "AltTextAccessibility ExtDescrAccessibility IntellectualGenre Scene SubjectCode",
    ),
    "http://iptc.org/std/Iptc4xmpExt/2008-02-29/": ("Iptc4xmpExt", "DigitalSourceType Event"),
    "http://ns.useplus.org/ldf/xmp/1.0/": ("plus", "DataMining OtherConditions"),
    "http://creativecommons.org/ns#": ("cc", "license attributionName attributionURL"),
    "http://ns.adobe.com/tiff/1.0/": (
        "tiff",
        "Make Model Artist Copyright ImageDescription DateTime Software XResolution YResolution "
        "ResolutionUnit",
    ),
    "http://ns.adobe.com/exif/1.0/": (
        "exif",
        "ExposureTime FNumber ExposureProgram ISOSpeedRatings DateTimeOriginal DateTimeDigitized "
        "ShutterSpeedValue ApertureValue BrightnessValue ExposureBiasValue MaxApertureValue "
        "SubjectDistance MeteringMode LightSource FocalLength FocalLengthIn35mmFilm ColorSpace "
        "ExposureMode WhiteBalance DigitalZoomRatio SceneCaptureType UserComment",
    ),
    "http://cipa.jp/exif/1.0/": (
        "exifEX",
        "PhotographicSensitivity SensitivityType LensMake LensModel LensSpecification",
    ),
    "http://ns.adobe.com/exif/1.0/aux/": ("aux", "Lens LensInfo"),
}
_NAMES: Final = {
    f"{{{space}}}{name}" for space, (_, names) in _PUBLIC.items() for name in names.split()
}
_PREFIXES: Final = {prefix: space for space, (prefix, _) in _PUBLIC.items()}


def parse_packet(packet: bytes) -> etree._Element | None:
    """The root of a packet, none if it makes no sense; nothing outside of it is read."""
    parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False)
    for text in (packet, packet.rstrip(b"\0")):  # some programs fill up with zeros
        with suppress(etree.XMLSyntaxError, ValueError):  # also of an empty packet
            return etree.fromstring(text, parser)
    return None


def public_packet(packet: bytes) -> bytes:
    """A packet of the properties that may be shown, empty if there are none or it is damaged."""
    root = parse_packet(packet) if len(packet) <= _MOST_BYTES else None
    if root is None:
        return b""
    described = etree.Element(_DESCRIPTION, {_ABOUT: ""}, nsmap={"rdf": _RDF})
    for name, value in _properties(root):
        if name in _NAMES and described.find(name) is None:
            _add(described, name, value)
    if not len(described):
        return b""
    meta = etree.Element(f"{{{_META}}}xmpmeta", nsmap={"x": _META})
    etree.SubElement(meta, f"{{{_RDF}}}RDF", nsmap={"rdf": _RDF}).append(described)
    etree.cleanup_namespaces(meta, top_nsmap={"x": _META, "rdf": _RDF, **_PREFIXES})
    return (_START + etree.tostring(meta, encoding="unicode") + _END).encode()


def _properties(root: etree._Element) -> Iterator[tuple[str, str | etree._Element]]:
    """Names and values of the properties of the picture itself: attributes or elements."""
    rdf = next(root.iter(f"{{{_RDF}}}RDF"), root)
    for description in rdf.iterfind(_DESCRIPTION):
        yield from ((str(name), str(value)) for name, value in description.items())
        for child in description:
            if isinstance(child.tag, str):  # no comment
                yield child.tag, child


def _add(described: etree._Element, name: str, value: str | etree._Element) -> None:
    """Add a property, if its value is text or a list of texts."""
    if isinstance(value, str):
        etree.SubElement(described, name).text = value
        return
    if not len(value):
        resource = value.get(f"{{{_RDF}}}resource")
        if text := value.text or resource:
            etree.SubElement(described, name).text = text
        return
    kind = value[0].tag
    items = [item for item in value[0] if item.tag == _ITEM and not len(item) and item.text]
    if kind not in _LISTS or not items:
        return
    container = etree.SubElement(etree.SubElement(described, name), str(kind))
    for item in items:
        language = item.get(_LANGUAGE)
        copy = etree.SubElement(container, _ITEM, {_LANGUAGE: language} if language else {})
        copy.text = item.text
