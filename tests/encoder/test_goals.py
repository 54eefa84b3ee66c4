"""Goals in pictures of every size: numbers, sizes and PSNR are met, quality never lets one down.

Pictures of a few pixels have few meshes, so where a goal lies between two of them the nearer one on
the right side counts; the tests say which pictures are as small as that.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Final

import numpy as np
import pytest

from tests.pictures import checkerboard, constant, disc, drawn, noise, ramp
from vmesh.arrays import SampleArray, UInt8Array
from vmesh.codec.writer import dumps
from vmesh.encoder.image import as_image
from vmesh.encoder.pipeline import encode
from vmesh.encoder.rate_control import measure_psnr


def single_pixel() -> UInt8Array:
    """One colour but for a pixel."""
    picture = constant(20, 20, 90, 90, 90)
    picture[11, 7] = (250, 20, 20)
    return picture


def letters() -> UInt8Array:
    """Black strokes a pixel or two wide on white."""
    picture = constant(16, 28, 255, 255, 255)
    for x in range(2, 26, 6):
        picture[3:13, x] = 0
        picture[3 + x % 4, x : x + 4] = 0
        picture[12, x : x + 4] = (200, 0, 0)
    return picture


def soft() -> UInt8Array:
    """A faint wave with a little noise, in grey."""
    y, x = np.mgrid[:24, :32]
    grain = noise(24, 32, 1)[:, :, 0] % 7
    picture: UInt8Array = np.rint(120 + 6 * np.sin(x / 3) + y / 4 + grain).astype(np.uint8)
    return picture


KINDS: Final[dict[str, SampleArray]] = {
    "flat": constant(12, 15, 9, 80, 200),
    "noise": noise(14, 16),
    "grey noise": noise(16, 20, 1)[:, :, 0],
    "gradient": ramp(20, 24),
    "checkerboard": checkerboard(16, 16),
    "squares": checkerboard(24, 24, 4),
    "single pixel": single_pixel(),
    "letters": letters(),
    "soft": soft(),
    "one row": noise(1, 60),
    "one column": noise(50, 1, 1)[:, :, 0],
    "3 x 3": noise(3, 3),
    "one pixel": noise(1, 1),
    "alpha": noise(12, 14, 4),
    "disc": disc(32, 32, (255, 0, 0), (20, 90, 160)),
    "16 bits": noise(12, 12).astype(np.uint16) * 257 + noise(12, 12, seed=2),
    "16 bits of a gradient": ramp(16, 20).astype(np.uint16) * 257,
}
# All kinds, the quickest and the thorough effort among their neighbours.
EFFORTS: Final = {name: (1, 2 + i % 8) for i, name in enumerate(KINDS)}
QUALITIES: Final = (0, 10, 25, 50, 75, 90, 95, 100)


def reached(picture: SampleArray, **settings: float) -> float:
    mesh = encode(picture, **settings)  # type: ignore[arg-type]
    return measure_psnr(as_image(picture), mesh)


@pytest.mark.parametrize("name", KINDS)
def test_more_quality_never_gives_a_worse_picture(name: str) -> None:
    for effort in EFFORTS[name]:
        levels = [reached(KINDS[name], quality=q, effort=effort) for q in QUALITIES]
        # No tolerance at all: the squared errors are sums of the same numbers.
        assert levels == sorted(levels)
        assert levels[-1] > 50


@pytest.mark.parametrize("effort", [3, 5, 9])
def test_more_quality_is_no_worse_at_higher_efforts_either(effort: int) -> None:
    for name in ("letters", "soft", "3 x 3"):
        levels = [reached(KINDS[name], quality=q, effort=effort) for q in QUALITIES]
        assert levels == sorted(levels)


@pytest.mark.parametrize("effort", [1, 2, 5])
@pytest.mark.parametrize("picture", [noise(66, 70), noise(2, 2500), checkerboard(72, 72, 5)])
def test_pictures_too_large_for_that_do_not_collapse(picture: UInt8Array, effort: int) -> None:
    lower, higher = (reached(picture, quality=q, effort=effort) for q in (75, 100))
    assert higher >= lower
    assert higher > reached(picture, density=0.2, effort=effort)


@pytest.mark.parametrize("effort", [1, 5])
@pytest.mark.parametrize("tile", [None, 32])
@pytest.mark.parametrize("size", [(40, 50), (3, 90), (1, 70), (80, 2), (33, 34)])
def test_every_number_of_vertices_is_met(
    size: tuple[int, int], tile: int | None, effort: int
) -> None:
    picture = noise(*size)
    n_pixels = size[0] * size[1]
    corners = 4 if tile is None else (-(-size[0] // 32) + 1) * (-(-size[1] // 32) + 1)
    most = n_pixels + corners
    for n in (4, 17, 60, n_pixels // 3, n_pixels // 2, n_pixels - 1, n_pixels + 1, most, 2 * most):
        mesh = encode(picture, vertices=n, tile=tile, effort=effort)
        mesh.check()
        assert mesh.n_vertices == min(max(n, corners), most)


def test_a_vertex_at_each_pixel_holds_the_picture_without_any_error() -> None:
    for picture in (noise(20, 30), noise(40, 35, 4), noise(9, 50, 1)):
        for tile in (None, 32):
            n = picture.shape[0] * picture.shape[1] + 50
            mesh = encode(picture, vertices=n, color_step=1, tile=tile, effort=2)
            assert measure_psnr(as_image(picture), mesh) > 45


@pytest.mark.parametrize("effort", [1, 5])
@pytest.mark.parametrize("name", ["noise", "grey noise", "letters", "soft", "alpha", "16 bits"])
def test_the_psnr_of_small_pictures_is_met(name: str, effort: int) -> None:
    for wanted in (25.0, 38.0, 50.0):
        assert wanted <= reached(KINDS[name], target_psnr=wanted, effort=effort) <= wanted + 0.1


@pytest.mark.parametrize("effort", [1, 5])
@pytest.mark.parametrize("name", KINDS)
def test_every_psnr_is_reached(name: str, effort: int) -> None:
    for wanted in (20.0, 60.0):
        assert reached(KINDS[name], target_psnr=wanted, effort=effort) >= wanted


def test_the_psnr_of_tiles_is_met_where_every_pixel_counts() -> None:
    picture = noise(40, 44)
    for wanted in (30.0, 45.0):
        found = reached(picture, target_psnr=wanted, tile=32, effort=2)
        assert wanted <= found <= wanted + 0.1


@pytest.mark.parametrize("effort", [1, 5])
@pytest.mark.parametrize("name", ["noise", "letters", "soft", "alpha", "disc", "16 bits"])
def test_the_size_of_small_pictures_is_met(name: str, effort: int) -> None:
    for wanted in (120, 200, 350):
        size = len(dumps(encode(KINDS[name], target_size=wanted, effort=effort)))
        assert 0.98 * wanted <= size <= wanted


def test_more_bytes_than_a_picture_takes_without_error_are_not_filled() -> None:
    picture = KINDS["3 x 3"]
    mesh = encode(picture, target_size=5000)
    assert np.array_equal(drawn(mesh), picture)
    assert len(dumps(mesh)) < 200


def test_a_long_strip_meets_its_goals() -> None:
    strip = noise(3, 3000, 1)[:, :, 0] // 4 + ramp(3, 3000)[:, :, 0] // 2
    for effort in (1, 2):
        assert encode(strip, vertices=777, effort=effort).n_vertices == 777
        assert 0.98 * 2000 <= len(dumps(encode(strip, target_size=2000, effort=effort))) <= 2000
        assert 35 <= reached(strip, target_psnr=35.0, effort=effort) <= 35.1
        levels = [reached(strip, quality=q, effort=effort) for q in (25, 60, 90, 100)]
        assert all(a < b + 0.2 for a, b in pairwise(levels))
        assert levels[-1] > levels[0] + 1
