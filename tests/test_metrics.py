"""PSNR and SSIM."""

from __future__ import annotations

import numpy as np
import pytest

from vmesh.metrics import compare, psnr, ssim


def test_equal_pictures_have_infinite_psnr_and_ssim_one(coffee: np.ndarray) -> None:
    figures = compare(coffee, coffee)
    assert figures["psnr_rgb"] == figures["psnr_y"] == float("inf")
    assert figures["ssim"] == pytest.approx(1.0)


def test_psnr_of_a_known_error() -> None:
    first = np.zeros((10, 10, 3), dtype=np.uint8)
    assert psnr(first, first + np.uint8(5)) == pytest.approx(34.1514, abs=1e-4)


def test_ssim_agrees_with_its_definition_at_one_window() -> None:
    rng = np.random.default_rng(0)
    first = rng.uniform(0, 255, (11, 11))
    second = np.clip(first + rng.normal(0, 20, (11, 11)), 0, 255)
    offsets = np.arange(11) - 5
    line = np.exp(-(offsets**2) / (2 * 1.5**2))
    window = np.outer(line, line) / line.sum() ** 2
    m1, m2 = (window * first).sum(), (window * second).sum()
    v1, v2 = (window * first**2).sum() - m1**2, (window * second**2).sum() - m2**2
    cov = (window * first * second).sum() - m1 * m2
    c1, c2 = 6.5025, 58.5225
    expected = (2 * m1 * m2 + c1) * (2 * cov + c2) / ((m1**2 + m2**2 + c1) * (v1 + v2 + c2))
    assert ssim(first, second) == pytest.approx(expected, abs=1e-6)


def test_pictures_of_different_sizes_are_refused() -> None:
    with pytest.raises(ValueError, match="one size"):
        compare(np.zeros((2, 3, 3), np.uint8), np.zeros((3, 2, 3), np.uint8))
