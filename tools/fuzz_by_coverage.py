"""The process that ``tools.fuzz --atheris`` starts: it changes files that reached new code further.

The kernels have to be plain Python for their lines to be seen: NUMBA_DISABLE_JIT=1.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import atheris
import numpy as np

with atheris.instrument_imports(include=["vmesh"]):
    from tests.codec.damage import mutant
    from tests.codec.mutants import corpus
    from tests.codec.trial import try_file


def try_bytes(data: bytes) -> None:
    """Read some bytes; what is raised ends the fuzzer, which keeps the file."""
    try_file(data)


def change(data: bytes, max_size: int, seed: int) -> bytes:
    """A change that repairs lengths and checksums, or any where the bytes are no file."""
    try:
        changed = mutant(data, np.random.default_rng(seed))
    except IndexError:
        changed = bytes(atheris.Mutate(data, max_size))
    return changed[:max_size]


def main() -> None:
    """Fuzz from the conformance files on, with the options of libFuzzer."""
    with tempfile.TemporaryDirectory() as folder:
        for number, data in enumerate(corpus()):
            (Path(folder) / str(number)).write_bytes(data)
        atheris.Setup([*sys.argv, folder], try_bytes, custom_mutator=change)
        atheris.Fuzz()


if __name__ == "__main__":
    main()
