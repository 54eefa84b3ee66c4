from __future__ import annotations

from typing import Any

import pytest

from vmesh.encoder.settings import Settings


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
        {"vertices": 100, "density": 0.1},
        {"color_step": 0},
        {"color_step": 256},
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
        {"color_step": 1},
        {"color_step": 255},
        {"seed": 2**31},
        {"sampler": "channels", "diffusion": "ostromoukhov", "colors": "sampled"},
    ],
)
def test_a_setting_at_the_end_of_its_range_is_taken(setting: dict[str, Any]) -> None:
    for name, value in setting.items():
        assert getattr(Settings(**setting), name) == value


def test_an_unknown_setting_is_refused() -> None:
    with pytest.raises(TypeError, match="quality"):
        Settings(quality=3)  # type: ignore[call-arg]


def test_the_number_of_points_follows_from_vertices_or_density() -> None:
    assert Settings().n_points(100, 50) is None
    assert Settings(vertices=77).n_points(100, 50) == 77
    assert Settings(density=0.02).n_points(100, 50) == 100
    assert Settings(density=0.02).n_points(2, 2) == 4


def test_thinning_starts_from_a_quarter_of_the_pixels_or_from_what_is_wanted() -> None:
    assert Settings(method="adaptive").n_vertices(100, 50) == 100
    assert Settings(method="adaptive").n_points(100, 50) == 1250
    assert Settings(method="adaptive", vertices=77).n_vertices(100, 50) == 77
    assert Settings(method="adaptive", vertices=3000).n_points(100, 50) == 3000
