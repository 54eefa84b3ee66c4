"""Colour levels, each as its difference from the mean of its parents (spec, section 7).

References
----------
X. Wu, N. Memon, "Context-based, adaptive, lossless image coding", IEEE Transactions on
Communications 45(4), 1997: contexts of how much a sample's neighbours vary. P. Elias, "Universal
codeword sets and representations of the integers", IEEE Transactions on Information Theory 21(2),
1975: the gamma code of large differences.
"""

from __future__ import annotations

import numpy as np

from vmesh.arrays import Int32Array, Int64Array, UInt8Array
from vmesh.kernels.coding.range_coder import (
    BAD_NUMBER,
    LIMIT,
    OK,
    POSITION,
    code_bit,
    even_model,
)
from vmesh.kernels.jit import inner_kernel, kernel, lean_kernel

# Classes of how far the levels of a vertex's parents are spread, by their variance in 1/1024; one
# more for the vertex without parents.
SPREADS = (11, 64, 214, 576, 1388, 3136, 6808, 14400, 29936, 61504, 125346, 254016)
N_SPREADS = 14
N_UNARY = 14
MAX_SIZE_LENGTH = 16  # of the bits of a size beyond that: differences of 16-bit chroma have 17
LARGEST_DEVIATION = 511
SIZE_CONTEXTS = N_UNARY + 2
COMPONENT_CONTEXTS = N_SPREADS * SIZE_CONTEXTS + 3

# Initial probabilities, in 1/32, the means of meshes of ten photographs, that the size of a
# difference is more than 0, more than 1, and more than each number from 2 on, for each spread; for
# the first component and for the others. They count as `LEVELS_SEEN` bits.
LEVEL_PRIORS = (
    (
        (20, 25, 23, 26, 27, 27, 28, 29, 30, 31, 31, 31, 31, 31),
        (19, 25, 19, 18, 21, 22, 24, 26, 29, 30, 30, 31, 31, 31),
        (18, 25, 20, 22, 20, 18, 19, 21, 24, 26, 28, 30, 31, 25),
    ),
    (
        (2, 1, 5, 12, 15, 19, 23, 26, 28, 29, 28, 25, 19, 5),
        (8, 5, 4, 3, 6, 11, 17, 23, 25, 28, 27, 22, 17, 10),
        (15, 10, 15, 13, 14, 13, 16, 18, 22, 24, 27, 27, 27, 6),
    ),
)
LEVELS_SEEN = 16


@kernel
def code_levels(
    coder: Int64Array,
    data: UInt8Array,
    model: Int64Array,
    order: Int32Array,
    starts: Int64Array,
    parents: Int32Array,
    levels: Int32Array,
    lowest: Int32Array,
    highest: Int32Array,
) -> int:
    """Code colour levels, each as its difference from the mean of its parents.

    All parents count equally in the first component; in the others a parent counts the more, the
    closer it is in the first. The context of a difference is the spread of the parents' levels.

    Parameters
    ----------
    model : ndarray
        Shape (c * COMPONENT_CONTEXTS, 2), int64.
    order, starts, parents : ndarray
        The hierarchy of the vertices; parents come before their children.
    levels : ndarray
        Shape (n, c), int32: taken or filled in.
    lowest, highest : ndarray
        Shape (c,), int32: range of each component's levels.

    Returns
    -------
    int
        OK or BAD_NUMBER.
    """
    n_parents = np.int64(0)
    for i in range(order.shape[0]):
        n_parents = max(n_parents, starts[i + 1] - starts[i])
    own, weights = np.empty(n_parents, np.int32), np.empty(n_parents, np.int64)
    for i in range(order.shape[0]):
        v, first, n_own = order[i], starts[i], starts[i + 1] - starts[i]
        for j in range(n_own):
            own[j] = parents[first + j]
            weights[j] = 4096
        for z in range(levels.shape[1]):
            if z == 1:  # the first component is known by now
                weigh(levels, v, own, n_own, weights)
            total, weight = np.int64(0), np.int64(0)
            for j in range(n_own):
                total += weights[j] * levels[own[j], z]
                weight += weights[j]
            prediction, spread, lean = np.int64(0), N_SPREADS - 1, 0
            if weight > 0:
                prediction = (2 * total + weight) // (2 * weight)
                # Whether the mean was rounded down or up by more than 3/20.
                rest = 20 * (total - prediction * weight)
                lean = 1 if rest > 3 * weight else (2 if rest < -3 * weight else 0)
                spread = spread_of(levels, z, own, n_own, weights, prediction)
            base = z * COMPONENT_CONTEXTS
            context = base + spread * SIZE_CONTEXTS
            error = levels[v, z] - prediction
            size = code_size(coder, data, model, context, abs(error))
            negative = 0
            if size > 0:
                sign_context = base + N_SPREADS * SIZE_CONTEXTS + lean
                negative = code_bit(coder, data, model, sign_context, 1 if error < 0 else 0)
            level = prediction - size if negative == 1 else prediction + size
            if coder[POSITION] > coder[LIMIT]:
                level = prediction
            elif size < 0 or level < lowest[z] or level > highest[z]:
                return BAD_NUMBER
            levels[v, z] = level
    return OK


