from __future__ import annotations

import pytest

from tests.cli.program import Program


@pytest.fixture
def program(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> Program:
    """The program, run in the process of the tests."""
    return Program(monkeypatch, capfd)
