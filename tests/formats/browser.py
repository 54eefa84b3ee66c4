"""A real browser for the tests of pages: headless Chromium, which draws WebGL in software."""

from __future__ import annotations

import io
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import pytest
from PIL import Image

from vmesh.arrays import UInt8Array

pytest.importorskip(
    "playwright.sync_api", reason="playwright is not installed: pages are not tried in a browser"
)

from playwright import sync_api as playwright

__all__ = ["NO_WEBGL", "pixels_of", "playwright", "running", "settle", "wait_until"]

# A script that a page runs first.
NO_WEBGL = """
const getContext = HTMLCanvasElement.prototype.getContext;
HTMLCanvasElement.prototype.getContext = function (kind, options) {
  return kind === "webgl2" ? null : getContext.call(this, kind, options);
};
"""
_NAMES = ("chromium", "chromium-browser", "google-chrome")
_ARGUMENTS = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"]


@contextmanager
def running() -> Iterator[playwright.Browser]:
    """A browser of the system, or a skipped test where there is none that starts."""
    program = next(filter(None, map(shutil.which, _NAMES)), None)
    if program is None:
        pytest.skip(f"none of {', '.join(_NAMES)} is installed")
    # Chromium does not start as root within its sandbox.
    sandbox = hasattr(os, "geteuid") and os.geteuid() != 0
    with playwright.sync_playwright() as driver:
        try:
            browser = driver.chromium.launch(
                executable_path=program, args=_ARGUMENTS, chromium_sandbox=sandbox
            )
        except playwright.Error as error:
            pytest.skip(f"{program} does not start: {error.message.splitlines()[0]}")
        yield browser
        browser.close()


def settle(page: playwright.Page) -> None:
    """Wait until what was asked for is drawn."""
    page.evaluate(
        "() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))"
    )


def wait_until(page: playwright.Page, expression: str) -> None:
    """Wait until an expression is true in the page.

    Asked from here: the page's own policy forbids it to evaluate a string again and again.
    """
    for _ in range(600):
        if page.evaluate(expression):
            return
        page.wait_for_timeout(50)
    raise AssertionError(f"never true: {expression}")


def pixels_of(target: playwright.Page | playwright.Locator) -> UInt8Array:
    """What is on the screen, shape (h, w, 3), uint8."""
    settle(target if isinstance(target, playwright.Page) else target.page)
    with Image.open(io.BytesIO(target.screenshot())) as image:
        return np.asarray(image.convert("RGB"))
