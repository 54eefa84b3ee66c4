"""A headless Firefox of the system, driven by Marionette, which every Firefox speaks.

Playwright drives Chromium only as it comes from a distribution: of Firefox it wants commands that
the extended support release lacks. geckodriver is in no package of Debian, and Mozilla's own client
in Python brings fifteen packages. The protocol is JSON with a length before it:
https://firefox-source-docs.mozilla.org/testing/marionette/Protocol.html
"""

from __future__ import annotations

import base64
import json
import os
import shutil
import socket
import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

import pytest

_NAMES: Final = ("firefox-esr", "firefox")
_PREFERENCES: Final = {
    "marionette.port": 0,  # any that is free
    "layout.css.devPixelsPerPx": "1.0",
    "browser.shell.checkDefaultBrowser": False,
    "browser.startup.page": 0,
    "app.update.enabled": False,
    "datareporting.policy.dataSubmissionEnabled": False,
    "toolkit.telemetry.server": "data:,",
    "network.captive-portal-service.enabled": False,
    "network.connectivity-service.enabled": False,
    "services.settings.server": "data:,",
}
_SECONDS: Final = 90.0  # to start or to answer
_ELEMENT: Final = "element-6066-11e4-a52e-4f735466cecf"  # WebDriver, section 12.1


class Firefox:
    """A window of Firefox; see `Window`."""

    name = "firefox"

    def __init__(self, port: int) -> None:
        self._socket = socket.create_connection(("127.0.0.1", port), timeout=_SECONDS)
        self._stream = self._socket.makefile("rb")
        self._n_sent = 0
        self._receive()  # a greeting
        self._send("WebDriver:NewSession")

    def close(self) -> None:
        """End the browser."""
        self._send("Marionette:Quit", flags=["eForceQuit"])
        self._stream.close()
        self._socket.close()

    def open(self, address: str) -> None:
        self._send("WebDriver:Navigate", url=address)

    def evaluate(self, expression: str) -> Any:
        return self._send("WebDriver:ExecuteScript", script=f"return ({expression})", args=[])

    def resize(self, width: int, height: int) -> None:
        # The window has a frame of its own.
        for _ in range(2):
            inner = self.evaluate("[innerWidth, innerHeight]")
            outer = self._send("WebDriver:GetWindowRect", whole=True)
            across, down = outer["width"] - inner[0], outer["height"] - inner[1]
            self._send("WebDriver:SetWindowRect", width=width + across, height=height + down)

    def screenshot(self, selector: str) -> bytes:
        taken = self._send("WebDriver:TakeScreenshot", id=self._find(selector), full=False)
        return base64.b64decode(taken)

    def role_and_name(self, selector: str) -> tuple[str, str]:
        found = self._find(selector)
        role = self._send("WebDriver:GetComputedRole", id=found)
        return role, self._send("WebDriver:GetComputedLabel", id=found)

    def _find(self, selector: str) -> str:
        found = self._send("WebDriver:FindElement", using="css selector", value=selector)
        reference: str = found[_ELEMENT]
        return reference

    def _send(self, command: str, *, whole: bool = False, **parameters: Any) -> Any:
        """The value that a command returns, or its whole answer."""
        self._n_sent += 1
        packet = json.dumps([0, self._n_sent, command, parameters])
        self._socket.sendall(f"{len(packet)}:{packet}".encode("ascii"))
        _, _, error, answer = self._receive()
        if error:
            raise AssertionError(f"{command}: {error['message']}")
        return answer if whole else answer.get("value")

    def _receive(self) -> Any:
        length = b""
        while (digit := self._stream.read(1)) != b":":
            if not digit:
                raise AssertionError("Firefox has ended")
            length += digit
        return json.loads(self._stream.read(int(length)))


@contextmanager
def running_firefox() -> Iterator[Firefox]:
    """A Firefox of the system, or a skipped test where there is none."""
    program = next(filter(None, map(shutil.which, _NAMES)), None)
    if program is None:
        pytest.skip(f"none of {', '.join(_NAMES)} is installed")
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        profile = Path(folder)
        lines = [
            f"user_pref({json.dumps(name)}, {json.dumps(value)});"
            for name, value in _PREFERENCES.items()
        ]
        (profile / "user.js").write_text("\n".join(lines), "utf-8")
        command = [program, "--headless", "--marionette", "--no-remote", "--profile", folder]
        environment = {**os.environ, "MOZ_HEADLESS_WIDTH": "800", "MOZ_HEADLESS_HEIGHT": "700"}
        with subprocess.Popen(
            command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        ) as process:
            try:
                window = Firefox(_port_of(profile, process))
                yield window
                window.close()
                process.wait(_SECONDS)
            finally:
                process.kill()


def _port_of(profile: Path, process: subprocess.Popen[bytes]) -> int:
    """The port that Firefox has chosen, once it listens."""
    path = profile / "MarionetteActivePort"
    end = time.monotonic() + _SECONDS
    while time.monotonic() < end and process.poll() is None:
        if path.is_file() and (text := path.read_text("ascii")):
            return int(text)
        time.sleep(0.05)
    raise AssertionError("Firefox does not start")
