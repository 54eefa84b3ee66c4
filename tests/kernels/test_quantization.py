"""Coordinate descent on colour levels against recomputation from scratch."""

from __future__ import annotations

from itertools import product
from math import log2, sqrt
from typing import NamedTuple

import numpy as np
import pytest

from tests import twins
from tests.surfaces import scattered
from vmesh.arrays import Float64Array, Int32Array, Int64Array
from vmesh.codec.hierarchy import Hierarchy, build_hierarchy
from vmesh.kernels.delaunay import delaunay
from vmesh.kernels.quantization import N_SPREADS, TABLE_SIZE, descend, predict

LUMA_CHROMA = np.array([[1.0, 1.0, 1.0], [0.5, 0.0, -0.5], [-0.5, 0.5, -0.5]])


class Problem(NamedTuple):
    """Levels to choose: a hierarchy, a picture's values at each pixel, bits, steps and bounds."""

    hierarchy: Hierarchy
    matrix: Float64Array  # (pixels, n): barycentric weights
    values: Float64Array  # (pixels, c): what the samples should be
    table: Float64Array
    steps: Float64Array
    lowest: Int32Array
    highest: Int32Array
    levels: Int64Array


def make_problem(n: int, n_components: int, seed: int, step: int = 17) -> Problem:
    """A random picture on scattered vertices, and levels near those that fit it."""
    random = np.random.default_rng(seed)
    vertices = scattered(30, 26, n, seed)
    triangles = delaunay(vertices)
    matrix = twins.barycentric_matrix(vertices.astype(np.int64) * 128, triangles, 26, 30)
    steps = np.diag(np.full(n_components, float(step)))
    if n_components == 3:
        steps = steps @ LUMA_CHROMA
    highest = np.full(n_components, -(-255 // step), dtype=np.int32)
    lowest = np.where(np.arange(n_components) == 0, 0, -highest).astype(np.int32)
    levels = random.integers(lowest, highest, (len(vertices), n_components), endpoint=True)
    values = matrix @ (levels @ steps) + random.normal(0, 15, (len(matrix), n_components))
    # Rising, and less and less.
    rise = np.sort(random.uniform(0, 0.4, (n_components, N_SPREADS, TABLE_SIZE)), axis=2)
    table = np.cumsum(rise[:, :, ::-1], axis=2)
    hierarchy = build_hierarchy(vertices, triangles)
    return Problem(hierarchy, matrix, values, table, steps, lowest, highest, levels)


class Bookkeeping(NamedTuple):
    """What the descent reads and keeps up to date."""

    shares: Float64Array
    means: Float64Array
    spreads: Int64Array
    residual: Float64Array


def predictions(problem: Problem) -> tuple[Float64Array, Float64Array, Int64Array]:
    hierarchy, levels = problem.hierarchy, problem.levels
    shares = np.full((len(hierarchy.parents), levels.shape[1]), np.nan)
    means = np.full(levels.shape, np.nan)
    spreads = np.full(levels.shape, -1, dtype=np.int64)
    predict(*hierarchy, levels, shares, means, spreads)
    return shares, means, spreads


def start(problem: Problem) -> Bookkeeping:
    return Bookkeeping(*predictions(problem), residual_of(problem))


def residual_of(problem: Problem) -> Float64Array:
    """A'(y - A c) from scratch."""
    missing = problem.values - problem.matrix @ (problem.levels @ problem.steps)
    result: Float64Array = problem.matrix.T @ missing
    return result


def means_of(problem: Problem, shares: Float64Array) -> Float64Array:
    """Means of the parents from scratch, with shares as they were."""
    starts, parents = problem.hierarchy.starts, problem.hierarchy.parents
    means = np.zeros(problem.levels.shape)
    for place in range(len(starts) - 1):
        for j in range(starts[place], starts[place + 1]):
            means[place] += shares[j] * problem.levels[parents[j]]
    return means


def objective(problem: Problem, kept: Bookkeeping, lambda_: float) -> float:
    """Squared error + lambda * bits from scratch, with shares and spreads as they were."""
    missing = problem.values - problem.matrix @ (problem.levels @ problem.steps)
    distances = np.abs(problem.levels[problem.hierarchy.order] - means_of(problem, kept.shares))
    n_bits = 0.0
    for (place, z), distance in np.ndenumerate(distances):
        row = problem.table[z, kept.spreads[place, z]]
        low = min(int(distance), TABLE_SIZE - 2)
        n_bits += row[low] + (distance - low) * (row[low + 1] - row[low])
    return float((missing**2).sum()) + lambda_ * n_bits


def sweep(problem: Problem, kept: Bookkeeping, lambda_: float) -> int:
    """One sweep of the descent."""
    order, starts, parents = problem.hierarchy
    products = problem.matrix.T @ problem.matrix
    rows = [np.flatnonzero(row) for row in products]
    owners = np.repeat(np.arange(len(order)), np.diff(starts))
    entries = np.argsort(parents, kind="stable")
    n_components = problem.levels.shape[1]
    return descend(
        order,
        starts,
        np.searchsorted(parents[entries], np.arange(len(order) + 1)),
        owners[entries],
        entries,
        kept.shares,
        kept.means,
        kept.spreads,
        problem.table,
        np.cumsum([0, *map(len, rows)]).astype(np.int32),
        np.concatenate(rows).astype(np.int32),
        np.repeat(products[products != 0][:, None], n_components, axis=1),
        kept.residual,
        problem.steps,
        lambda_,
        255,
        problem.lowest,
        problem.highest,
        problem.levels,
    )


def settle(problem: Problem, kept: Bookkeeping, lambda_: float) -> None:
    """Sweeps until nothing changes any more."""
    for _ in range(50):
        if not sweep(problem, kept, lambda_):
            return
    raise AssertionError("the descent does not come to rest")


@pytest.mark.parametrize("n_components", [1, 3, 4])
@pytest.mark.parametrize("seed", range(3))
def test_means_and_spreads_are_those_of_the_parents(n_components: int, seed: int) -> None:
    problem = make_problem(20, n_components, seed)
    order, starts, parents = problem.hierarchy
    shares, means, spreads = predictions(problem)
    for place, v in enumerate(order.tolist()):
        own = parents[starts[place] : starts[place + 1]]
        for z in range(n_components):
            if not len(own):
                assert (means[place, z], spreads[place, z]) == (0, N_SPREADS - 1)
                continue
            # Chroma leans on the parents whose luma is alike.
            apart = np.abs(problem.levels[own, 0] - problem.levels[v, 0])
            weights = 1 / (1 + 2 * apart) if z else np.ones(len(own))
            mean = np.average(problem.levels[own, z], weights=weights)
            deviation = sqrt(np.average((problem.levels[own, z] - mean) ** 2, weights=weights))
            spread = min(N_SPREADS - 2, int(2 * log2(1 + 4 * deviation) + 1e-9))
            assert means[place, z] == pytest.approx(mean)
            assert spreads[place, z] == spread
            used = shares[starts[place] : starts[place + 1], z]
            assert used == pytest.approx(weights / weights.sum())


@pytest.mark.parametrize("lambda_", [0.0, 30.0, 1000.0, 1e5])
@pytest.mark.parametrize("n_components", [1, 3, 4])
@pytest.mark.parametrize("seed", range(2))
def test_the_books_are_those_of_counting_anew_and_the_objective_never_rises(
    n_components: int, lambda_: float, seed: int
) -> None:
    problem = make_problem(20, n_components, seed)
    kept = start(problem)
    before = objective(problem, kept, lambda_)
    for _ in range(30):
        levels = problem.levels.copy()
        changed = sweep(problem, kept, lambda_)
        assert changed == np.count_nonzero(problem.levels != levels)
        assert kept.means == pytest.approx(means_of(problem, kept.shares))
        assert kept.residual == pytest.approx(residual_of(problem), abs=1e-6)
        assert (problem.levels >= problem.lowest).all()
        assert (problem.levels <= problem.highest).all()
        after = objective(problem, kept, lambda_)
        assert after <= before
        assert (after < before) == (changed > 0)
        before = after
        if not changed:
            break
    assert changed == 0


@pytest.mark.parametrize("lambda_", [0.0, 30.0, 1000.0])
@pytest.mark.parametrize("n_components", [1, 3])
@pytest.mark.parametrize("seed", range(3))
def test_the_descent_ends_where_no_single_change_helps(
    n_components: int, lambda_: float, seed: int
) -> None:
    problem = make_problem(4, n_components, seed)
    kept = start(problem)
    settle(problem, kept, lambda_)
    least = objective(problem, kept, lambda_)
    for v, z in np.ndindex(problem.levels.shape):
        level = problem.levels[v, z]
        for change in (-2, -1, 1, 2):
            if problem.lowest[z] <= level + change <= problem.highest[z]:
                problem.levels[v, z] = level + change
                assert objective(problem, kept, lambda_) >= least - 1e-6
        problem.levels[v, z] = level


@pytest.mark.parametrize("lambda_", [0.0, 30.0, 1000.0])
@pytest.mark.parametrize("seed", range(4))
def test_few_levels_end_near_the_least_that_there_is(lambda_: float, seed: int) -> None:
    problem = make_problem(0, 1, seed, step=51)
    free = [0, 3, 7]
    kept = start(problem)
    settle(problem, kept, lambda_)
    found = objective(problem, kept, lambda_)
    least = np.inf
    for choice in product(range(6), repeat=len(free)):
        problem.levels[free, 0] = choice
        least = min(least, objective(problem, kept, lambda_))
    assert found == pytest.approx(least)


def test_with_a_lambda_of_0_a_level_goes_to_where_the_error_is_least() -> None:
    problem = make_problem(10, 1, 0)
    problem.table[:] = 1e9 * np.random.default_rng(0).random(problem.table.shape)
    kept = start(problem)
    settle(problem, kept, 0.0)
    assert (residual_of(problem) ** 2).sum() < (kept.residual**2).sum() + 1e-6
    # Each level is within half a step of the best for it, unless its bound keeps it.
    curvature = (problem.matrix**2).sum(axis=0)
    away = residual_of(problem)[:, 0] / (17 * np.maximum(curvature, 1e-9))
    inside = (problem.levels[:, 0] > 0) & (problem.levels[:, 0] < problem.highest[0])
    assert (np.abs(away[inside & (curvature > 0)]) <= 0.5 + 1e-9).all()


def test_with_a_large_lambda_levels_follow_their_parents() -> None:
    problem = make_problem(20, 1, 0)
    kept = start(problem)
    settle(problem, kept, 1e6)
    distances = np.abs(problem.levels[problem.hierarchy.order] - kept.means)
    first = make_problem(20, 1, 0)
    before = np.abs(first.levels[first.hierarchy.order] - predictions(first)[1])
    assert distances[4:].sum() < 0.2 * before[4:].sum()
