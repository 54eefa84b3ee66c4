"""Colour levels by rate and distortion, through the encoder's interface."""

from __future__ import annotations

import numpy as np
import pytest

from tests.pictures import drawn, noise, psnr
from vmesh.arrays import Float64Array, Int32Array, UInt8Array
from vmesh.codec.writer import dumps
from vmesh.color_lattice import ColorLattice
from vmesh.encoder.colors import NormalEquations, fit_colors
from vmesh.encoder.image import weighted
from vmesh.encoder.pipeline import encode
from vmesh.encoder.proposals import propose
from vmesh.encoder.quantization import quantize
from vmesh.encoder.settings import Settings
from vmesh.encoder.tiles.code_order import code_order
from vmesh.kernels.delaunay import delaunay
from vmesh.mesh import Mesh


def fitted(
    image: UInt8Array, n: int
) -> tuple[Int32Array, Int32Array, Float64Array, list[NormalEquations]]:
    vertices = propose(weighted(image), Settings(vertices=n))[1].vertices()
    triangles = delaunay(vertices)
    return vertices, triangles, *fit_colors(weighted(image), vertices, triangles, 2)


def squared_error(equations: list[NormalEquations], samples: Float64Array) -> float:
    """Squared error of samples by the normal equations, but for a constant."""
    total = 0.0
    for z, equation in enumerate(equations):
        own = samples[equation.triangles, z]
        pairs = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)]
        for column, (i, j) in enumerate(pairs):
            twice = 1 if i == j else 2
            total += twice * float((equation.products[:, column] * own[:, i] * own[:, j]).sum())
        total -= 2 * float(equation.moments @ samples[:, z])
    return total


def samples_of(levels: Int32Array, lattice: ColorLattice) -> Float64Array:
    """Samples of levels without any rounding or clipping."""
    values: Float64Array = levels.astype(np.float64) * np.array(lattice.steps)
    if lattice.n_components >= 3:
        luma, orange, green = values[:, 0].copy(), values[:, 1].copy(), values[:, 2].copy()
        middle = luma - green / 2
        values[:, 0], values[:, 1] = middle + orange / 2, middle + green
        values[:, 2] = middle - orange / 2
    return values


@pytest.mark.parametrize("step", [1, 8, 30, 100])
@pytest.mark.parametrize("n_components", [1, 3, 4])
def test_with_a_lambda_of_0_the_error_is_no_larger_than_that_of_rounding(
    n_components: int, step: int
) -> None:
    image = noise(30, 36, n_components)
    vertices, _, colors, equations = fitted(image, 80)
    lattice = ColorLattice.uniform(n_components, step)
    levels = quantize(equations, colors, code_order(vertices, None, 2), lattice, 0.0)
    rounded = lattice.levels_from_colors(np.rint(colors))
    lowest, highest = lattice.level_bounds()
    assert levels.dtype == np.int32
    assert ((levels >= lowest) & (levels <= highest)).all()
    found, plain = (
        squared_error(equations, samples_of(each, lattice)) for each in (levels, rounded)
    )
    assert found <= plain
    assert squared_error(equations, colors) <= found


@pytest.mark.parametrize("n_components", [1, 3])
def test_a_larger_lambda_takes_fewer_bytes_and_leaves_more_error(
    coffee: UInt8Array, n_components: int
) -> None:
    image = np.ascontiguousarray(coffee[100:180, 150:250, :n_components])
    vertices, triangles, colors, equations = fitted(image, 300)
    lattice = ColorLattice.uniform(n_components, 8)
    sizes, reached = [], []
    for lambda_ in (0.0, 100.0, 1000.0, 10_000.0, 1e6):
        levels = quantize(equations, colors, code_order(vertices, None, 2), lattice, lambda_)
        mesh = Mesh(100, 80, vertices, triangles, levels, lattice, subdivision=1)
        sizes.append(len(dumps(mesh)))
        reached.append(psnr(drawn(mesh), image))
    assert sizes == sorted(sizes, reverse=True)
    assert reached == sorted(reached, reverse=True)
    assert sizes[-1] < 0.9 * sizes[0]


def test_a_fair_lambda_is_better_than_a_coarser_step(cup: UInt8Array) -> None:
    vertices, triangles, colors, equations = fitted(cup, 300)

    def size_and_psnr(step: int, lambda_: float) -> tuple[int, float]:
        lattice = ColorLattice.uniform(3, step)
        levels = quantize(equations, colors, code_order(vertices, None, 2), lattice, lambda_)
        mesh = Mesh(100, 80, vertices, triangles, levels, lattice, subdivision=1)
        return len(dumps(mesh)), psnr(drawn(mesh), cup)

    size, reached = size_and_psnr(8, 1500.0)
    for step in range(8, 40, 2):
        other_size, other = size_and_psnr(step, 0.0)
        assert other_size > size or other < reached


@pytest.fixture(scope="module")
def cup(coffee: UInt8Array) -> UInt8Array:
    return np.ascontiguousarray(coffee[100:180, 150:250])


@pytest.mark.parametrize("step", [None, 7, 20, 34, 60])
def test_black_and_white_stay_what_they_are(step: int | None) -> None:
    picture = np.full((40, 60, 3), 255, dtype=np.uint8)
    picture[10:30, 10:30] = 0
    result = drawn(encode(picture, vertices=40, color_step=step))
    assert (result[34:] >= 254).all()
    assert (result[15:25, 15:25] <= 1).all()


@pytest.mark.parametrize("effort", [1, 5])
@pytest.mark.parametrize("step", [None, 20, 34])
def test_an_opaque_picture_stays_opaque(cup: UInt8Array, effort: int, step: int | None) -> None:
    opaque = np.dstack([cup, np.full(cup.shape[:2], 255, dtype=np.uint8)])
    mesh = encode(opaque, vertices=100, effort=effort, color_step=step)
    assert (drawn(mesh)[:, :, 3] == 255).all()
