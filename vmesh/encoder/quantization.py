"""Colour levels of a mesh, by rate-distortion optimised quantisation."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
from scipy.sparse import coo_array

from vmesh.arrays import Float64Array, Int32Array, Int64Array
from vmesh.codec.hierarchy import Hierarchy
from vmesh.color_lattice import ColorLattice
from vmesh.encoder.colors import NormalEquations
from vmesh.kernels.quantization import N_SPREADS, TABLE_SIZE, descend, predict

_MAX_SWEEPS: Final = 8
_SETTLED: Final = 0.002  # share of levels whose change is not worth another sweep
# Weight, in levels, of the distribution that is assumed before any level was seen.
_PRIOR: Final = 8.0


def quantize(
    equations: list[NormalEquations],
    colors: Float64Array,
    hierarchy: Hierarchy,
    lattice: ColorLattice,
    lambda_: float,
) -> Int32Array:
    """Levels that make squared error + lambda * bits small.

    Parameters
    ----------
    equations : list of NormalEquations
        The squared error as a function of the colours, for each sample component.
    colors : ndarray
        Shape (n, c), float64: the fitted colours.
    hierarchy : Hierarchy
        The order in which a file holds the levels.
    lattice : ColorLattice
    lambda_ : float
        Squared error that a bit is worth; 0 looks at the error alone.

    Returns
    -------
    ndarray
        Shape (n, c), int32.
    """
    lowest, highest = lattice.level_bounds()
    steps = _level_steps(lattice)
    levels = np.rint(np.linalg.solve(steps.T, colors.T).T).astype(np.int64)
    levels = np.clip(levels, lowest, highest)
    form = _quadratic_form(equations, len(colors))
    children = _children(hierarchy)
    n_components = lattice.n_components
    shares = np.zeros((len(hierarchy.parents), n_components))
    means = np.zeros((len(colors), n_components))
    spreads = np.zeros((len(colors), n_components), dtype=np.int64)
    for _ in range(_MAX_SWEEPS):
        predict(*hierarchy, levels, shares, means, spreads)
        table = _bit_table(levels[hierarchy.order], means, spreads)
        # Luma, grey and alpha are cut off at the largest sample.
        shown = levels.astype(np.float64)
        for z in (0, 3)[: 2 if n_components == 4 else 1]:
            shown[:, z] = np.minimum(shown[:, z], lattice.max_sample / lattice.steps[z])
        residual = _residual(equations, form, shown @ steps)
        changed = descend(
            hierarchy.order,
            hierarchy.starts,
            *children,
            shares,
            means,
            spreads,
            table,
            form.starts,
            form.columns,
            form.products,
            residual,
            steps,
            lambda_,
            lattice.max_sample,
            lowest,
            highest,
            levels,
        )
        if changed <= _SETTLED * levels.size:
            break
    result: Int32Array = levels.astype(np.int32)
    return result


class _Form(NamedTuple):
    """Rows of a sparse matrix for each sample component, on one pattern."""

    starts: Int32Array
    columns: Int32Array
    products: Float64Array


class _Children(NamedTuple):
    """Children of each vertex: their places in the order and their entries in the parents."""

    starts: Int64Array
    places: Int64Array
    entries: Int64Array


def _level_steps(lattice: ColorLattice) -> Float64Array:
    """Change of the samples, rounding apart, with the level of each component, (c, c)."""
    steps = np.diag(np.asarray(lattice.steps, dtype=np.float64))
    if lattice.n_components >= 3:
        luma_chroma = np.array([[1.0, 1.0, 1.0], [0.5, 0.0, -0.5], [-0.5, 0.5, -0.5]])
        steps[:3, :3] = steps[:3, :3] @ luma_chroma
    return steps


def _quadratic_form(equations: list[NormalEquations], n_vertices: int) -> _Form:
    """The sum of the triangles' blocks as sparse rows."""
    triangles = equations[0].triangles
    rows = triangles[:, [0, 1, 2, 0, 1, 2, 1, 2, 0]].ravel()
    columns = triangles[:, [0, 1, 2, 1, 2, 0, 0, 1, 2]].ravel()
    products = []
    for equation in equations:
        blocks = equation.products[:, [0, 1, 2, 3, 4, 5, 3, 4, 5]].ravel()
        matrix = coo_array((blocks, (rows, columns)), shape=(n_vertices, n_vertices)).tocsr()
        matrix.sort_indices()
        products.append(matrix.data)
    return _Form(
        matrix.indptr.astype(np.int32),
        matrix.indices.astype(np.int32),
        np.ascontiguousarray(np.stack(products, axis=1)),
    )


def _residual(equations: list[NormalEquations], form: _Form, colors: Float64Array) -> Float64Array:
    """A'(y - A c), shape (n, c)."""
    rows = np.repeat(np.arange(len(colors)), np.diff(form.starts))
    result = np.stack([equation.moments for equation in equations], axis=1)
    for z in range(result.shape[1]):
        product = form.products[:, z] * colors[form.columns, z]
        result[:, z] -= np.bincount(rows, weights=product, minlength=len(colors))
    return result


def _children(hierarchy: Hierarchy) -> _Children:
    """Children of each vertex of a hierarchy."""
    entries = np.argsort(hierarchy.parents, kind="stable")
    owners = np.repeat(np.arange(len(hierarchy.order)), np.diff(hierarchy.starts))
    starts = np.searchsorted(hierarchy.parents[entries], np.arange(len(hierarchy.order) + 1))
    return _Children(starts, owners[entries], entries)


def _bit_table(levels: Int64Array, means: Float64Array, spreads: Int64Array) -> Float64Array:
    """Bits of each distance from the mean by component and spread, as adaptive coding finds them.

    The shape is (c, N_SPREADS, TABLE_SIZE). Distances that were not seen are filled in from a
    geometric distribution, and no distance costs less than a shorter one.
    """
    n_components = levels.shape[1]
    distances = np.minimum(np.abs(np.floor(levels - means + 0.5)), TABLE_SIZE - 1).astype(np.int64)
    scale = 0.25 * (2.0 ** (0.5 * np.arange(N_SPREADS)) - 1.0) + 0.4
    prior = np.exp(-np.arange(TABLE_SIZE) / scale[:, None]) / scale[:, None]
    counts = np.repeat((_PRIOR * prior + 0.02)[None], n_components, axis=0)
    components = np.broadcast_to(np.arange(n_components), levels.shape)
    np.add.at(counts, (components, spreads, distances), 1.0)
    table = -np.log2(counts / counts.sum(axis=2, keepdims=True))
    table[:, :, 1:] += 1.0  # the sign
    result: Float64Array = np.maximum.accumulate(table, axis=2)
    return result
