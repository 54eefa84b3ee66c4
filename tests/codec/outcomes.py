"""What becomes of damaged files, in a process of its own: ``python -m tests.codec.outcomes N``."""

from __future__ import annotations

import hashlib
import json
import sys
from collections.abc import Iterable, Iterator

import numpy as np

from tests.codec.mutants import mutants
from tests.codec.trial import Outcome, try_file
from vmesh.arrays import UInt8Array
from vmesh.kernels.jit import kernel


@kernel
def element(values: UInt8Array, at: int) -> int:
    """One element, wherever it lies."""
    number: int = values[at]
    return number


def checks_bounds() -> bool:
    """Whether a read beyond the end of an array, planted here, is noticed in a kernel."""
    try:
        element(np.zeros(3, dtype=np.uint8), 3)
    except IndexError:
        return True
    return False


def outcomes(runs: int) -> Iterator[Outcome]:
    """Outcomes of damaged files: the first ones of any number are the same."""
    for data, is_partial in mutants(runs, seed=0):
        yield try_file(data, allow_partial=is_partial)


def digest(tried: Iterable[Outcome]) -> str:
    """A digest of outcomes."""
    return hashlib.sha256("".join(f"{outcome}\n" for outcome in tried).encode()).hexdigest()


def main() -> None:
    """Print whether bounds are checked, and the digest."""
    print(json.dumps([checks_bounds(), digest(outcomes(int(sys.argv[1])))]))


if __name__ == "__main__":
    main()
