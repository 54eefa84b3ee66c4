"""Packages and machines that figures depend on."""

from __future__ import annotations

import os
import platform
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from typing import Any, Final

_PACKAGES: Final = ("numpy", "numba", "scipy")


def describe_machine() -> str:
    """A sentence on the machine and its software."""
    cores = os.cpu_count() or 1
    software = [f"Python {platform.python_version()}"]
    software += [f"{name} {version_of(name)}" for name in _PACKAGES]
    return f"{platform.machine()}, {cores} core{'s' * (cores != 1)}; {', '.join(software)}."


def import_optional(name: str) -> Any:
    """A module, None if it is not installed."""
    try:
        return import_module(name)
    except ImportError:
        return None


def version_of(package: str) -> str:
    """Version of a package, "not installed" if it is missing."""
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"


def describe_packages(*names: str) -> str:
    """A sentence on the versions of packages that may be missing."""
    return f"Optional packages: {', '.join(f'{name} {version_of(name)}' for name in names)}."
