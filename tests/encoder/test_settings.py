from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np
import pytest

from vmesh.encoder.settings import DEFAULT_EFFORT, Settings


@pytest.mark.parametrize(
    "setting",
    [
        {"method": "red-noise"},
        {"sampler": "all"},
        {"diffusion": "floyd-steinberg"},
        {"colors": "best"},
        {"gamma": 0.0},
        {"gamma": -1.0},
        {"gamma": 10.5},
        {"gamma": float("nan")},
        {"gamma": float("inf")},
        {"vertices": 3},
        {"vertices": -100},
        {"density": 0.0},
        {"density": 1.01},
        {"density": float("nan")},
        {"quality": -1},
        {"quality": 101},
        {"target_size": 0},
        {"target_size": -5},
        {"target_psnr": 0.0},
        {"target_psnr": -3.0},
        {"target_psnr": 99.5},
        {"target_psnr": float("nan")},
        {"target_psnr": float("inf")},
        {"effort": 0},
        {"effort": 10},
        {"color_step": 0},
        {"color_step": 65_536},
        {"tile": 31},
        {"tile": 2049},
        {"seed": -1},
    ],
)
def test_a_setting_out_of_range_is_refused(setting: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match="expected") as caught:
        Settings(**setting)
    assert any(word in str(caught.value).replace("color step", "color_step") for word in setting)


@pytest.mark.parametrize(
    "setting",
    [
        {},
        {"gamma": 10.0},
        {"gamma": 1e-3},
        {"vertices": 4},
        {"density": 1.0},
        {"density": 1e-9},
        {"quality": 0},
        {"quality": 100},
        {"target_size": 1},
        {"target_psnr": 0.1},
        {"target_psnr": 99.0},
        {"effort": 1},
        {"effort": 9},
        {"color_step": 1},
        {"color_step": 65_535},
        {"tile": 32},
        {"tile": 2048},
        {"seed": 2**31},
        {"method": "blue-noise", "sampler": "channels", "diffusion": "ostromoukhov"},
        {"method": "blue-noise", "colors": "sampled"},
        {"method": "blue-noise", "vertices": 100},
        {"method": "blue-noise", "density": 0.5},
    ],
)
def test_a_setting_at_the_end_of_its_range_is_taken(setting: dict[str, Any]) -> None:
    for name, value in setting.items():
        assert getattr(Settings(**setting), name) == value


GOALS: dict[str, Any] = {
    "quality": 50,
    "target_size": 1000,
    "target_psnr": 30.0,
    "vertices": 100,
    "density": 0.1,
}


@pytest.mark.parametrize(("first", "second"), list(combinations(GOALS, 2)))
def test_two_goals_at_once_are_refused(first: str, second: str) -> None:
    with pytest.raises(ValueError, match=f"expected one of {first} and {second}, not both"):
        Settings(**{first: GOALS[first], second: GOALS[second]})


@pytest.mark.parametrize("goal", ["quality", "target_size", "target_psnr"])
def test_blue_noise_has_no_rate_control(goal: str) -> None:
    with pytest.raises(ValueError, match=f"expected method adaptive with {goal}, got blue-noise"):
        Settings(**{"method": "blue-noise", goal: GOALS[goal]})


def test_blue_noise_has_no_tiles() -> None:
    with pytest.raises(ValueError, match="expected method adaptive with tile, got blue-noise"):
        Settings(method="blue-noise", tile=512)


def test_the_adaptive_method_has_no_sampled_colors() -> None:
    with pytest.raises(ValueError, match="expected method blue-noise with sampled colors"):
        Settings(colors="sampled")


@pytest.mark.parametrize("name", ["quality", "target_size", "vertices", "effort", "tile", "seed"])
def test_a_fraction_is_no_whole_number(name: str) -> None:
    setting: dict[str, Any] = {name: 7.5}
    with pytest.raises(TypeError):
        Settings(**setting)


@pytest.mark.parametrize("name", ["quality", "target_size", "vertices", "effort", "tile", "seed"])
def test_whole_numbers_of_numpy_are_taken(name: str) -> None:
    setting: dict[str, Any] = {name: np.int64(40 if name == "tile" else 7)}
    assert type(getattr(Settings(**setting), name)) is int


def test_an_unknown_setting_is_refused() -> None:
    with pytest.raises(TypeError, match="speed"):
        Settings(speed=3)  # type: ignore[call-arg]


def test_the_adaptive_method_of_middle_effort_is_the_default() -> None:
    assert (Settings().method, Settings().effort) == ("adaptive", DEFAULT_EFFORT)
    assert all(getattr(Settings(), goal) is None for goal in GOALS)


def test_the_number_of_vertices_follows_from_vertices_or_density() -> None:
    assert Settings().n_vertices(100, 50) is None
    assert Settings(quality=3).n_vertices(100, 50) is None
    assert Settings(vertices=77).n_vertices(100, 50) == 77
    assert Settings(density=0.02).n_vertices(100, 50) == 100
    assert Settings(density=0.02).n_vertices(2, 2) == 4


def test_another_goal_takes_the_place_of_the_one_that_was_given() -> None:
    changed = Settings(quality=3, effort=2).with_goal(vertices=50)
    assert changed == Settings(vertices=50, effort=2)
