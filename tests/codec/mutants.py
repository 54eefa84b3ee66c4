"""The conformance files, changed at random, with lengths and checksums repaired."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Final

import numpy as np

from tests.codec.damage import file_of, mutant, split
from tests.codec.trial import try_file

FOLDER: Final = Path(__file__).parents[2] / "spec" / "conformance"
_MAX_BYTES: Final = 1000
# A file that gets as far as its mesh can be taken apart.
_REACHED: Final = {"loaded", "positions", "geometry", "colors", "triangles", "tiles"}


def corpus() -> list[bytes]:
    """Conformance files that are small, and in order up to their mesh; the smallest first."""
    files = [path.read_bytes() for path in sorted(FOLDER.rglob("*.vmesh"))]
    small = sorted((data for data in files if len(data) <= _MAX_BYTES), key=len)
    return [data for data in small if try_file(data).code in _REACHED]


def mutants(runs: int, seed: int) -> Iterator[tuple[bytes, bool]]:
    """Damaged files, and whether each is to be read as the start of a file."""
    files = corpus()
    random = np.random.default_rng(seed)
    for _ in range(runs):
        data = files[random.integers(len(files))]
        if random.integers(16) == 0:  # the header of one file, the chunks of another
            data = file_of(split(data)[0], split(files[random.integers(len(files))])[1])
        data = mutant(data, random)
        is_partial = bool(random.integers(8) == 0)
        if is_partial:
            data = data[: random.integers(len(data) // 3, len(data) + 1)]
        yield data, is_partial
