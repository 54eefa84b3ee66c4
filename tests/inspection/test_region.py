"""Regions of pictures, and the scale at which they are shown."""

from __future__ import annotations

import pytest

from vmesh.inspection.region import Region


def test_a_region_is_read_from_four_numbers() -> None:
    assert Region.parse("120,80,40,30") == Region(120, 80, 40, 30)
    assert Region.parse(" 0, 0, 1, 1") == Region(0, 0, 1, 1)


@pytest.mark.parametrize("text", ["", "1,2,3", "1,2,3,4,5", "a,b,c,d", "1,2,3,4.5"])
def test_other_texts_are_told(text: str) -> None:
    with pytest.raises(ValueError, match="four whole numbers x,y,w,h"):
        Region.parse(text)


@pytest.mark.parametrize("numbers", [(0, 0, 0, 5), (0, 0, 5, -1), (-1, 0, 5, 5), (0, -2, 5, 5)])
def test_a_region_has_pixels_and_none_before_the_first(
    numbers: tuple[int, int, int, int],
) -> None:
    with pytest.raises(ValueError, match="at least one pixel, from 0,0 on"):
        Region(*numbers)


def test_a_region_that_reaches_beyond_the_picture_is_told() -> None:
    Region(10, 20, 30, 40).check_within(40, 60)
    for width, height in ((39, 60), (40, 59)):
        with pytest.raises(ValueError, match=f"beyond the picture of {width} x {height}"):
            Region(10, 20, 30, 40).check_within(width, height)


def test_small_regions_are_enlarged_by_whole_numbers_and_large_ones_reduced() -> None:
    assert Region(0, 0, 40, 30).good_scale(600) == 10
    assert Region(0, 0, 300, 200).good_scale(600) == 2
    assert Region(0, 0, 451, 300).good_scale(451) == 1
    assert Region(0, 0, 300, 4000).good_scale(4000) == 0.25
    # 30,000 pixels a side may be drawn at twice their size, not at 400 times.
    assert Region(0, 0, 1, 1).good_scale(30_000) == 2
