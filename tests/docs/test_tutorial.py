"""Every sample of the tutorial is run, and its page is opened in a browser."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import vmesh
from tests.docs.samples import Runner, samples_of
from vmesh.metrics import psnr

ROOT = Path(__file__).parents[2]
TUTORIAL = (ROOT / "docs" / "tutorial.md").read_text("utf-8")
TYPES = {".html": "text/html", ".js": "text/javascript"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """The folder in which the tutorial was run, to the last sample."""
    pytest.importorskip("trimesh", reason="trimesh is not installed: the tutorial is not run")
    made = tmp_path_factory.mktemp("tutorial")
    (made / "tests").symlink_to(ROOT / "tests")
    before = Path.cwd()
    os.chdir(made)
    try:
        runner = Runner(made)
        for sample in samples_of(TUTORIAL):
            sample.check(runner.run(sample))
        yield made
    finally:
        os.chdir(before)


def test_every_sample_runs_and_prints_what_is_shown(folder: Path) -> None:
    made = {path.suffix for path in folder.iterdir() if path.is_file()}
    assert made == {
        ".vmesh", ".png", ".webp", ".svg", ".svgz", ".pdf", ".html", ".js", ".glb",
    }  # fmt: skip
    assert (folder / "coffee.vmesh").stat().st_size <= 6000
    with Image.open(folder / "poster.png") as poster:
        assert poster.size == (1800, 1200)


def test_the_page_shows_the_impression_and_then_the_file(folder: Path) -> None:
    from tests.formats.browser import pixels_of, running, wait_until

    asked = []

    def answer(route: Any) -> None:
        name = route.request.url.rsplit("/", 1)[1]
        asked.append(name)
        path = folder / name
        kind = TYPES.get(path.suffix, "application/octet-stream")
        if path.is_file():
            route.fulfill(body=path.read_bytes(), content_type=kind)
        else:
            route.fulfill(status=404)

    with running() as browser:
        page = browser.new_page(viewport={"width": 800, "height": 600})
        page.add_init_script(
            "window.loads = 0; document.addEventListener('load', (event) => {"
            " if (event.target.localName === 'vmesh-image') window.loads += 1; }, true);"
        )
        page.route("http://site.test/**", answer)
        page.goto("http://site.test/page.html")
        wait_until(page, "window.loads === 2")
        shown = pixels_of(page.locator("vmesh-image"))
    assert asked.index("page.html") < asked.index("coffee.vmesh")
    expected = np.asarray(vmesh.render(vmesh.load(folder / "coffee.vmesh")))
    assert psnr(shown, expected) > 40
