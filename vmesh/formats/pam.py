"""Pixels -> PAM: a line or two of text and the samples, for programs that want nothing else."""

from __future__ import annotations

from typing import BinaryIO, Final

import numpy as np

from vmesh.arrays import UInt8Array
from vmesh.mesh import Metadata

_TUPLE_TYPES: Final = {1: "GRAYSCALE", 3: "RGB", 4: "RGB_ALPHA"}


def write_pam(
    raster: UInt8Array,
    stream: BinaryIO,
    format_name: str = "PAM",
    *,
    metadata: Metadata | None = None,
) -> None:
    """Write a PAM file, the format of Netpbm for any number of components.

    Parameters
    ----------
    raster : ndarray
        uint8, shape (h, w), (h, w, 3) or (h, w, 4); alpha is not premultiplied.
    stream : binary file
    format_name, metadata
        As for `write_raster`; there is no place for metadata.
    """
    pixels = np.atleast_3d(raster)
    height, width, depth = pixels.shape
    header = (
        f"P7\nWIDTH {width}\nHEIGHT {height}\nDEPTH {depth}\nMAXVAL 255\n"
        f"TUPLTYPE {_TUPLE_TYPES[depth]}\nENDHDR\n"
    )
    stream.write(header.encode("ascii"))
    stream.write(pixels.tobytes())
