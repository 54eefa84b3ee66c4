from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import correlate

from tests.pictures import checkerboard, constant, noise, step_edge
from vmesh.arrays import UInt8Array
from vmesh.kernels.sobel import sobel4

TEMPLATES = (
    [[-1, -2, -1], [0, 0, 0], [1, 2, 1]],
    [[-1, 0, 1], [-2, 0, 2], [-1, 0, 1]],
    [[2, 1, 0], [1, 0, -1], [0, -1, -2]],
    [[0, 1, 2], [-1, 0, 1], [-2, -1, 0]],
)


def response(plane: UInt8Array) -> list[list[int]]:
    rows: list[list[int]] = sobel4(np.pad(plane, 1, mode="edge")).tolist()
    return rows


@pytest.mark.parametrize(
    "plane",
    [
        noise(30, 41, 1)[:, :, 0],
        np.where(noise(30, 41, 1) > 127, 255, 0).astype(np.uint8)[:, :, 0],
        checkerboard(9, 12, 2),
        step_edge(8, 8)[:, :, 0].copy(),
        noise(1, 1, 1)[:, :, 0],
        noise(1, 9, 1)[:, :, 0],
        noise(9, 1, 1)[:, :, 0],
    ],
)
def test_the_response_is_the_largest_of_the_four_templates(plane: UInt8Array) -> None:
    wide = plane.astype(np.int64)
    expected = np.max(
        [abs(correlate(wide, np.array(t), mode="nearest")) for t in TEMPLATES], axis=0
    )
    assert response(plane) == expected.tolist()


def test_a_full_step_has_the_largest_response() -> None:
    assert max(response(step_edge(4, 4)[:, :, 0])[0]) == 1020


def test_a_constant_plane_has_no_response() -> None:
    assert response(constant(3, 4, 200)) == [[0] * 4] * 3
