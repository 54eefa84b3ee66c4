"""The colours of heat maps, and the errors that they show."""

from __future__ import annotations

import numpy as np
import pytest

from tests.pictures import noise
from vmesh.arrays import Float64Array, UInt8Array
from vmesh.inspection.heat import error_levels, heat_colors, scale_top
from vmesh.metrics import psnr


def lightness(colors: UInt8Array) -> Float64Array:
    """CIELAB's lightness, 0 to 100, of sRGB colours of shape (n, 3)."""
    samples = colors / 255
    linear = np.where(samples <= 0.04045, samples / 12.92, ((samples + 0.055) / 1.055) ** 2.4)
    y = linear @ (0.2126, 0.7152, 0.0722)
    return np.where(y > 0.008856, 116 * np.cbrt(y) - 16, 903.3 * y)


def test_the_scale_is_that_of_matplotlib_within_a_few_levels() -> None:
    matplotlib = pytest.importorskip("matplotlib", reason="matplotlib is not installed")
    theirs = np.array(matplotlib.colormaps["magma"].colors) * 255
    ours = heat_colors(np.linspace(0, 1, 256)).astype(float)
    assert np.abs(ours - theirs).max() <= 4.5


def test_equal_steps_grow_lighter_about_equally() -> None:
    steps = np.diff(lightness(heat_colors(np.linspace(0, 1, 33))))
    assert steps.min() > steps.mean() / 3
    assert steps.max() < steps.mean() * 1.5


def test_values_beyond_the_scale_have_the_colours_of_its_ends() -> None:
    ends = heat_colors(np.array([-1.0, 0.0, 1.0, 7.0]))
    assert (ends[0] == ends[1]).all()
    assert (ends[2] == ends[3]).all()


def test_an_error_is_the_root_of_the_mean_square_over_the_channels() -> None:
    first, second = noise(5, 7, seed=1), noise(5, 7, seed=2)
    levels = error_levels(first, second)
    for y, x in np.ndindex(5, 7):
        squares = [(int(a) - int(b)) ** 2 for a, b in zip(first[y, x], second[y, x], strict=True)]
        assert levels[y, x] == pytest.approx((sum(squares) / 3) ** 0.5)
    whole = 10 * np.log10(255**2 / np.mean(levels**2))
    assert whole == pytest.approx(psnr(first, second))


def test_the_top_of_the_scale_is_a_power_of_two_that_few_pixels_pass() -> None:
    for high in (0.0, 3.0, 4.0, 4.1, 30.0, 33.0, 255.0):
        levels = np.full((10, 10), high)
        top = scale_top(levels)
        assert top in (4, 8, 16, 32, 64, 128, 256)
        assert top >= high
        assert top == 4 or top / 2 < high
    spike = np.zeros((20, 20))
    spike[3, 3] = 200
    assert scale_top(spike) == 4
