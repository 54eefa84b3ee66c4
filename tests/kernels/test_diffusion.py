from __future__ import annotations

import numpy as np
import pytest

from tests import twins
from vmesh.arrays import UInt8Array, UInt16Array
from vmesh.encoder.salience import ONE
from vmesh.encoder.sampling import diffusion_tables
from vmesh.encoder.settings import Diffusion
from vmesh.kernels.diffusion import diffuse

UNIT = 1 << 16


def random_salience(n_classes: int, height: int, width: int, most: int = ONE) -> UInt16Array:
    random = np.random.default_rng(n_classes * 10_000 + height * 100 + width)
    return random.integers(0, most, (n_classes, height, width), endpoint=True, dtype=np.uint16)


def constant_salience(density: float, side: int) -> UInt16Array:
    return np.full((1, side, side), round(density * ONE), dtype=np.uint16)


@pytest.mark.parametrize("diffusion", ["zhou-fang", "ostromoukhov"])
@pytest.mark.parametrize("shape", [(1, 12, 17), (3, 16, 11), (4, 9, 9), (3, 1, 20), (2, 20, 1)])
@pytest.mark.parametrize(
    ("scale", "floor"), [(UNIT, 0), (UNIT // 5, 0), (3 * UNIT, 0), (UNIT // 9, ONE // 7), (0, ONE)]
)
def test_the_kernel_does_what_its_obvious_version_does(
    diffusion: Diffusion, shape: tuple[int, int, int], scale: int, floor: int
) -> None:
    weights, strengths = diffusion_tables(diffusion)
    salience = random_salience(*shape)
    for seed in (0, 1, 987_654_321):
        classes = diffuse(salience, scale, floor, weights, strengths, seed)
        expected = twins.diffuse(salience, scale, floor, weights, strengths, seed)
        assert np.array_equal(classes, expected)


@pytest.mark.parametrize("diffusion", ["zhou-fang", "ostromoukhov"])
@pytest.mark.parametrize("density", [0.01, 0.1, 0.33, 0.5, 0.8, 1.0])
def test_as_many_samples_fall_as_the_salience_amounts_to(
    diffusion: Diffusion, density: float
) -> None:
    salience = constant_salience(density, 128)
    n_samples = np.count_nonzero(diffuse(salience, UNIT, 0, *diffusion_tables(diffusion), 3))
    # What is left over falls off the lower edge and the sides.
    assert n_samples == pytest.approx(density * 128**2, abs=128)


def test_no_salience_gives_no_samples() -> None:
    tables = diffusion_tables("zhou-fang")
    assert not diffuse(np.zeros((3, 40, 40), dtype=np.uint16), UNIT, 0, *tables, 0).any()


def test_full_salience_samples_every_pixel() -> None:
    tables = diffusion_tables("zhou-fang")
    assert diffuse(np.full((1, 40, 40), ONE, dtype=np.uint16), UNIT, 0, *tables, 0).all()


def test_the_classes_share_the_samples_as_their_planes_do() -> None:
    densities = (0.05, 0.1, 0.2)
    salience = np.concatenate([constant_salience(density, 160) for density in densities])
    classes = diffuse(salience, UNIT, 0, *diffusion_tables("zhou-fang"), 1)
    counts = np.bincount(classes.ravel(), minlength=4)[1:]
    assert counts == pytest.approx(np.array(densities) * 160**2, rel=0.02)


def test_crowded_classes_share_the_pixels_in_proportion() -> None:
    salience = np.concatenate([constant_salience(density, 96) for density in (0.4, 0.8, 1.0)])
    classes = diffuse(salience, UNIT, 0, *diffusion_tables("zhou-fang"), 1)
    counts = np.bincount(classes.ravel(), minlength=4)[1:]
    assert counts == pytest.approx(np.array([0.4, 0.8, 1.0]) / 2.2 * 96**2, rel=0.02)


def band_power(points: UInt8Array, density: float, low: float, high: float) -> float:
    """Mean power between two multiples of the principal frequency; 1 for white noise.

    The principal frequency of a blue-noise set of density g is sqrt(g) cycles per pixel, or
    sqrt(1 - g) where the pixels left out are the fewer (Ulichney 1988).
    """
    principal = np.sqrt(density if density <= 0.5 else 1 - density)
    side = len(points)
    spectrum = np.abs(np.fft.fft2(points - density)) ** 2 / (side**2 * density * (1 - density))
    frequency = np.fft.fftfreq(side)
    radius = np.hypot(frequency[:, None], frequency[None, :]) / principal
    ring = (radius > low) & (radius < high)
    return float(spectrum[ring].mean())


@pytest.mark.parametrize("density", [0.03, 0.08, 0.15, 0.25, 0.33, 0.42, 0.5, 0.67, 0.9])
def test_samples_of_constant_salience_are_blue(density: float) -> None:
    tables = diffusion_tables("zhou-fang")
    side, margin = 256, 32  # The first rows have no errors to build on yet.
    salience = constant_salience(density, side + margin)
    samples = diffuse(salience, UNIT, 0, *tables, 1)[margin:, margin:]
    scattered = (np.random.default_rng(2).random((side, side)) < density).astype(np.uint8)
    assert band_power(scattered, density, 0, 0.5) == pytest.approx(1.0, abs=0.15)
    assert band_power(samples, density, 0, 0.25) < 0.08
    assert band_power(samples, density, 0, 0.5) < 0.4
    assert band_power(samples, density, 0.9, 1.1) > 1.3


def test_the_union_of_all_classes_is_blue_too() -> None:
    density, side = 0.08, 288
    salience = np.concatenate([constant_salience(density, side)] * 3)
    classes = diffuse(salience, UNIT, 0, *diffusion_tables("zhou-fang"), 1)[32:, 32:]
    union = (classes > 0).astype(np.uint8)
    assert band_power(union, 3 * density, 0, 0.25) < 0.08
    assert band_power(union, 3 * density, 0, 0.5) < 0.2


def test_the_seed_moves_the_samples() -> None:
    tables = diffusion_tables("zhou-fang")
    salience = constant_salience(0.4, 32)
    first, again = (diffuse(salience, UNIT, 0, *tables, 5) for _ in range(2))
    other = diffuse(salience, UNIT, 0, *tables, 6)
    assert np.array_equal(first, again)
    assert not np.array_equal(first, other)
