"""Windows of real browsers, Chromium and Firefox, and a site of their own for them to open."""

from __future__ import annotations

import io
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any, Final, Protocol

import numpy as np
from PIL import Image

from tests.formats.browser import playwright, running
from tests.web.firefox import running_firefox
from vmesh.arrays import UInt8Array

BROWSERS: Final = ("chromium", "firefox")
_SECONDS: Final = 60.0
_KINDS: Final = {
    "css": "text/css",
    "html": "text/html",
    "js": "text/javascript",
    "svg": "image/svg+xml",
    "vmesh": "image/vnd.vmesh",
}
# What happens in a page: of its elements in `events`, and what nobody wants in `messages`.
_NOTES: Final = """
window.events = [];
window.messages = [];
for (const type of ["load", "error"]) document.addEventListener(type, (event) => {
  if (event.target.localName === "vmesh-image") events.push(type);
}, true);
addEventListener("error", (event) => messages.push(event.message));
addEventListener("unhandledrejection", (event) => messages.push(String(event.reason)));
document.addEventListener("securitypolicyviolation", (event) => {
  messages.push(`${event.violatedDirective} ${event.sourceFile}`);
});
window.shift = 0;
if (PerformanceObserver.supportedEntryTypes.includes("layout-shift")) {
  const observer = new PerformanceObserver((list) => {
    for (const entry of list.getEntries()) shift += entry.value;
  });
  observer.observe({ type: "layout-shift", buffered: true });
}
"""


class Window(Protocol):
    """A window of a browser."""

    name: str

    def open(self, address: str) -> None:
        """Open a page, and wait until it is loaded."""

    def evaluate(self, expression: str) -> Any:
        """The value of an expression in the page; a promise is waited for."""

    def resize(self, width: int, height: int) -> None:
        """Give the page so many pixels."""

    def screenshot(self, selector: str) -> bytes:
        """PNG of an element."""

    def role_and_name(self, selector: str) -> tuple[str, str]:
        """What a screen reader is told of an element."""


class Chromium:
    """A window of Chromium; see `Window`."""

    name = "chromium"

    def __init__(self, page: playwright.Page) -> None:
        self._page = page

    def open(self, address: str) -> None:
        self._page.goto(address)

    def evaluate(self, expression: str) -> Any:
        return self._page.evaluate(expression)

    def resize(self, width: int, height: int) -> None:
        self._page.set_viewport_size({"width": width, "height": height})

    def screenshot(self, selector: str) -> bytes:
        return self._page.locator(selector).screenshot()

    def role_and_name(self, selector: str) -> tuple[str, str]:
        # Playwright knows no roles but those in attributes: the browser itself is asked.
        session = self._page.context.new_cdp_session(self._page)
        root = session.send("DOM.getDocument")["root"]["nodeId"]
        node = session.send("DOM.querySelector", {"nodeId": root, "selector": selector})
        asked = {"nodeId": node["nodeId"], "fetchRelatives": False}
        found = session.send("Accessibility.getPartialAXTree", asked)["nodes"][0]
        session.detach()
        return found["role"]["value"], found.get("name", {}).get("value", "")


@contextmanager
def window_of(name: str) -> Iterator[Window]:
    """A window of a browser by its name, or a skipped test where there is none."""
    if name == "firefox":
        with running_firefox() as firefox:
            yield firefox
    else:
        with running() as browser:
            yield Chromium(browser.new_page())


def wait_until(window: Window, expression: str) -> None:
    """Wait until an expression is true in the page."""
    end = time.monotonic() + _SECONDS
    while not window.evaluate(expression):
        assert time.monotonic() < end, f"never true: {expression}"
        time.sleep(0.02)


def settle(window: Window) -> None:
    """Wait until what was asked for is drawn."""
    window.evaluate(
        "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))"
    )


def pixels_of(window: Window, selector: str = "vmesh-image") -> UInt8Array:
    """An element on the screen, shape (h, w, 3), uint8."""
    settle(window)
    with Image.open(io.BytesIO(window.screenshot(selector))) as image:
        return np.asarray(image.convert("RGB"))


class Site:
    """Files that a browser may ask for, and what it has asked for."""

    def __init__(self, window: Window) -> None:
        self.window = window
        self.files: dict[str, bytes] = {"notes.js": _NOTES.encode()}
        self.asked: list[str] = []
        self.policy = ""
        """Content security policy of the pages."""
        self._held: dict[str, threading.Event] = {}
        self._server = ThreadingHTTPServer(("127.0.0.1", 0), _handler(self))
        self._thread = threading.Thread(target=self._server.serve_forever, args=(0.02,))
        self._thread.start()

    @property
    def address(self) -> str:
        return f"http://127.0.0.1:{self._server.server_address[1]}/"

    def close(self) -> None:
        for name in list(self._held):
            self.release(name)
        self._server.shutdown()
        self._thread.join()
        self._server.server_close()

    def hold(self, name: str) -> None:
        """Answer for a file only when it is released."""
        self._held[name] = threading.Event()

    def release(self, name: str) -> None:
        self._held.pop(name).set()

    def answer(self, name: str) -> bytes | None:
        self.asked.append(name)
        if name in self._held:
            self._held[name].wait(_SECONDS)
        return self.files.get(name)

    def open(self, body: str, *, head: str = '<script src="vmesh-image.js"></script>') -> None:
        """Open a page without margins."""
        self.files["margins.css"] = b"body { margin: 0; }"
        self.files["page.html"] = (
            '<!doctype html><meta charset="utf-8"><title>Page</title>'
            '<link rel="stylesheet" href="margins.css"><script src="notes.js"></script>'
            f"{head}<body>{body}"
        ).encode()
        self.window.open(f"{self.address}page.html")

    def wait_for(self, n_events: int) -> list[str]:
        """Events of the elements, once there are so many."""
        wait_until(self.window, f"events.length >= {n_events}")
        events: list[str] = self.window.evaluate("events")
        return events

    @property
    def messages(self) -> list[str]:
        """Errors of scripts, and breaches of the policy."""
        found: list[str] = self.window.evaluate("messages")
        return found


def _handler(site: Site) -> type[BaseHTTPRequestHandler]:
    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            name = self.path.partition("?")[0].rsplit("/", 1)[1]
            body = site.answer(name)
            self.send_response(404 if body is None else 200)
            kind = _KINDS.get(name.rpartition(".")[2], "application/octet-stream")
            self.send_header("Content-Type", kind)
            self.send_header("Cache-Control", "no-store")
            self.send_header("Content-Length", str(len(body or b"")))
            if site.policy:
                self.send_header("Content-Security-Policy", site.policy)
            self.end_headers()
            self.wfile.write(body or b"")

        def log_message(self, format: str, *args: object) -> None:
            """Keep silent."""

    return Handler
