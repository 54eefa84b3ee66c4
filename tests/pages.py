"""Meshes in pages."""

from __future__ import annotations

import base64
import re

from vmesh.codec.layout import is_vmesh
from vmesh.codec.reader import loads
from vmesh.mesh import Mesh


def embedded_meshes(page: str) -> list[Mesh]:
    """The meshes that a page holds in base64."""
    texts = re.findall(r"[\w+/]{60,}={0,2}", page)
    blocks = (base64.b64decode(text + "=" * (-len(text) % 4)) for text in texts)
    return [loads(data) for data in blocks if is_vmesh(data)]
