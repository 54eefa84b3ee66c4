"""Fitted colours against dense weighted least squares."""

from __future__ import annotations

import numpy as np
import pytest

from tests import twins
from tests.pictures import disc, noise
from vmesh.arrays import Float64Array, Int32Array, UInt8Array
from vmesh.encoder.colors import fit_colors, fit_components
from vmesh.encoder.image import weighted, with_hidden_colors_replaced
from vmesh.encoder.pipeline import encode
from vmesh.encoder.proposals import propose
from vmesh.encoder.settings import Settings
from vmesh.kernels.delaunay import delaunay


def mesh_on(image: UInt8Array, n: int) -> tuple[Int32Array, Int32Array, Float64Array]:
    """Vertices, triangles and the weights of the vertices at every pixel."""
    vertices = propose(weighted(image), Settings(vertices=n))[1].vertices()
    triangles = delaunay(vertices)
    positions = vertices.astype(np.int64) * 128
    return vertices, triangles, twins.barycentric_matrix(positions, triangles, *image.shape[:2])


@pytest.mark.parametrize("n_components", [1, 3, 4])
def test_colors_are_those_of_least_squares_weighted_by_alpha(n_components: int) -> None:
    image = noise(24, 28, n_components)
    image[:] = image // 4 + 90
    if n_components == 4:
        image[:10, :, 3] = 3
    vertices, triangles, matrix = mesh_on(image, 30)
    colors, equations = fit_colors(weighted(image), vertices, triangles, 2)
    for z in range(n_components):
        seen = image[:, :, 3].ravel() / 255 if n_components == 4 and z < 3 else np.ones(24 * 28)
        products, moments = matrix.T * seen @ matrix, matrix.T * seen @ image[:, :, z].ravel()
        assert equations[z].moments == pytest.approx(moments)
        blocks = np.zeros_like(products)
        for t, (a, b, c) in enumerate(equations[z].triangles):
            for block, (i, j) in zip(
                equations[z].products[t],
                [(a, a), (b, b), (c, c), (a, b), (b, c), (c, a)],
                strict=True,
            ):
                blocks[i, j] += block
                blocks[j, i] += block if i != j else 0.0
        assert blocks == pytest.approx(products, abs=1e-9)
        told = np.diag(products) > 0.2
        solution = np.clip(np.linalg.lstsq(products, moments, rcond=None)[0], 0, 255)
        assert colors[told, z] == pytest.approx(solution[told], abs=8)


def test_pixels_without_weight_do_not_count() -> None:
    image = noise(20, 20)
    vertices, triangles, _ = mesh_on(image, 30)
    weights = np.ones((20, 20))
    weights[5:9, 3:12] = 0
    other = image.copy()
    other[5:9, 3:12] = 255 - other[5:9, 3:12]
    start = np.full((len(vertices), 3), 128.0)
    first, second = (
        fit_components(each, weights, vertices, triangles, 2, start)[0] for each in (image, other)
    )
    assert np.array_equal(first, second)


def test_a_fit_to_a_plane_finds_its_colors() -> None:
    mesh = encode(noise(24, 24), vertices=25)
    # A plane function of the position is held exactly by any mesh.
    x, y = mesh.points.T
    exact = np.stack([4 * x + 20, 250 - 5 * y, 60 + 2 * x + 3 * y], axis=1)
    rows, columns = np.mgrid[:24, :24] + 0.5
    planes = [4 * columns + 20, 250 - 5 * rows, 60 + 2 * columns + 3 * rows]
    picture = np.rint(np.stack(planes, axis=2)).astype(np.uint8)
    colors, _ = fit_colors(weighted(picture), mesh.vertices, delaunay(mesh.vertices), mesh.unit)
    assert np.abs(colors - exact).max() < 4


def test_hidden_colors_are_those_of_the_nearest_visible_pixel() -> None:
    picture = disc(30, 30, hidden=(255, 0, 0), visible=(20, 90, 160))
    filled = with_hidden_colors_replaced(picture)
    assert (filled[:, :, :3] == (20, 90, 160)).all()
    assert np.array_equal(filled[:, :, 3], picture[:, :, 3])


@pytest.mark.parametrize("n_components", [1, 3, 4])
def test_a_picture_that_hides_no_colors_stays_what_it_is(n_components: int) -> None:
    picture = noise(5, 6, n_components)
    picture[:, :, 3:] = 255
    assert np.array_equal(with_hidden_colors_replaced(picture), picture)


def test_what_a_fully_transparent_picture_hides_leaves_no_trace() -> None:
    picture = noise(5, 6, 4)
    picture[:, :, 3] = 0
    filled = with_hidden_colors_replaced(picture)
    assert (filled == filled[0, 0]).all()
