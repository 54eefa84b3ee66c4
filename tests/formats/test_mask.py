"""Masks: pictures of any kind and size become weights of a photograph's pixels."""

from __future__ import annotations

import io

import numpy as np
import pytest
from PIL import Image

from vmesh.arrays import Float64Array, SampleArray
from vmesh.errors import ImageError, LimitError
from vmesh.formats.picture.mask import read_mask
from vmesh.limits import Limits


def weights_of(array: SampleArray, width: int, height: int) -> Float64Array:
    stream = io.BytesIO()
    Image.fromarray(array).save(stream, "PNG")
    return read_mask(io.BytesIO(stream.getvalue()), width, height)


HALF = np.zeros((6, 8), dtype=np.uint8)
HALF[:, 4:] = 255


def test_white_counts_fully_and_black_not_at_all() -> None:
    assert weights_of(HALF, 8, 6) == pytest.approx(HALF / 255)


@pytest.mark.parametrize("scale", [1, 257])
def test_the_depth_of_a_mask_does_not_matter(scale: int) -> None:
    grey = np.arange(0, 240, 5).reshape(6, 8).astype(np.uint8)
    deep = grey.astype(np.uint16 if scale > 1 else np.uint8) * scale
    assert weights_of(deep, 8, 6) == pytest.approx(grey / 255, abs=1e-6)


@pytest.mark.parametrize(("width", "height"), [(80, 60), (4, 3), (24, 6), (8, 1), (1, 1)])
def test_a_mask_is_stretched_over_the_photograph(width: int, height: int) -> None:
    weights = weights_of(HALF, width, height)
    assert weights.shape == (height, width)
    assert weights.mean() == pytest.approx(0.5, abs=0.02)
    if width > 1:
        assert (weights[:, 0] < 0.15).all()
        assert (weights[:, -1] > 0.85).all()


def test_colors_count_as_their_grey_and_what_is_transparent_as_black() -> None:
    green = np.zeros((2, 2, 4), dtype=np.uint8)
    green[:] = (0, 255, 0, 255)
    green[0, 0, 3] = 0
    weights = weights_of(green, 2, 2)
    assert weights[0, 0] == 0
    assert weights[1, 1] == pytest.approx(0.587)
    assert weights_of(green[:, :, :3].copy(), 2, 2) == pytest.approx(0.587)


def test_a_mask_that_is_black_all_over_is_refused() -> None:
    with pytest.raises(ImageError, match="black all over"):
        weights_of(np.zeros((5, 5), dtype=np.uint8), 9, 9)


def test_what_is_no_picture_is_refused_and_so_is_too_large_a_one() -> None:
    with pytest.raises(ImageError, match="not an image"):
        read_mask(io.BytesIO(b"no picture"), 4, 4)
    stream = io.BytesIO()
    Image.fromarray(HALF).save(stream, "PNG")
    with pytest.raises(LimitError):
        read_mask(io.BytesIO(stream.getvalue()), 4, 4, limits=Limits(max_pixels=20))
