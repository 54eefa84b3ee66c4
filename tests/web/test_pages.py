"""What is in the pages for browsers."""

from __future__ import annotations

import re

import pytest

import vmesh
from tests.pictures import PICTURES
from vmesh.formats.html.document import name_of, page_of
from vmesh.mesh import Metadata

XMP = b"""<x:xmpmeta xmlns:x="adobe:ns:meta/"><rdf:RDF
xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#"><rdf:Description
xmlns:dc="http://purl.org/dc/elements/1.1/"><dc:title><rdf:Alt><rdf:li xml:lang="x-default">
A "cup" of &lt;coffee&gt;</rdf:li></rdf:Alt></dc:title></rdf:Description></rdf:RDF></x:xmpmeta>"""


@pytest.fixture(scope="module")
def mesh() -> vmesh.Mesh:
    return vmesh.encode(PICTURES["ramp"], vertices=9)


def test_the_title_in_the_metadata_names_the_picture(mesh: vmesh.Mesh) -> None:
    titled = mesh.replaced(metadata=Metadata(xmp=XMP))
    assert name_of(titled) == 'A "cup" of <coffee>'


@pytest.mark.parametrize("xmp", [b"", b"<", b"<x/>", b"\0", XMP.replace(b"title", b"rights")])
def test_a_picture_without_a_title_is_named_by_its_size(mesh: vmesh.Mesh, xmp: bytes) -> None:
    untitled = mesh.replaced(metadata=Metadata(xmp=xmp))
    assert name_of(untitled) == "Picture of 32 × 24 pixels"


def test_a_page_refers_to_nothing_outside(mesh: vmesh.Mesh) -> None:
    text = page_of(vmesh.dumps(mesh), "A ramp")
    assert "default-src 'none'" in text
    assert not re.search(r"https?:|<link|@import|\bsrc=", text)
