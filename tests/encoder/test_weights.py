"""Weights: what counts more comes out better, in the same bytes, and nothing else changes."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from tests import twins
from tests.pictures import disc, drawn, noise, step_edge
from tests.surfaces import unevenly
from vmesh.arrays import BoolArray, SampleArray, UInt8Array
from vmesh.codec.writer import dumps
from vmesh.encoder.colors import fit_colors
from vmesh.encoder.image import weighted
from vmesh.encoder.pipeline import encode
from vmesh.encoder.salience import ONE, emphasised
from vmesh.kernels.delaunay import delaunay
from vmesh.kernels.remeshing import WeightedImage


@pytest.fixture(scope="module")
def cup(coffee: UInt8Array) -> UInt8Array:
    """A part of a photograph, 96 x 128 pixels: smooth, with sharp edges."""
    return np.ascontiguousarray(coffee[110:206, 170:298])


def middle_of(picture: SampleArray) -> BoolArray:
    """An ellipse of a fifth of the picture."""
    height, width = picture.shape[:2]
    y, x = np.mgrid[:height, :width]
    inside: BoolArray = np.hypot(x / width - 0.5, y / height - 0.5) < 0.25
    return inside


def error_in(part: BoolArray, picture: SampleArray, **settings: Any) -> float:
    """Mean squared error in a part of the picture."""
    difference = drawn(encode(picture, **settings)).astype(float) - picture
    return float(np.square(difference[part]).mean())


@pytest.mark.parametrize(
    "settings",
    [
        {"target_size": 1200},
        {"target_size": 1200, "effort": 1},
        {"target_size": 1200, "effort": 2, "tile": 48},
        {"vertices": 400, "effort": 3},
        {"vertices": 400, "method": "blue-noise"},
    ],
    ids=str,
)
@pytest.mark.parametrize("rest", [0.0, 0.1])
def test_what_counts_more_has_less_error_in_the_same_bytes(
    cup: UInt8Array, rest: float, settings: dict[str, Any]
) -> None:
    part = middle_of(cup)
    mask = np.where(part, 1.0, rest)
    most = 0.75 if rest == 0.0 else 0.9
    assert error_in(part, cup, weights=mask, **settings) < most * error_in(part, cup, **settings)


def test_16_bits_and_alpha_have_weights_too(cup: UInt8Array) -> None:
    alpha = np.full(cup.shape[:2], 255, dtype=np.uint8)
    alpha[:30] = 90
    part = middle_of(cup)
    deep = cup[:, :, 1].astype(np.uint16)[:, :, None] * 257
    for picture in (np.dstack([cup, alpha]), deep):
        plain = error_in(part, picture, target_size=1000, effort=2)
        assert error_in(part, picture, weights=part, target_size=1000, effort=2) < 0.8 * plain


@pytest.mark.parametrize("effort", [1, 4])
@pytest.mark.parametrize("value", [1.0, 1, 200, 0.3, True])
def test_equal_weights_are_as_good_as_none(cup: UInt8Array, value: float, effort: int) -> None:
    weights = np.full(cup.shape[:2], value)
    first, second = (dumps(encode(cup, weights=w, effort=effort)) for w in (None, weights))
    assert first == second


def test_the_scale_of_weights_does_not_matter(cup: UInt8Array) -> None:
    levels = (np.arange(cup.shape[0] * cup.shape[1]) % 251).reshape(cup.shape[:2])
    given: list[npt.ArrayLike] = [
        levels.astype(np.uint8),
        levels.astype(np.float32) * np.float32(1e-20),
        levels * 1e300,
        (levels * 3).tolist(),
    ]
    files = {dumps(encode(cup, weights=weights, vertices=150, effort=2)) for weights in given}
    assert len(files) == 1


@pytest.mark.parametrize("effort", [1, 2, 5])
def test_what_does_not_count_still_looks_like_the_picture(cup: UInt8Array, effort: int) -> None:
    part = middle_of(cup)
    shown = drawn(encode(cup, weights=part, quality=60, effort=effort)).astype(float)
    flat = np.square(cup[~part] - cup[~part].mean(axis=0)).mean()
    assert np.square(shown - cup)[~part].mean() < flat


@pytest.mark.parametrize(
    "picture",
    [
        noise(1, 1),
        noise(1, 40),
        noise(9, 7, 1),
        disc(24, 24, (9, 9, 9), (200, 30, 80)),
        noise(70, 70),
    ],
    ids=["1 x 1", "one row", "grey", "alpha", "noise"],
)
@pytest.mark.parametrize("goal", [{}, {"vertices": 5}, {"target_size": 90}, {"target_psnr": 20.0}])
def test_a_single_pixel_may_be_all_that_counts(picture: UInt8Array, goal: dict[str, Any]) -> None:
    weights = np.zeros(picture.shape[:2])
    weights[-1, -1] = 7
    for effort in (1, 3):
        mesh = encode(picture, weights=weights, effort=effort, **goal)
        mesh.check()
        # Its own vertex would cost next to nothing.
        if not goal and picture.size > 3 and picture.shape[2] != 4:
            errors = np.square(drawn(mesh).astype(float) - picture).mean(axis=2)
            assert errors[-1, -1] <= errors.mean()


def test_colors_are_fitted_as_each_pixel_counts() -> None:
    image = unevenly(noise(12, 14), seed=3)
    corners = [[0, 0], [28, 0], [13, 11], [0, 24], [28, 24]]
    vertices = np.array(corners, dtype=np.int32)
    triangles = delaunay(vertices)
    colors, _ = fit_colors(image, vertices, triangles, 2)
    matrix = twins.barycentric_matrix(vertices.astype(np.int64) * 128, triangles, 12, 14)
    roots = np.sqrt(image.weights).reshape(-1, 1)
    samples = image.samples.reshape(-1, 3)
    expected = np.linalg.lstsq(matrix * roots, samples * roots, rcond=None)[0]
    assert colors == pytest.approx(expected.clip(0, 255), abs=1.5)


def test_salience_grows_with_the_root_of_the_weight() -> None:
    salience = np.array([[[0, 100, 40_000], [100, 65_280, 9]]], dtype=np.uint16)
    weights = np.array([[4.0, 4.0, 4.0], [0.25, 1.0, 1.0]])
    expected = [[[0, 200, ONE], [50, 65_280, 9]]]
    assert emphasised(salience, weights).tolist() == expected


def test_a_picture_without_weights_has_ones() -> None:
    image = weighted(step_edge(5, 6))
    assert isinstance(image, WeightedImage)
    assert (image.weights == 1).all()
    ramp = weighted(step_edge(5, 6), np.arange(30).reshape(5, 6)).weights
    assert ramp.mean() == pytest.approx(1)
    assert 0 < ramp[0, 0] < ramp[0, 1] < ramp[4, 5]


@pytest.mark.parametrize(
    ("weights", "error", "reason"),
    [
        (np.zeros((8, 8)), ValueError, "not all 0"),
        (-np.ones((8, 8)), ValueError, "0 or more"),
        (np.full((8, 8), np.nan), ValueError, "finite"),
        (np.full((8, 8), np.inf), ValueError, "finite"),
        (np.ones((8, 9)), ValueError, "shape"),
        (np.ones((8, 8, 1)), ValueError, "shape"),
        (1.0, ValueError, "shape"),
        (np.ones((8, 8), dtype=complex), TypeError, "real numbers"),
        (np.full((8, 8), "white"), TypeError, "real numbers"),
    ],
)
def test_weights_of_another_kind_are_refused(
    weights: npt.ArrayLike, error: type[Exception], reason: str
) -> None:
    with pytest.raises(error, match=reason):
        encode(noise(8, 8), weights=weights)
