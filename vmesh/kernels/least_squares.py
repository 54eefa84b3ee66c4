"""Conjugate gradients on the normal equations of a triangle mesh, matrix-free and ordered.

The matrix is the sum of a 3 x 3 block per triangle, as in the mass matrix of linear finite
elements; scaled by its diagonal (the Jacobi preconditioner) it is so well conditioned that some
twenty steps suffice. Own code rather than a library's, because sums run in a fixed order: the
result does not depend on the number of threads of an underlying linear-algebra library.

References
----------
M. R. Hestenes, E. Stiefel, "Methods of conjugate gradients for solving linear systems", Journal of
Research of the National Bureau of Standards 49(6), 1952.
"""

from __future__ import annotations

import numpy as np

from vmesh.arrays import Float64Array, Int32Array
from vmesh.kernels.jit import kernel


@kernel
def multiply(
    triangles: Int32Array,
    products: Float64Array,
    ridge: float,
    vector: Float64Array,
    result: Float64Array,
) -> None:
    """Set `result` to (sum of the triangles' blocks + ridge I) times `vector`, both (n,)."""
    for v in range(vector.shape[0]):
        result[v] = ridge * vector[v]
    for t in range(triangles.shape[0]):
        i, j, k = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        x, y, z = vector[i], vector[j], vector[k]
        result[i] += products[t, 0] * x + products[t, 3] * y + products[t, 5] * z
        result[j] += products[t, 3] * x + products[t, 1] * y + products[t, 4] * z
        result[k] += products[t, 5] * x + products[t, 4] * y + products[t, 2] * z


@kernel
def solve(
    triangles: Int32Array,
    products: Float64Array,
    moments: Float64Array,
    ridge: float,
    start: Float64Array,
    tolerance: float,
    max_steps: int,
) -> Float64Array:
    """Minimiser of the squared error plus ``ridge * |x - start|**2``, for every component.

    Parameters
    ----------
    triangles : ndarray
        Shape (m, 3), int32.
    products : ndarray
        Shape (m, 6), float64: the blocks' entries 00, 11, 22, 01, 12, 20.
    moments : ndarray
        Shape (n, c), float64: the right-hand sides.
    ridge : float
        Weight that keeps vertices without pixels at `start` (Tikhonov regularisation).
    start : ndarray
        Shape (n, c), float64: where the iteration starts too.
    tolerance : float
        Residual relative to the first at which to stop, in the diagonally scaled norm.
    max_steps : int
        Bound on the steps.

    Returns
    -------
    ndarray
        Shape (n, c), float64.
    """
    n_vertices, n_components = moments.shape
    inverse = np.empty(n_vertices)
    x = np.empty(n_vertices)
    image = np.empty(n_vertices)
    residual = np.empty(n_vertices)
    direction = np.empty(n_vertices)
    solution = np.empty((n_vertices, n_components))
    for v in range(n_vertices):
        inverse[v] = ridge
    for t in range(triangles.shape[0]):
        for corner in range(3):
            inverse[triangles[t, corner]] += products[t, corner]
    for v in range(n_vertices):
        inverse[v] = 1.0 / inverse[v]
    for z in range(n_components):
        for v in range(n_vertices):
            x[v] = start[v, z]
        multiply(triangles, products, ridge, x, image)
        rho = 0.0
        for v in range(n_vertices):
            residual[v] = moments[v, z] + ridge * x[v] - image[v]
            direction[v] = inverse[v] * residual[v]
            rho += residual[v] * direction[v]
        goal = rho * tolerance * tolerance
        for _ in range(max_steps):
            if rho <= goal:
                break
            multiply(triangles, products, ridge, direction, image)
            curvature = 0.0
            for v in range(n_vertices):
                curvature += direction[v] * image[v]
            alpha = rho / curvature
            previous = rho
            rho = 0.0
            for v in range(n_vertices):
                x[v] += alpha * direction[v]
                residual[v] -= alpha * image[v]
                rho += residual[v] * residual[v] * inverse[v]
            beta = rho / previous
            for v in range(n_vertices):
                direction[v] = inverse[v] * residual[v] + beta * direction[v]
        for v in range(n_vertices):
            solution[v, z] = x[v]
    return solution
