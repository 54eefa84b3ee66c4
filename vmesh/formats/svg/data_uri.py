"""SVG drawings as data URIs, text that stands in the place of a file's address.

Text is shorter than base64 as a rule: of markup hardly more than its quotes and its ``#`` are
replaced. What is left has no character that ends or changes a string in HTML or CSS. Spaces and
parentheses stay, so that it has to stand in quotes, of either kind::

    <img src="data:...">          url("data:...")          style="background: url('data:...')"

References
----------
L. Masinter, RFC 2397, "The data URL scheme". WHATWG, "URL" and "Fetch": what programs accept.
"""

from __future__ import annotations

import io
from base64 import b64encode
from functools import wraps
from typing import TYPE_CHECKING, Any, BinaryIO, Final, Unpack
from urllib.parse import quote

from vmesh.formats.svg.document import write_svg
from vmesh.limits import DEFAULT_LIMITS, Limits
from vmesh.mesh import Mesh

if TYPE_CHECKING:
    from vmesh.formats.registry import ExportOptions

_KIND: Final = "data:image/svg+xml"
_PLAIN: Final = " -_.:,;=/()<>+*!?@"  # what stays, beside letters and digits


def data_uri(
    mesh: Mesh, *, limits: Limits = DEFAULT_LIMITS, **options: Unpack[ExportOptions]
) -> str:
    """Data URI of a mesh as SVG, to stand in quotes where HTML or CSS expect an address.

    Parameters
    ----------
    mesh : Mesh
    limits : Limits
        Limits on the mesh.
    **options
        As :func:`vmesh.export` takes them for SVG.

    Raises
    ------
    TypeError
        If SVG has no such option.
    ValueError
        If an option is none that SVG knows.
    LimitError
        If the mesh is more than `limits` allow.
    """
    from vmesh.formats.registry import DATA_URI, write_mesh

    stream = io.BytesIO()
    write_mesh(mesh, stream, DATA_URI, limits=limits, **options)
    return stream.getvalue().decode("ascii")


@wraps(write_svg)  # it has the same options
def write_data_uri(mesh: Mesh, stream: BinaryIO, **options: Any) -> None:
    """Write a mesh as the data URI of an SVG document."""
    document = io.BytesIO()
    write_svg(mesh, document, **options)
    # Lines end between elements only.
    text = document.getvalue().replace(b"\n", b"")
    choices = (f",{quote(text, safe=_PLAIN)}", f";base64,{b64encode(text).decode('ascii')}")
    stream.write((_KIND + min(choices, key=len)).encode("ascii"))
