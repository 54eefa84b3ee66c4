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
from typing import Any, BinaryIO, Final
from urllib.parse import quote

from vmesh.formats.svg.document import write_svg
from vmesh.mesh import Mesh

_KIND: Final = "data:image/svg+xml"
_PLAIN: Final = " -_.:,;=/()<>+*!?@"  # what stays, beside letters and digits


@wraps(write_svg)  # it has the same options
def write_data_uri(mesh: Mesh, stream: BinaryIO, **options: Any) -> None:
    """Write a mesh as the data URI of an SVG document."""
    document = io.BytesIO()
    write_svg(mesh, document, **options)
    # Lines end between elements only.
    text = document.getvalue().replace(b"\n", b"")
    choices = (f",{quote(text, safe=_PLAIN)}", f";base64,{b64encode(text).decode('ascii')}")
    stream.write((_KIND + min(choices, key=len)).encode("ascii"))
