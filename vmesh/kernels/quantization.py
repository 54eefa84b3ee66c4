"""Rate-distortion optimised quantisation of colours: coordinate descent on a quadratic form.

The squared error of a rendered mesh is a quadratic function of the colours at its vertices, and the
bits of a level follow from its distance to the mean of its parents. One level is changed at a time,
by one or two, where that lowers error + lambda * bits::

    error(level + d) - error(level) = d g + d d h      g, h  from the residual A'(y - A c)
    bits                            = table[component, spread of the parents, |level - mean|]
                                      of the level itself and of each of its children

References
----------
K. Ramchandran, M. Vetterli, "Rate-distortion optimal fast thresholding with complete JPEG/MPEG
decoder compatibility", IEEE Transactions on Image Processing 3(5), 1994: levels chosen by both.
J. Besag, "On the statistical analysis of dirty pictures", Journal of the Royal Statistical Society
B 48(3), 1986: coordinate descent over integers, there iterated conditional modes.
"""

from __future__ import annotations

import math

import numpy as np

from vmesh.arrays import Float64Array, Int32Array, Int64Array
from vmesh.kernels.jit import inner_kernel, kernel

N_SPREADS = 14
TABLE_SIZE = 64


@kernel
def predict(
    order: Int32Array,
    starts: Int64Array,
    parents: Int32Array,
    levels: Int64Array,
    shares: Float64Array,
    means: Float64Array,
    spreads: Int64Array,
) -> None:
    """Mean and spread of the parents' levels, as the entropy coder sees them but not rounded.

    Parameters
    ----------
    order, starts, parents : ndarray
        The hierarchy, shapes (n,), (n + 1,), (p,).
    levels : ndarray
        Shape (n, c), int64, by vertex.
    shares : ndarray
        Shape (p, c), float64, written: share of each parent in the mean.
    means, spreads : ndarray
        Shapes (n, c), float64 and int64, written, by place in the order.
    """
    for i in range(order.shape[0]):
        v = order[i]
        for z in range(levels.shape[1]):
            weights, total, squares = 0.0, 0.0, 0.0
            for j in range(starts[i], starts[i + 1]):
                u = parents[j]
                weight = 1.0 / (1 + 2 * abs(levels[u, 0] - levels[v, 0])) if z > 0 else 1.0
                shares[j, z] = weight
                weights += weight
                total += weight * levels[u, z]
                squares += weight * levels[u, z] * levels[u, z]
            means[i, z] = 0.0
            spreads[i, z] = N_SPREADS - 1
            if weights > 0.0:
                means[i, z] = total / weights
                variance = max(squares / weights - means[i, z] * means[i, z], 0.0)
                spread = int(2.0 * math.log2(1.0 + 4.0 * math.sqrt(variance)))
                spreads[i, z] = min(spread, N_SPREADS - 2)
                for j in range(starts[i], starts[i + 1]):
                    shares[j, z] /= weights


@inner_kernel
def bits(table: Float64Array, z: int, spread: int, distance: float) -> float:
    """Bits of a level at a distance from the mean, between the entries of the table."""
    distance = abs(distance)
    low = min(int(distance), TABLE_SIZE - 2)
    rise = table[z, spread, low + 1] - table[z, spread, low]
    number: float = table[z, spread, low] + (distance - low) * rise
    return number


@kernel
def descend(
    order: Int32Array,
    starts: Int64Array,
    child_starts: Int64Array,
    child_places: Int64Array,
    child_entries: Int64Array,
    shares: Float64Array,
    means: Float64Array,
    spreads: Int64Array,
    table: Float64Array,
    row_starts: Int32Array,
    columns: Int32Array,
    products: Float64Array,
    residual: Float64Array,
    steps: Float64Array,
    lambda_: float,
    peak: int,
    lowest: Int32Array,
    highest: Int32Array,
    levels: Int64Array,
) -> int:
    """Number of levels that a sweep over all of them has changed, finest vertices first.

    Parameters
    ----------
    order, starts : ndarray
        The hierarchy.
    child_starts, child_places, child_entries : ndarray
        For each vertex the places of its children in the order, and its entries in `shares`.
    shares, means, spreads : ndarray
        As :func:`predict` gives them; `means` follow the changes.
    table : ndarray
        Shape (c, N_SPREADS, TABLE_SIZE), float64: bits.
    row_starts, columns : ndarray
        Rows of the quadratic form, shapes (n + 1,) and (k,), int32.
    products : ndarray
        Shape (k, c), float64: its entries, for each sample component.
    residual : ndarray
        Shape (n, c), float64: A'(y - A c) in samples; follows the changes.
    steps : ndarray
        Shape (c, c), float64: change of the samples with each component's level.
    lambda_ : float
        Squared error that a bit is worth.
    peak : int
        The largest sample.
    lowest, highest : ndarray
        Shape (c,), int32: bounds of the levels.
    levels : ndarray
        Shape (n, c), int64: changed.
    """
    n_components = levels.shape[1]
    changed = 0
    for place in range(order.shape[0] - 1, -1, -1):
        v = order[place]
        for z in range(n_components):
            slope, curvature = 0.0, 0.0
            for k in range(row_starts[v], row_starts[v + 1]):
                if columns[k] == v:
                    for q in range(n_components):
                        slope -= 2.0 * steps[z, q] * residual[v, q]
                        curvature += steps[z, q] * steps[z, q] * products[k, q]
            level = levels[v, z]
            # Luma, grey and alpha are cut off at the largest sample.
            top = peak / steps[z, z] if z in (0, 3) else np.inf
            own = level - means[place, z]
            own_bits = bits(table, z, spreads[place, z], own)
            best, least = 0, 0.0
            for i in range(4):
                change = (i // 2 + 1) * (1 if i % 2 == 0 else -1)
                if not lowest[z] <= level + change <= highest[z]:
                    continue
                moved = min(level + change, top) - min(level, top)
                cost = moved * slope + moved * moved * curvature
                # No change saves more bits than these in practice.
                if cost > 16.0 * lambda_:
                    continue
                more = bits(table, z, spreads[place, z], own + change) - own_bits
                for j in range(child_starts[v], child_starts[v + 1]):
                    child = child_places[j]
                    distance = levels[order[child], z] - means[child, z]
                    spread = spreads[child, z]
                    later = distance - shares[child_entries[j], z] * change
                    more += bits(table, z, spread, later) - bits(table, z, spread, distance)
                cost += lambda_ * more
                if cost < least:
                    best, least = change, cost
            if best == 0:
                continue
            changed += 1
            levels[v, z] = level + best
            moved = min(level + best, top) - min(level, top)
            for j in range(child_starts[v], child_starts[v + 1]):
                means[child_places[j], z] += shares[child_entries[j], z] * best
            for k in range(row_starts[v], row_starts[v + 1]):
                for q in range(n_components):
                    residual[columns[k], q] -= products[k, q] * steps[z, q] * moved
    return changed
