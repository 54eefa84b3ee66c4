"""The photographs, and the Hypothesis profile of the suite."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import settings
from PIL import Image

from vmesh.arrays import UInt8Array

pytest_plugins = ["tests.known_skips"]

# The same examples in every run, and no deadline: the first example may compile a kernel.
settings.register_profile("vmesh", deadline=None, derandomize=True)
settings.load_profile("vmesh")

_IMAGES = Path(__file__).parent / "images"


def _photograph(name: str) -> UInt8Array:
    """A photograph of tests/images, shape (h, w, 3), uint8, read-only."""
    with Image.open(_IMAGES / name) as image:
        pixels = np.array(image.convert("RGB"))
    pixels.flags.writeable = False
    return pixels


@pytest.fixture(scope="session")
def coffee() -> UInt8Array:
    return _photograph("coffee.png")


@pytest.fixture(scope="session")
def chelsea() -> UInt8Array:
    return _photograph("chelsea.png")
