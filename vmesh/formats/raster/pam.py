"""Pixels -> PAM: a line or two of text and the samples, for programs that want nothing else."""

from __future__ import annotations

from typing import BinaryIO, Final

import numpy as np

from vmesh.arrays import SampleArray
from vmesh.mesh import Metadata

_TUPLE_TYPES: Final = {1: "GRAYSCALE", 3: "RGB", 4: "RGB_ALPHA"}


def write_pam(
    raster: SampleArray,
    stream: BinaryIO,
    format_name: str = "PAM",
    *,
    metadata: Metadata | None = None,
    depth: int = 8,
) -> None:
    """Write a PAM file, the format of Netpbm for any number of components.

    Parameters
    ----------
    raster : ndarray
        uint8 or uint16, shape (h, w), (h, w, 3) or (h, w, 4); alpha is not premultiplied.
    stream : binary file
    format_name, metadata
        As for `write_raster`; there is no place for metadata.
    depth : int
        Bits of a sample, 8 for uint8, 9 to 16 for uint16.
    """
    pixels = np.atleast_3d(raster)
    height, width, n_components = pixels.shape
    header = (
        f"P7\nWIDTH {width}\nHEIGHT {height}\nDEPTH {n_components}\n"
        f"MAXVAL {(1 << depth) - 1}\nTUPLTYPE {_TUPLE_TYPES[n_components]}\nENDHDR\n"
    )
    stream.write(header.encode("ascii"))
    stream.write(pixels.astype(">u2").tobytes() if depth > 8 else pixels.tobytes())
