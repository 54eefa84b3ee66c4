"""PAM files: a header and the samples."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import vmesh
from tests.pictures import disc, grey_ramp, noise
from vmesh.arrays import UInt8Array

PICTURES = {
    "GRAYSCALE": grey_ramp(7, 9),
    "RGB": noise(7, 9),
    "RGB_ALPHA": disc(12, 10, hidden=(255, 0, 0), visible=(0, 90, 200)),
}


@pytest.mark.parametrize("tuple_type", PICTURES)
def test_a_pam_file_holds_the_pixels(tuple_type: str, tmp_path: Path) -> None:
    picture: UInt8Array = PICTURES[tuple_type]
    mesh = vmesh.encode(picture, vertices=20)
    path = tmp_path / "picture.pam"
    vmesh.export(mesh, path, scale=2)
    pixels = vmesh.render(mesh, scale=2)
    header, samples = path.read_bytes().split(b"ENDHDR\n", 1)
    fields = dict(line.split(b" ", 1) for line in header.splitlines()[1:])
    assert header.startswith(b"P7\n")
    assert fields == {
        b"WIDTH": str(pixels.shape[1]).encode(),
        b"HEIGHT": str(pixels.shape[0]).encode(),
        b"DEPTH": str(np.atleast_3d(pixels).shape[2]).encode(),
        b"MAXVAL": b"255",
        b"TUPLTYPE": tuple_type.encode(),
    }
    assert np.array_equal(np.frombuffer(samples, np.uint8), pixels.ravel())
