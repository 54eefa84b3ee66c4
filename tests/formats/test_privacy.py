"""Metadata that are left out, and those that stay."""

from __future__ import annotations

import io
import struct
from typing import Any

import numpy as np
import pytest
from lxml import etree
from PIL import Image

import vmesh
from tests.private_metadata import (
    SECRET,
    TITLE,
    entries,
    exif_block,
    private_metadata,
    xmp_packet,
)
from vmesh.formats.metadata.description import Description
from vmesh.formats.metadata.privacy import stripped
from vmesh.mesh import Metadata

WORD = SECRET.encode()


def public_exif(block: bytes) -> bytes:
    return stripped(Metadata(exif=block), "private").exif


def public_xmp(packet: bytes) -> bytes:
    return stripped(Metadata(xmp=packet), "private").xmp


def test_private_entries_of_exif_are_gone_and_the_others_are_readable() -> None:
    given, kept = exif_block(), public_exif(exif_block())
    assert WORD in given
    assert WORD not in kept
    before, after = entries(given), entries(kept)
    public = {270, 271, 272, 282, 283, 296, 305, 306, 315, 18246, 33432, 33434, 33437, 34855}
    public |= {36864, 36867, 37380, 37386, 42036}
    for tag in public:
        assert after[tag] == before[tag]
    assert set(after) - public <= {0x8769, 0xA005}
    exif = Image.Exif()
    exif.load(b"Exif\0\0" + kept)
    assert exif.get_ifd(0x8825) == {}
    assert exif.get_ifd(0xA005)[1] == "R98"


def test_other_programs_read_the_exif_that_stays() -> None:
    stream = io.BytesIO()
    exif = b"Exif\0\0" + public_exif(exif_block())
    Image.new("RGB", (4, 4)).save(stream, "JPEG", exif=exif)
    with Image.open(stream) as image:
        assert image.getexif()[270] == TITLE
        assert image.info["dpi"] == (300, 300)
    assert Description.of(Metadata(exif=exif[6:])).date[0] == "2021"


def with_thumbnail() -> bytes:
    """A block of little-endian order with a second directory, whose picture is the secret."""
    make, second = 8 + 2 + 12 + 4, 8 + 2 + 12 + 4 + 6
    first = struct.pack("<HHHII", 1, 271, 2, 6, make) + struct.pack("<I", second)
    data = second + 2 + 2 * 12 + 4
    entries = struct.pack("<HHII", 513, 4, 1, data) + struct.pack("<HHII", 514, 4, 1, len(WORD))
    return (
        b"II*\0"
        + struct.pack("<I", 8)
        + first
        + b"Maker\0"
        + struct.pack("<H", 2)
        + entries
        + (bytes(4) + WORD)
    )


def test_the_thumbnail_is_gone() -> None:
    kept = public_exif(with_thumbnail())
    assert entries(kept)[271] == "Maker"
    assert WORD not in kept


def test_a_block_of_private_entries_alone_leaves_nothing() -> None:
    exif = Image.Exif()
    exif[316] = SECRET
    assert public_exif(exif.tobytes().removeprefix(b"Exif\0\0")) == b""
    assert public_exif(b"") == b""


def test_damaged_exif_leaks_nothing() -> None:
    block = exif_block()
    random = np.random.default_rng(1)
    for length in range(0, len(block), 5):
        assert WORD not in public_exif(block[:length])
    for _ in range(600):
        damaged = bytearray(block)
        for place in random.integers(0, len(block), 4):
            damaged[place] = random.integers(0, 256)
        kept = public_exif(bytes(damaged))
        assert WORD not in kept


def test_an_entry_that_holds_the_bytes_of_a_private_one_makes_a_block_unfit() -> None:
    block = bytearray(exif_block())
    host = block.index(struct.pack(">HHI", 316, 2, len(WORD) + 1))
    title = block.index(struct.pack(">HHI", 270, 2, len(TITLE) + 1))
    block[title + 8 : title + 12] = block[host + 8 : host + 12]
    assert public_exif(bytes(block)) == b""


def test_private_properties_of_xmp_are_gone_and_the_others_stay() -> None:
    kept = public_xmp(xmp_packet())
    assert WORD not in kept
    root = etree.fromstring(kept)
    names = {etree.QName(item).localname for item in root.iter() if not len(item)}
    texts = {str(item.text) for item in root.iter() if not len(item)}
    assert texts == {TITLE, "Me", "(c) Me & you", "ships", "4", "2021-02-03", "Ships"}
    assert names == {"li", "Rating", "CreateDate", "Headline"}
    assert public_xmp(kept) == kept


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16", "utf-8-sig"])
def test_packets_of_any_encoding_and_padding_are_read(encoding: str) -> None:
    packet = xmp_packet().decode()
    assert TITLE.encode() in public_xmp(packet.encode(encoding))
    assert TITLE.encode() in public_xmp(packet.encode() + 300 * b" ")
    assert TITLE.encode() in public_xmp(packet.encode() + bytes(30))


@pytest.mark.parametrize(
    "packet",
    [
        b"",
        bytes(40),
        b"<x/>",
        WORD,
        xmp_packet()[:-60],
        xmp_packet().replace(b"<dc:title>", b"<dc:title", 1),
    ],
)
def test_xmp_without_sense_is_left_out_whole(packet: bytes) -> None:
    assert public_xmp(packet) == b""


def test_entities_of_xmp_are_not_followed() -> None:
    start = xmp_packet().index(b"<x:")
    bomb = b'<!DOCTYPE a [<!ENTITY b "%s"><!ENTITY c SYSTEM "file:///etc/passwd">]>' % WORD
    packet = bomb + xmp_packet()[start:].replace(b"<rdf:li>Me</rdf:li>", b"<rdf:li>&b;&c;</rdf:li>")
    kept = public_xmp(packet)
    assert WORD not in kept
    assert b"root:" not in kept


def test_all_is_all_but_the_profile() -> None:
    metadata = private_metadata(icc=b"profile")
    assert stripped(metadata, "all") == Metadata(icc=b"profile")
    assert stripped(metadata, "none") is metadata
    private = stripped(metadata, "private")
    assert (private.icc, private.unknown) == (b"profile", ())


def test_previews_in_notebooks_hold_no_metadata() -> None:
    square, triangles = [(0, 0), (9, 0), (9, 9), (0, 9)], [(0, 1, 2), (0, 2, 3)]
    mesh = vmesh.Mesh.from_colors(
        9, 9, square, triangles, np.zeros((4, 3)), metadata=private_metadata()
    )
    shown: Any = mesh._repr_png_()
    with Image.open(io.BytesIO(shown)) as image:
        assert not image.getexif()
    assert SECRET not in (mesh._repr_svg_() or "")
