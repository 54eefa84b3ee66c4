"""The kernels run as plain Python, and give the same bytes and pixels as when compiled."""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from tests.pictures import PICTURES, disc, drawn, noise, ramp
from tests.strategies import flipped
from vmesh.arrays import UInt8Array
from vmesh.codec.reader import loads
from vmesh.codec.writer import dumps
from vmesh.encoder.pipeline import encode
from vmesh.kernels.scanline import SUBPIXEL, fill
from vmesh.mesh import Mesh

ROOT = Path(__file__).parent.parent


def corner_at_40_times(mesh: Mesh) -> UInt8Array:
    """The first 50 x 50 pixels of a mesh drawn at 40 times its size: large triangles."""
    raster = np.zeros((50, 50, mesh.n_components), dtype=np.uint8)
    positions = mesh.vertices.astype(np.int64) * (40 * SUBPIXEL // mesh.unit)
    fill(positions, mesh.triangles, mesh.colors, raster)
    return raster


def fingerprints() -> dict[str, str]:
    """A digest of what each step makes of a few small pictures."""
    pictures = {
        "ramp": ramp(16, 24),
        "noise": noise(16, 24),
        "disc": disc(24, 16, hidden=(255, 0, 0), visible=(0, 90, 200)),
        "grey noise": PICTURES["grey noise"],
        "one pixel": PICTURES["one pixel"],
    }
    chosen: dict[str, dict[str, Any]] = {
        "multiclass": {"method": "blue-noise", "density": 0.15, "seed": 2**31 + 7},
        "channels": {"method": "blue-noise", "density": 0.15, "sampler": "channels"},
        "adaptive": {"density": 0.1, "effort": 3},
        "adaptive, by quality": {"quality": 90, "effort": 2},
    }
    result = {}
    for (name, picture), (way, settings) in product(pictures.items(), chosen.items()):
        mesh = encode(picture, **settings)
        random = np.random.default_rng(3)
        turned = mesh.replaced(triangles=flipped(mesh.vertices, mesh.triangles, 9, random))
        for each in (mesh, turned):
            data = dumps(each)
            again = loads(data)
            assert again == each.canonical()
            parts = (data, drawn(again).tobytes(), corner_at_40_times(again).tobytes())
            digest = hashlib.sha256(b"".join(parts)).hexdigest()
            result[f"{name}, {way}, {'turned' if each is turned else 'as it is'}"] = digest
    return result


def test_plain_python_gives_the_bytes_and_pixels_of_the_compiled_kernels() -> None:
    code = (
        "import json, numba, tests.test_without_jit as own\n"
        "assert numba.config.DISABLE_JIT\n"
        "print(json.dumps(own.fingerprints()))"
    )
    plain = subprocess.run(
        [sys.executable, "-W", "error", "-c", code],
        env={**os.environ, "NUMBA_DISABLE_JIT": "1"},
        capture_output=True,
        text=True,
        check=False,
        cwd=ROOT,
    )
    assert plain.returncode == 0, plain.stderr
    assert json.loads(plain.stdout) == fingerprints()