@inner_kernel
def weigh(
    levels: Int32Array, v: int, parents: Int32Array, n_parents: int, weights: Int64Array
) -> None:
    """Fill in the weights of a vertex's parents by how much they differ in the first component."""
    for j in range(n_parents):
        difference = abs(levels[parents[j], 0] - levels[v, 0])
        weights[j] = max(4096 // (1 + 2 * difference), 1)


@inner_kernel
def spread_of(
    levels: Int32Array,
    z: int,
    parents: Int32Array,
    n_parents: int,
    weights: Int64Array,
    prediction: np.int64,
) -> int:
    """Class of the weighted variance of the parents' levels around their mean.

    From the prediction no level counts as further away than LARGEST_DEVIATION, which keeps the
    sums within 64 bits.
    """
    total, weight, squares = np.int64(0), np.int64(0), np.int64(0)
    for j in range(n_parents):
        deviation = np.int64(
            min(max(levels[parents[j], z] - prediction, -LARGEST_DEVIATION), LARGEST_DEVIATION)
        )
        total += weights[j] * deviation
        squares += weights[j] * deviation * deviation
        weight += weights[j]
    variance = 1024 * (squares * weight - total * total) // (weight * weight)
    spread = 0
    while spread < N_SPREADS - 2 and variance >= SPREADS[spread]:
        spread += 1
    return spread


@lean_kernel
def code_size(coder: Int64Array, data: UInt8Array, model: Int64Array, c: int, size: int) -> int:
    """Code the size of a difference: in unary up to N_UNARY, what is beyond by its gamma code.

    Uses SIZE_CONTEXTS contexts from c. Returns -1 if that is longer than MAX_SIZE_LENGTH.
    """
    coded = 0
    while coded < N_UNARY:
        if code_bit(coder, data, model, c + coded, 1 if size > coded else 0) == 0:
            return coded
        coded += 1
    rest = size - N_UNARY + 1
    length = 0
    while code_bit(coder, data, model, c + N_UNARY, 1 if rest >> (length + 1) > 0 else 0) == 1:
        length += 1
        if length > MAX_SIZE_LENGTH:
            return -1
    value = 1
    for i in range(length):
        bit = (rest >> (length - 1 - i)) & 1
        value = (value << 1) | code_bit(coder, data, model, c + N_UNARY + 1, bit)
    return N_UNARY - 1 + value


def initial_level_model(n_components: int) -> Int64Array:
    """Initial model of the levels, shape (c * COMPONENT_CONTEXTS, 2), int64."""
    model = even_model(n_components * COMPONENT_CONTEXTS)
    for z in range(n_components):
        for spread in range(N_SPREADS):
            first = z * COMPONENT_CONTEXTS + spread * SIZE_CONTEXTS
            for i in range(N_UNARY):
                model[first + i, 0] = LEVEL_PRIORS[min(z, 1)][min(i, 2)][spread] << 11
                model[first + i, 1] = LEVELS_SEEN
    return model
