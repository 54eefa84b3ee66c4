"""Programs and libraries that draw SVG and PDF, as the tests have them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

import pytest

from tests.formats.renderers import PDF_RENDERERS, SVG_RENDERERS, Renderer

MISSING: Final = pytest.skip.Exception  # what a renderer raises that is not installed

Renderers = Mapping[str, Mapping[str, Renderer]]

_RENDERERS: Final[Renderers] = {".svg": SVG_RENDERERS, ".pdf": PDF_RENDERERS}


def renderers_by_suffix(wanted: Sequence[str] = ()) -> Renderers:
    """Renderers by the ending of the files that they draw and by name: all, or those wanted."""
    return {
        suffix: {name: draw for name, draw in table.items() if not wanted or name in wanted}
        for suffix, table in _RENDERERS.items()
    }


def renderer_names() -> tuple[str, ...]:
    """Names of all renderers."""
    return (*SVG_RENDERERS, *PDF_RENDERERS)
