"""Lists of triangles, each by its differences from the one before (spec, section 8.3).

References
----------
P. Elias, "Universal codeword sets and representations of the integers", IEEE Transactions on
Information Theory 21(2), 1975: the gamma code, whose bits are coded here by adaptive contexts.
"""

from __future__ import annotations

from vmesh.arrays import Int32Array, Int64Array, UInt8Array
from vmesh.kernels.coding.range_coder import BAD_NUMBER, OK, code_bit
from vmesh.kernels.jit import kernel, lean_kernel

# A number's class is its bit length; contexts of one number model.
NUMBER_CONTEXTS = 32 + 32 * 4
MAX_LENGTH = 31


@lean_kernel
def code_number(coder: Int64Array, data: UInt8Array, model: Int64Array, c: int, number: int) -> int:
    """Code a number of 0 or more: the bit length of number + 1 in unary, then its lower bits.

    Uses NUMBER_CONTEXTS contexts from c. Returns -1 if the length is more than MAX_LENGTH.
    """
    length = 0
    while (number + 1) >> (length + 1) > 0:
        length += 1
    coded = 0
    while code_bit(coder, data, model, c + coded, 1 if coded < length else 0) == 1:
        coded += 1
        if coded > MAX_LENGTH:
            return -1
    value = 1
    for i in range(coded):
        # The two bits after the leading one have contexts of their own, the rest share one.
        context = c + 32 + coded * 4 + (value if i < 2 else 0)
        bit = ((number + 1) >> (coded - 1 - i)) & 1
        value = (value << 1) | code_bit(coder, data, model, context, bit)
    return value - 1


@kernel
def code_triangles(
    coder: Int64Array,
    data: UInt8Array,
    model: Int64Array,
    triangles: Int32Array,
    n_vertices: int,
) -> int:
    """Code a canonical list of triangles: each by its differences from the one before.

    Parameters
    ----------
    model : ndarray
        Shape (3 * NUMBER_CONTEXTS, 2), int64.
    triangles : ndarray
        Shape (m, 3), int32: lowest vertex first, in lexicographic order.

    Returns
    -------
    int
        OK or BAD_NUMBER.
    """
    first, before = 0, -1
    for t in range(triangles.shape[0]):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        step = code_number(coder, data, model, 0, a - first)
        if step < 0 or first + step >= n_vertices:
            return BAD_NUMBER
        first += step
        second = code_number(coder, data, model, NUMBER_CONTEXTS, b - first - 1)
        third = code_number(coder, data, model, 2 * NUMBER_CONTEXTS, c - first - 1)
        if second < 0 or third < 0:
            return BAD_NUMBER
        if first + 1 + second >= n_vertices or first + 1 + third >= n_vertices:
            return BAD_NUMBER
        if step == 0 and second <= before:
            return BAD_NUMBER
        before = second
        triangles[t, 0] = first
        triangles[t, 1] = first + 1 + second
        triangles[t, 2] = first + 1 + third
    return OK
