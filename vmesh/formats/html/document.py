"""Mesh -> a page that shows it: the decoder, a viewer and the ``.vmesh`` file in one HTML file.

The page loads nothing, and says so to the browser (its content security policy), so that it works
from a disk, in an archive and without a network.
"""

from __future__ import annotations

import base64
from html import escape
from string import Template
from typing import BinaryIO, Final

from vmesh.codec.writer import dumps
from vmesh.formats.color.conversion import mesh_in_srgb
from vmesh.formats.metadata.description import Description
from vmesh.formats.metadata.xmp import parse_packet
from vmesh.limits import DEFAULT_LIMITS, Limits
from vmesh.mesh import Mesh, Metadata
from vmesh.web import WEB, built_script

VIEWER: Final = WEB / "viewer"

_DC: Final = "{http://purl.org/dc/elements/1.1/}"
_ITEM: Final = "{http://www.w3.org/1999/02/22-rdf-syntax-ns#}li"


def write_html(mesh: Mesh, stream: BinaryIO, *, limits: Limits = DEFAULT_LIMITS) -> None:
    """Write a mesh as a page for browsers that needs no other file to show it.

    Parameters
    ----------
    mesh : Mesh
        A mesh that a file may hold; its metadata are in the page as they are in the file, but for
        the ICC profile: colours are converted to sRGB, on half the steps.
    stream : binary file
    limits : Limits
        What the mesh may ask for.

    Raises
    ------
    ValueError
        As :func:`vmesh.dumps`.
    """
    limits.check_vertices(mesh.n_vertices)
    shown = mesh_in_srgb(mesh, refinement=2)
    stream.write(page_of(dumps(shown), name_of(mesh)).encode())


def page_of(data: bytes, name: str) -> str:
    """The page that shows the bytes of a ``.vmesh`` file, or says what is wrong with them."""
    return fill_page("page", name=escape(name), data=base64.b64encode(data).decode())


def fill_page(page: str, **texts: str) -> str:
    """A page of the viewer with its style, its script and some texts, which are markup."""
    return Template((VIEWER / f"{page}.html").read_text("utf-8")).substitute(
        texts,
        style=(VIEWER / f"{page}.css").read_text("utf-8"),
        script=built_script(page),
    )


def element_script() -> str:
    """The script of the element ``<vmesh-image>``, one file without dependencies."""
    return built_script("vmesh-image")


def name_of(mesh: Mesh) -> str:
    """Name of a picture for readers who do not see it: its title, or its size."""
    return (
        _xmp_title(mesh.metadata)
        or Description.of(mesh.metadata).title
        or f"Picture of {mesh.width} × {mesh.height} pixels"
    )


def _xmp_title(metadata: Metadata) -> str:
    """Title or description in the XMP packet, empty if there is none or it makes no sense."""
    root = parse_packet(metadata.xmp)
    if root is None:
        return ""
    for kind in ("title", "description"):
        for item in root.iterfind(f".//{_DC}{kind}//{_ITEM}"):
            if title := " ".join((item.text or "").split()):
                return title
    return ""
