"""An adaptive binary range coder, with the carry handled by the encoder alone (spec, section 5).

::

    range               2**32 at first, kept at 2**24 or more by shifting bytes out
    model[c] = p, n     of context c: probability of a 1 in units of 2**-16, bits seen
    split               (range >> 12) * (p >> 4): the part of the range that stands for a 1
    after a bit         p += (65536 * bit - p) // (n + 2), n counted up to RATE_LIMIT

References
----------
G. N. N. Martin, "Range encoding: an algorithm for removing redundancy from a digitised message",
Video and Data Recording Conference, 1979. The byte-wise carry is that of I. Pavlov's LZMA.
"""

from __future__ import annotations

import numpy as np

from vmesh.arrays import Int64Array, UInt8Array
from vmesh.kernels.jit import inner_kernel, kernel, lean_kernel

# Fields of the coder's state, an int64 array of N_FIELDS.
DECODING = 0  # 1 when reading, 0 when writing
POSITION = 1  # bytes read or written; counts on beyond the end of the data
RANGE = 2
LOW = 3  # writing: low end of the range, 33 bits; reading: the code minus it
CACHE = 4  # writing: the byte that a carry may still raise
PENDING = 5  # writing: bytes 0xFF after it that a carry would turn to 0
LIMIT = 6  # reading: numbers that take more bytes than this are left as predicted
N_FIELDS = 7

RATE_LIMIT = 250
TOP = 1 << 24
MASK = 0xFFFFFFFF

OK = 0
BAD_NUMBER = 1  # a coded number lies outside its range


@inner_kernel
def write_byte(coder: Int64Array, data: UInt8Array, byte: int) -> None:
    """Append a byte; beyond the end of `data` only the position advances."""
    if coder[POSITION] < data.shape[0]:
        data[coder[POSITION]] = np.uint8(byte)
    coder[POSITION] += 1


@inner_kernel
def read_byte(coder: Int64Array, data: UInt8Array) -> np.int64:
    """Next byte of the stream; zeros beyond its end."""
    position = coder[POSITION]
    coder[POSITION] = position + 1
    return np.int64(data[position]) if position < data.shape[0] else np.int64(0)


@inner_kernel
def shift_low(coder: Int64Array, data: UInt8Array) -> None:
    """Move the top byte of the low end out, passing on a carry."""
    low = coder[LOW]
    if low < 0xFF000000 or low > MASK:
        carry = low >> 32
        if coder[CACHE] >= 0:
            write_byte(coder, data, (coder[CACHE] + carry) & 0xFF)
        for _ in range(coder[PENDING]):
            write_byte(coder, data, (0xFF + carry) & 0xFF)
        coder[PENDING] = 0
        coder[CACHE] = (low >> 24) & 0xFF
    else:
        coder[PENDING] += 1
    coder[LOW] = (low << 8) & MASK


@kernel
def start(coder: Int64Array, data: UInt8Array, decoding: int) -> None:
    """Begin to write into, or to read from, `data`."""
    coder[:] = 0
    coder[DECODING] = decoding
    coder[RANGE] = MASK + 1
    coder[CACHE] = -1
    coder[LIMIT] = 1 << 62
    if decoding:
        for _ in range(4):
            coder[LOW] = (coder[LOW] << 8) | read_byte(coder, data)


@kernel
def finish(coder: Int64Array, data: UInt8Array) -> int:
    """Write what is left; returns the length without the zeros that the reader supplies."""
    # The number within the range that ends in the most zero bits.
    for zeros in range(32, -1, -1):
        value = ((coder[LOW] + (1 << zeros) - 1) >> zeros) << zeros
        if value < coder[LOW] + coder[RANGE]:
            coder[LOW] = value
            break
    for _ in range(5):
        shift_low(coder, data)
    length: int = min(coder[POSITION], data.shape[0])
    while length > 0 and data[length - 1] == 0:
        length -= 1
    return length


@lean_kernel
def code_bit(coder: Int64Array, data: UInt8Array, model: Int64Array, c: int, bit: int) -> int:
    """Write `bit`, or read one and return it, by the model in context c, and adapt it."""
    p, n = model[c, 0], model[c, 1]
    split = (coder[RANGE] >> 12) * (p >> 4)
    if coder[DECODING] == 1:
        bit = 1 if coder[LOW] < split else 0
        if bit == 0:
            coder[LOW] -= split
    elif bit == 0:
        coder[LOW] += split
    coder[RANGE] = split if bit == 1 else coder[RANGE] - split
    # p stays within 64 .. 65536 - 64, so that both parts keep a share.
    model[c, 0] = min(max(p + (bit * 65536 - p) // (n + 2), 64), 65472)
    if n < RATE_LIMIT:
        model[c, 1] = n + 1
    while coder[RANGE] < TOP:
        coder[RANGE] <<= 8
        if coder[DECODING] == 1:
            coder[LOW] = (coder[LOW] << 8) | read_byte(coder, data)
        else:
            shift_low(coder, data)
    return bit


def even_model(n_contexts: int) -> Int64Array:
    """Model of some contexts, in each of which a 0 is as probable as a 1, shape (n, 2), int64."""
    model = np.zeros((n_contexts, 2), dtype=np.int64)
    model[:, 0] = 1 << 15
    return model
