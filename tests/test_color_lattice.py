from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given

from tests.strategies import lattices
from vmesh.color_lattice import ColorLattice


def sampled_colors(n_components: int) -> np.typing.NDArray[np.int64]:
    """All extremes and many others."""
    random = np.random.default_rng(1)
    extremes = np.stack(np.meshgrid(*[[0, 1, 127, 128, 254, 255]] * n_components), axis=-1)
    others = random.integers(0, 256, (50_000, n_components))
    return np.concatenate([extremes.reshape(-1, n_components), others])


@pytest.mark.parametrize("n_components", [1, 3, 4])
@pytest.mark.parametrize("depth", [8, 9, 12, 16])
def test_steps_of_one_keep_every_color(n_components: int, depth: int) -> None:
    lattice = ColorLattice.uniform(n_components, 1, depth)
    colors = sampled_colors(n_components) * lattice.max_sample // 255
    levels = lattice.levels_from_colors(colors)
    assert np.array_equal(lattice.colors_from_levels(levels), colors)


@pytest.mark.parametrize("step", [1, 2, 3, 7, 16, 100, 255])
def test_grey_and_alpha_are_rounded_to_the_nearest_multiple(step: int) -> None:
    lattice = ColorLattice((step,))
    colors = np.arange(256)[:, None]
    rounded = lattice.levels_from_colors(colors) * step
    assert (abs(rounded - colors) <= step / 2).all()
    expected = np.minimum(rounded, 255)
    assert np.array_equal(lattice.colors_from_levels(rounded // step), expected)


@given(lattices())
def test_levels_of_any_color_are_nearest_and_within_bounds(lattice: ColorLattice) -> None:
    colors = sampled_colors(lattice.n_components)[::37]
    levels = lattice.levels_from_colors(colors)
    lowest, highest = lattice.level_bounds()
    assert (levels >= lowest).all()
    assert (levels <= highest).all()
    # Rounding to the nearest level moves a value of a lattice of steps 1 by half a step at most.
    exact = ColorLattice((1,) * lattice.n_components, lattice.depth).levels_from_colors(colors)
    assert (2 * abs(levels * np.array(lattice.steps) - exact) <= np.array(lattice.steps)).all()


@given(lattices())
def test_levels_of_a_drawn_color_stay_close_to_it(lattice: ColorLattice) -> None:
    colors = sampled_colors(lattice.n_components)[::37]
    result = lattice.colors_from_levels(lattice.levels_from_colors(colors)).astype(int)
    # Each of R, G, B is off by at most the errors of Y and both chroma differences.
    assert (abs(result - colors) <= sum(lattice.steps) / 2 + 2).all()


@given(lattices())
def test_every_level_within_bounds_is_a_color(lattice: ColorLattice) -> None:
    for levels in lattice.level_bounds():
        colors = lattice.colors_from_levels(levels[None])
        assert colors.dtype == (np.uint8 if lattice.depth == 8 else np.uint16)
        assert colors.max() <= lattice.max_sample
        assert colors.shape == (1, lattice.n_components)


def test_the_transform_is_that_of_the_reference() -> None:
    # Malvar and Sullivan 2003, equation (6), worked by hand for R, G, B = 200, 100, 51.
    levels = ColorLattice((1, 1, 1)).levels_from_colors([[200, 100, 51]])
    orange = 200 - 51
    middle = 51 + orange // 2
    green = 100 - middle
    assert levels.tolist() == [[middle + green // 2, orange, green]]


@pytest.mark.parametrize(
    ("n_components", "step", "steps"),
    [
        (1, 8, (8,)),
        (3, 1, (1, 1, 1)),
        (3, 8, (8, 12, 10)),
        (4, 8, (8, 12, 10, 8)),
        (4, 1, (1, 1, 1, 1)),
        (3, 255, (255, 255, 255)),
    ],
)
def test_uniform_steps(n_components: int, step: int, steps: tuple[int, ...]) -> None:
    assert ColorLattice.uniform(n_components, step).steps == steps


@pytest.mark.parametrize("steps", [(), (1, 1), (1,) * 5, (0,), (256,), (1, 0, 1), (1, 1, 1, -3)])
def test_steps_out_of_range_are_refused(steps: tuple[int, ...]) -> None:
    with pytest.raises(ValueError, match="expected"):
        ColorLattice(steps)


@pytest.mark.parametrize("depth", [7, 17])
def test_depths_out_of_range_are_refused(depth: int) -> None:
    with pytest.raises(ValueError, match="8 to 16 bits"):
        ColorLattice((1,), depth)


@pytest.mark.parametrize("shape", [(3,), (2, 4), (2, 2, 3)])
def test_colors_of_another_shape_are_refused(shape: tuple[int, ...]) -> None:
    with pytest.raises(ValueError, match="shape"):
        ColorLattice((1, 1, 1)).levels_from_colors(np.zeros(shape, dtype=np.uint8))
