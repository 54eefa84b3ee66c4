"""Progress: the reports of work that takes long."""

from __future__ import annotations

from collections.abc import Callable

Progress = Callable[[str], None]
"""Called with the name of each stage as it begins, and again as it goes on."""


def silent(_: str) -> None:
    """Say nothing."""
