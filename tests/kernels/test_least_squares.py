from __future__ import annotations

import numpy as np
import pytest

from vmesh.arrays import Float64Array, Int32Array
from vmesh.kernels.least_squares import multiply, solve


def random_system(
    n_vertices: int, n_triangles: int, seed: int
) -> tuple[Int32Array, Float64Array, Float64Array]:
    """Triangles, their positive semidefinite blocks, and the dense sum of the blocks."""
    random = np.random.default_rng(seed)
    triangles = np.array(
        [random.choice(n_vertices, 3, replace=False) for _ in range(n_triangles)], dtype=np.int32
    )
    products = np.empty((n_triangles, 6))
    dense = np.zeros((n_vertices, n_vertices))
    for t, face in enumerate(triangles):
        rows = random.random((5, 3))
        block = rows.T @ rows
        products[t] = block[[0, 1, 2, 0, 1, 2], [0, 1, 2, 1, 2, 0]]
        dense[np.ix_(face, face)] += block
    return triangles, products, dense


@pytest.mark.parametrize("seed", range(5))
def test_multiply_is_the_product_with_the_dense_matrix(seed: int) -> None:
    triangles, products, dense = random_system(20, 30, seed)
    vector = np.random.default_rng(seed).normal(size=20)
    result = np.empty(20)
    multiply(triangles, products, 0.25, vector, result)
    assert np.allclose(result, (dense + 0.25 * np.eye(20)) @ vector)


@pytest.mark.parametrize("n_components", [1, 3, 4])
@pytest.mark.parametrize("seed", range(3))
def test_the_solution_is_that_of_numpy(n_components: int, seed: int) -> None:
    triangles, products, dense = random_system(25, 40, seed)
    random = np.random.default_rng(seed)
    moments, start = random.normal(size=(2, 25, n_components))
    expected = np.linalg.solve(dense + 0.01 * np.eye(25), moments + 0.01 * start)
    solution = solve(triangles, products, moments, 0.01, start, 1e-12, 500)
    assert np.allclose(solution, expected, rtol=1e-6, atol=1e-6)


def test_a_vertex_of_no_triangle_stays_where_it_starts() -> None:
    triangles, products, _ = random_system(10, 20, 1)
    start = np.random.default_rng(2).normal(size=(11, 3))
    moments = np.zeros((11, 3))
    solution = solve(triangles, products, moments, 0.01, start, 1e-9, 100)
    assert np.array_equal(solution[10], start[10])


def test_the_number_of_steps_is_bounded_and_the_start_kept() -> None:
    triangles, products, _ = random_system(10, 20, 1)
    moments, start = np.random.default_rng(2).normal(size=(2, 10, 3))
    before = start.copy()
    assert np.array_equal(solve(triangles, products, moments, 0.01, start, 1e-9, 0), before)
    solve(triangles, products, moments, 0.01, start, 1e-9, 5)
    assert np.array_equal(start, before)


def test_a_solution_as_the_start_is_returned_as_it_is() -> None:
    triangles = np.array([[0, 1, 2]], dtype=np.int32)
    products, moments = np.zeros((1, 6)), np.zeros((3, 1))
    start = np.array([[1.0], [2.0], [3.0]])
    assert np.array_equal(solve(triangles, products, moments, 0.5, start, 1e-3, 10), start)
