"""Pictures of JPEG 2000 with more than 8 bits a sample, whose white Pillow turns to black.

References
----------
ITU-T T.800 | ISO/IEC 15444-1, JPEG 2000 image coding system: Core coding system, 2019, section
A.5.1.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from vmesh.arrays import SampleArray
from vmesh.errors import ImageError
from vmesh.formats.picture.samples import as_rgba, from_numbers, from_unsigned

_STARTS: Final = (b"\0\0\0\x0cjP  \r\n\x87\n", b"\xff\x4f\xff\x51")
_SIZ: Final = b"\xff\x4f\xff\x51"  # the start of the codestream, with its sizes
_N_COMPONENTS: Final = 40  # places after it
_DEPTH: Final = 42
_SIGNED: Final = 128
_HEADERS: Final = 1 << 20  # bytes before the codestream, as of a profile


def depth_of_jpeg2000(data: bytes) -> int:
    """Bits of a sample; 0 of other files."""
    at = data.find(_SIZ, 0, _HEADERS) if data.startswith(_STARTS) else -1
    return (data[at + _DEPTH] & (_SIGNED - 1)) + 1 if 0 <= at < len(data) - _DEPTH else 0


def read_jpeg2000(data: bytes) -> tuple[SampleArray, tuple[str, ...]]:
    """Samples of more than 8 bits, with notes about what became of them.

    Returns
    -------
    samples : ndarray
        uint16, shape (h, w), (h, w, 3) or (h, w, 4).
    notes : tuple of str

    Raises
    ------
    ImageError
        If there are samples of more than 16 bits, or other than of grey and RGB.
    """
    import imagecodecs

    at, n_bits = data.find(_SIZ), depth_of_jpeg2000(data)
    n_components = int.from_bytes(data[at + _N_COMPONENTS :][:2], "big")
    if n_bits > 16 or not 1 <= n_components <= 4:
        raise ImageError(
            f"unsupported: JPEG 2000 of {n_components} components with {n_bits} bits a sample"
        )
    values = np.asarray(imagecodecs.jpeg2k_decode(data))
    notes: tuple[str, ...] = ()
    if values.dtype.kind == "u":
        samples = from_unsigned(values, n_bits)
    else:
        samples, notes = from_numbers(values)
    if samples.ndim == 3 and samples.shape[2] == 2:
        samples = as_rgba(samples)
    return samples, notes
