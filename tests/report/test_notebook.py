"""What a notebook shows of a study, as IPython asks for it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from lxml import html

import vmesh
from tests.pictures import PICTURES
from vmesh.report.page import page_of, section_of

formatters: Any = pytest.importorskip("IPython.core.formatters", reason="IPython is not installed")


def test_a_study_is_shown_as_its_page_in_a_frame() -> None:
    found = vmesh.study(PICTURES["disc"], name="a <disc>", effort=1, vertices=40)
    bundle: dict[str, str] = formatters.DisplayFormatter().format(found)[0]
    assert len(bundle["text/plain"]) < 2000
    frame = html.fragment_fromstring(bundle["text/html"])
    assert frame.tag == "iframe"
    assert frame.get("srcdoc") == page_of([section_of(found, 0)]).decode()
    assert "a &lt;disc&gt;" in frame.get("srcdoc")


def test_a_study_takes_what_the_encoder_takes() -> None:
    mesh = vmesh.study(PICTURES["disc"], effort=1, vertices=40).mesh
    assert mesh == vmesh.encode(PICTURES["disc"], effort=1, vertices=40)
    with pytest.raises(ValueError, match="shape"):
        vmesh.study(np.zeros((4, 4, 2), np.uint8))
    with pytest.raises(TypeError, match="colour"):
        vmesh.study(PICTURES["disc"], colour=1)  # type: ignore[call-arg]
