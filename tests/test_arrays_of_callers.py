"""Arrays of callers: what is handed in is read, and never written."""

from __future__ import annotations

import io
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from PIL import Image

import vmesh
from vmesh.metrics import compare

Pixels = npt.NDArray[Any]

SHAPES = [
    (1, 1),
    (1, 7),
    (7, 1),
    (6, 5),
    *((*size, n) for size in ((1, 1), (1, 7), (7, 1), (6, 5)) for n in (3, 4)),
]
ENTRIES: dict[str, Callable[[Pixels], object]] = {
    "encode": lambda pixels: vmesh.encode(pixels, effort=2),
    "encode, sampled": lambda pixels: vmesh.encode(pixels, effort=1, density=0.5),
    "encode, blue noise": lambda pixels: vmesh.encode(pixels, method="blue-noise"),
    "fit": lambda pixels: vmesh.export(vmesh.encode(pixels, effort=1), "fit.svg", fit=pixels),
}


@pytest.mark.parametrize("entry", ENTRIES)
@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
@pytest.mark.parametrize("shape", SHAPES)
def test_pictures_are_read_and_not_written(
    shape: tuple[int, ...],
    dtype: type[np.unsignedinteger[Any]],
    entry: str,
    tmp_path: Any,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    random = np.random.default_rng(0)
    pixels = random.integers(0, np.iinfo(dtype).max, shape, dtype=dtype, endpoint=True)
    before = pixels.copy()
    ENTRIES[entry](pixels)
    np.testing.assert_array_equal(pixels, before)
    pixels.flags.writeable = False
    ENTRIES[entry](pixels)


def test_compared_pictures_are_read_and_not_written() -> None:
    first, second = np.random.default_rng(0).integers(0, 256, (2, 16, 16, 3), dtype=np.uint8)
    before = first.copy(), second.copy()
    first.flags.writeable = second.flags.writeable = False
    compare(first, second)
    np.testing.assert_array_equal((first, second), before)


def test_a_translucent_picture_of_one_pixel_is_a_mesh() -> None:
    mesh = vmesh.encode(np.array([[[200, 100, 50, 128]]], dtype=np.uint8), quality=100)
    shown = vmesh.render(mesh)[0, 0].astype(int)
    assert (abs(shown - [200, 100, 50, 128]) <= 2).all()


def test_the_parts_of_a_mesh_are_copies() -> None:
    vertices = np.array([[0, 0], [2, 0], [0, 2], [2, 2]])
    triangles = np.array([[0, 1, 2], [1, 3, 2]])
    colors = np.array([[10, 20, 30]] * 4)
    mesh = vmesh.Mesh.from_colors(2, 2, vertices, triangles, colors)
    for own in (vertices, triangles, colors):
        own[:] = 0
    assert mesh.vertices.max() == 2
    assert mesh.triangles.max() == 3
    assert (mesh.colors == [10, 20, 30]).all()


def test_an_image_is_saved_through_pillow_as_it_is() -> None:
    vmesh.register()
    image = Image.new("RGBA", (1, 1), (200, 100, 50, 128))
    image.save(io.BytesIO(), "VMESH", effort=2)
    assert image.getpixel((0, 0)) == (200, 100, 50, 128)
