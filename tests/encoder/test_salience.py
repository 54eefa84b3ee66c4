from __future__ import annotations

import numpy as np
import pytest

from tests.pictures import grey_ramp, noise, step_edge
from vmesh.encoder.salience import ONE, compute_salience


def test_the_largest_response_of_each_plane_has_full_salience() -> None:
    planes = np.stack([noise(20, 20, 1)[:, :, 0], grey_ramp(20, 20), step_edge(20, 20)[:, :, 0]])
    assert compute_salience(planes).max(axis=(1, 2)).tolist() == [ONE, ONE, ONE]


def test_a_constant_plane_has_none() -> None:
    planes = np.stack([np.full((5, 7), 200, np.uint8), noise(5, 7, 1)[:, :, 0]])
    assert compute_salience(planes, 0.1)[0].max() == 0


def test_a_step_is_salient_on_both_of_its_sides_only() -> None:
    salience = compute_salience(step_edge(6, 10)[None, :, :, 0])
    assert np.flatnonzero(salience[0, 3]).tolist() == [4, 5]


@pytest.mark.parametrize("gamma", [0.25, 0.5, 1.0, 2.0])
def test_salience_is_the_share_of_the_largest_response_to_the_power_of_gamma(
    gamma: float,
) -> None:
    planes = noise(16, 16, 1)[None, :, :, 0]
    plain = compute_salience(planes) / ONE
    assert compute_salience(planes, gamma) / ONE == pytest.approx(plain**gamma, abs=1e-4)


@pytest.mark.parametrize("gamma", [0.0, -1.0, float("nan")])
def test_a_gamma_that_is_not_above_zero_is_refused(gamma: float) -> None:
    with pytest.raises(ValueError, match="gamma above 0"):
        compute_salience(noise(4, 4).transpose(2, 0, 1).copy(), gamma)
