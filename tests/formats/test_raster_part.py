"""Parts of meshes as pixels, against the whole and against a slow obvious renderer."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import vmesh
from tests.pictures import noise
from vmesh.arrays import Float64Array, UInt8Array
from vmesh.errors import LimitError
from vmesh.formats.raster.region import render_part
from vmesh.limits import Limits
from vmesh.mesh import Mesh


@pytest.fixture(scope="module")
def mesh(coffee: UInt8Array) -> Mesh:
    return vmesh.encode(coffee[120:200, 200:300], method="blue-noise", vertices=150)


def slow_part(mesh: Mesh, part: tuple[int, int, int, int], size: tuple[int, int]) -> Float64Array:
    """Colours at the centres of the pixels, by trying every triangle; shape (h, w, c)."""
    left, top, across, down = part
    result = np.full((size[1], size[0], mesh.n_components), np.nan)
    corners, colors = mesh.points[mesh.triangles], mesh.colors[mesh.triangles].astype(float)
    for row, column in np.ndindex(size[1], size[0]):
        x = left + (column + 0.5) * across / size[0]
        y = top + (row + 0.5) * down / size[1]
        for (a, b, c), own in zip(corners, colors, strict=True):
            matrix = np.column_stack([b - a, c - a])
            v, w = np.linalg.solve(matrix, np.array([x, y]) - a)
            if v >= 0 and w >= 0 and v + w <= 1:
                result[row, column] = np.array([1 - v - w, v, w]) @ own
                break
    return result


def test_a_part_shows_what_a_slow_renderer_finds(mesh: Mesh) -> None:
    part, size = (31, 17, 12, 9), (20, 15)
    ours, slow = render_part(mesh, part, size), slow_part(mesh, part, size)
    assert not np.isnan(slow).any()
    # Vertices lie on 1/256 pixel of the result: a few levels on steep triangles.
    assert np.abs(ours - slow).max() <= 3


@given(
    left=st.integers(0, 90),
    top=st.integers(0, 70),
    scale=st.integers(1, 6),
    n_components=st.sampled_from([1, 3, 4]),
)
def test_a_part_is_the_crop_of_the_whole(
    left: int, top: int, scale: int, n_components: int
) -> None:
    mesh = _meshes()[n_components]
    width, height = min(13, mesh.width - left), min(8, mesh.height - top)
    drawn = render_part(mesh, (left, top, width, height), (width * scale, height * scale))
    rows = slice(top * scale, (top + height) * scale)
    columns = slice(left * scale, (left + width) * scale)
    assert np.array_equal(drawn, vmesh.render(mesh, scale=scale)[rows, columns])


def _meshes() -> dict[int, Mesh]:
    pictures = {n: noise(80, 100, n) for n in (1, 3, 4)}
    return {
        n: vmesh.encode(pixels if n > 1 else pixels[:, :, 0], method="blue-noise", vertices=60)
        for n, pixels in pictures.items()
    }


def test_the_whole_at_its_own_size_is_the_render(mesh: Mesh) -> None:
    whole = render_part(mesh, (0, 0, mesh.width, mesh.height), (mesh.width, mesh.height))
    assert np.array_equal(whole, vmesh.render(mesh))


def test_a_reduced_part_has_the_means_of_its_pixels(mesh: Mesh) -> None:
    small = render_part(mesh, (20, 10, 60, 40), (15, 10))
    whole = vmesh.render(mesh)[10:50, 20:80].astype(float)
    means = whole.reshape(10, 4, 15, 4, 3).mean(axis=(1, 3))
    assert np.abs(small - means).max() <= 0.5


def test_samples_of_16_bits_stay_so() -> None:
    deep = noise(20, 20, 1)[:, :, 0].astype(np.uint16) * 257
    mesh = vmesh.encode(deep, method="blue-noise", vertices=30)
    assert render_part(mesh, (3, 4, 5, 6), (10, 12)).dtype == np.uint16


def test_a_scale_beyond_64_bits_and_rasters_beyond_the_limit_are_refused(mesh: Mesh) -> None:
    with pytest.raises(ValueError, match="pixels a side, over 65535"):
        render_part(mesh, (0, 0, 1, 1), (1000, 1000))
    with pytest.raises(LimitError, match="limit is 100 pixels"):
        render_part(mesh, (0, 0, 10, 10), (20, 20), limits=Limits(max_pixels=100))
