"""Several drawings in one HTML page, as a browser shows them."""

from __future__ import annotations

import io
from collections.abc import Iterator
from itertools import pairwise

import numpy as np
import pytest
from PIL import Image

import vmesh
from tests.formats.browser import pixels_of, playwright, running
from vmesh.arrays import UInt8Array
from vmesh.formats.preview import svg_preview
from vmesh.formats.svg.document import write_svg


@pytest.fixture(scope="module")
def page() -> Iterator[playwright.Page]:
    with running() as browser:
        yield browser.new_page(viewport={"width": 400, "height": 500})


@pytest.fixture(scope="module")
def meshes(coffee: UInt8Array) -> list[vmesh.Mesh]:
    """Two parts of a photograph, and one of them fading out."""
    parts = [coffee[y : y + 60, 200:290] for y in (100, 250)]
    fade = np.broadcast_to(np.linspace(0, 255, 90).astype(np.uint8), (60, 90))
    parts.append(np.dstack([parts[0], fade]))
    parts.append(np.dstack([parts[0], fade[:, ::-1]]))
    return [vmesh.encode(np.ascontiguousarray(part), vertices=60) for part in parts]


def shown(page: playwright.Page, drawings: list[str]) -> list[UInt8Array]:
    """What a page shows of drawings, each in its own box at a place of its own."""
    boxes = "".join(f"<div style='height:70px'>{drawing}</div>" for drawing in drawings)
    page.set_content(f"<!doctype html><body style='background:#3a7'>{boxes}")
    return [pixels_of(box) for box in page.locator("svg").all()]


def shown_alone(page: playwright.Page, drawings: list[str]) -> list[UInt8Array]:
    """What a page shows of each drawing that has it alone, at the same place."""
    n = len(drawings)
    return [
        shown(page, ["" if i != alone else drawings[i] for i in range(n)])[0] for alone in range(n)
    ]


def distance(one: UInt8Array, other: UInt8Array) -> float:
    """Mean difference in levels: Chromium dithers gradients, not always alike."""
    return float(np.abs(one.astype(int) - other).mean())


def drawn(mesh: vmesh.Mesh, **options: object) -> str:
    stream = io.BytesIO()
    write_svg(mesh, stream, **options)  # type: ignore[arg-type]
    return stream.getvalue().decode()


@pytest.mark.parametrize("options", [{}, {"mode": "exact"}, {"mode": "auto"}])
def test_drawings_in_one_page_look_as_they_do_alone(
    page: playwright.Page, meshes: list[vmesh.Mesh], options: dict[str, object]
) -> None:
    drawings = [drawn(mesh, **options) for mesh in meshes]
    alone = shown_alone(page, drawings)
    for first, second in pairwise(alone):
        assert distance(first, second) > 5
    for one, other in zip(shown(page, drawings), alone, strict=True):
        assert distance(one, other) < 1


def test_previews_in_one_notebook_look_as_they_do_alone(
    page: playwright.Page, meshes: list[vmesh.Mesh]
) -> None:
    previews = [svg_preview(mesh) or "" for mesh in (*meshes, meshes[0])]
    alone = shown_alone(page, previews)
    for one, other in zip(shown(page, previews), alone, strict=True):
        assert distance(one, other) < 1


def test_a_data_uri_is_shown_in_quotes_of_either_kind(
    page: playwright.Page, meshes: list[vmesh.Mesh]
) -> None:
    exif = Image.Exif()
    exif[270] = """it's "100 %" <b>&amp; \\ #1 \u00e9</b> ${x} `y`"""
    metadata = vmesh.Metadata(exif=exif.tobytes().removeprefix(b"Exif\0\0"))
    uri = vmesh.data_uri(meshes[2].replaced(metadata=metadata), strip="none")
    assert uri.startswith("data:image/svg+xml,")
    assert len(uri) < 4 / 3 * len(drawn(meshes[2].replaced(metadata=metadata)))
    box = "display:block;width:90px;height:60px;margin-bottom:10px"
    ways = (
        f'<img style="{box}" src="{uri}">',
        f"<img style='{box}' src='{uri}'>",
        f"""<i style="{box};background:url('{uri}')"></i>""",
        f"""<i style='{box};background:url("{uri}")'></i>""",
    )
    body = "".join(f"<div style='height:70px'>{way}</div>" for way in ways)
    page.set_content(f"<!doctype html><body style='margin:0;background:#3a7'>{body}")
    pictures = [pixels_of(each) for each in page.locator("img, i").all()]
    assert len(pictures) == 4
    assert np.ptp(pictures[0].reshape(-1, 3), axis=0).min() > 50
    for picture in pictures:
        assert distance(picture, pictures[0]) < 1
