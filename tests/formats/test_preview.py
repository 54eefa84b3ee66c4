"""What notebooks show of a mesh, as IPython asks for it."""

from __future__ import annotations

import io
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lxml import etree
from PIL import Image

import vmesh
from tests.codec import samples
from tests.pictures import ramp
from vmesh.arrays import UInt8Array

formatters: Any = pytest.importorskip("IPython.core.formatters", reason="IPython is not installed")


def shown(mesh: vmesh.Mesh) -> dict[str, Any]:
    """What IPython puts into a notebook, by MIME type."""
    bundle: dict[str, Any] = formatters.DisplayFormatter().format(mesh)[0]
    return bundle


def picture(bundle: dict[str, Any]) -> UInt8Array:
    with Image.open(io.BytesIO(bundle["image/png"])) as image:
        return np.asarray(image)


@pytest.mark.parametrize("case", ["grey, implied", "RGB, implied", "RGBA, implied"])
def test_a_small_mesh_is_shown_as_a_picture_and_as_a_drawing(case: str) -> None:
    mesh = samples.CASES[case]()
    bundle = shown(mesh)
    assert set(bundle) == {"text/plain", "image/png", "image/svg+xml"}
    assert np.array_equal(picture(bundle), vmesh.render(mesh))
    root = etree.fromstring(bundle["image/svg+xml"].encode())
    assert root.get("viewBox") == f"0 0 {mesh.width} {mesh.height}"


def test_more_than_1000_triangles_are_shown_as_a_picture_only() -> None:
    few, many = (vmesh.encode(ramp(64, 64), method="blue-noise", vertices=n) for n in (480, 600))
    assert few.n_triangles <= 1000 < many.n_triangles
    assert "image/svg+xml" in shown(few)
    assert set(shown(many)) == {"text/plain", "image/png"}


@pytest.mark.parametrize(("factor", "size"), [(63, (1008, 1008)), (100, (1024, 1024))])
def test_a_picture_is_shown_in_its_own_size_unless_that_is_large(
    factor: int, size: tuple[int, int]
) -> None:
    mesh = samples.color().transform((factor, 0, 0, factor, 0, 0))
    assert picture(shown(mesh)).shape[1::-1] == size


def test_what_covers_no_canvas_is_shown_transparent() -> None:
    tilted = samples.color().transform((0.8, 0.6, -0.6, 0.8, 0, 0))
    assert picture(shown(tilted))[0, 0, 3] == 0


def test_a_mesh_draws_nothing_until_it_is_shown() -> None:
    code = (
        "import sys, vmesh\n"
        "square = [[0, 0], [1, 0], [0, 1], [1, 1]]\n"
        "mesh = vmesh.Mesh.from_colors(1, 1, square, [[0, 1, 3], [0, 3, 2]], [[0]] * 4)\n"
        "assert not {'numba', 'PIL'} & set(sys.modules)\n"
        "assert mesh._repr_png_().startswith(b'\\x89PNG')\n"
    )
    root = Path(vmesh.__file__).parents[1]
    subprocess.run([sys.executable, "-c", code], check=True, cwd=root)
