from __future__ import annotations

from pathlib import Path

import pytest
from PIL import Image

from vmesh.arrays import UInt8Array


@pytest.fixture(scope="session")
def folder(
    tmp_path_factory: pytest.TempPathFactory, chelsea: UInt8Array, coffee: UInt8Array
) -> str:
    """A folder of two tiny photographs."""
    path: Path = tmp_path_factory.mktemp("photographs")
    Image.fromarray(chelsea[60:108, 100:172]).save(path / "chelsea.png")
    Image.fromarray(coffee[100:172, 200:248]).save(path / "coffee.png")
    return str(path)
