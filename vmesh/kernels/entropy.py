"""The entropy coder of a .vmesh file and the models of its three payloads (spec, sections 5 to 8).

One kernel per payload serves both directions: what it codes it either takes from its arrays and
writes, or reads and puts there, as ``coder[DECODING]`` says, so that the two cannot drift apart.

An adaptive binary range coder, with the carry handled by the encoder alone::

    range            2**32 at first, kept at 2**24 or more by shifting bytes out
    odds[c] = p, n   of context c: the probability of a 1 in units of 2**-16, times seen
    split            (range >> 12) * (p >> 4): the part of the range that stands for a 1
    after a bit      p += (65536 * bit - p) // (n + 2), n counted up to RATE_LIMIT

Every loop over a decoded number is bounded, and no index that depends on one is used unchecked:
these kernels read hostile files.

References
----------
G. N. N. Martin, "Range encoding", 1979; the byte-wise carry is that of I. Pavlov's LZMA.
"""

from __future__ import annotations

import numpy as np

from vmesh.arrays import Int32Array, Int64Array, UInt8Array
from vmesh.kernels.jit import kernel

# Fields of the coder's state, an int64 array of N_FIELDS.
DECODING = 0  # 1 when reading, 0 when writing
POSITION = 1  # bytes read or written; counts on beyond the end of the data
RANGE = 2
LOW = 3  # writing: low end of the range, 33 bits; reading: the code minus it
CACHE = 4  # writing: the byte that a carry may still raise
PENDING = 5  # writing: bytes 0xFF after it that a carry would turn to 0
N_FIELDS = 6

RATE_LIMIT = 62
TOP = 1 << 24
MASK = 0xFFFFFFFF

OK = 0
BAD_NUMBER = 1  # a coded number lies outside its range

# A number's class is its bit length; contexts of one number model.
NUMBER_CONTEXTS = 32 + 32 * 4
MAX_LENGTH = 31

N_AREA_CLASSES = 40  # a box halved once has at most 2**39 sites
N_SMALL = 8  # counts below this have a context of their own
N_LARGE = 24
SPLIT_CONTEXTS = N_AREA_CLASSES * N_SMALL * N_SMALL + N_LARGE * N_LARGE

N_SPREADS = 10
N_PEERS = 4
SIZE_CONTEXTS = 23
COMPONENT_CONTEXTS = N_SPREADS * N_PEERS * SIZE_CONTEXTS + N_PEERS


@kernel
def write_byte(coder: Int64Array, data: UInt8Array, byte: int) -> None:
    """Append a byte; beyond the room in `data` only the position advances."""
    if coder[POSITION] < data.shape[0]:
        data[coder[POSITION]] = np.uint8(byte)
    coder[POSITION] += 1


@kernel
def read_byte(coder: Int64Array, data: UInt8Array) -> np.int64:
    """Next byte of the payload; zeros beyond its end."""
    position = coder[POSITION]
    coder[POSITION] = position + 1
    return np.int64(data[position]) if position < data.shape[0] else np.int64(0)


@kernel
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
    if decoding:
        for _ in range(4):
            coder[LOW] = (coder[LOW] << 8) | read_byte(coder, data)


@kernel
def finish(coder: Int64Array, data: UInt8Array) -> int:
    """Write what is left and return the length; the reader supplies zeros that are cut off."""
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


@kernel
def code_bit(coder: Int64Array, data: UInt8Array, odds: Int64Array, c: int, bit: int) -> int:
    """Write `bit`, or read one and return it, by the odds of context c; adapt them."""
    p, n = odds[c, 0], odds[c, 1]
    split = (coder[RANGE] >> 12) * (p >> 4)
    if coder[DECODING] == 1:
        bit = 1 if coder[LOW] < split else 0
        if bit == 0:
            coder[LOW] -= split
    elif bit == 0:
        coder[LOW] += split
    coder[RANGE] = split if bit == 1 else coder[RANGE] - split
    # p stays within 64 .. 65536 - 64, so that both parts keep a share.
    odds[c, 0] = min(max(p + (bit * 65536 - p) // (n + 2), 64), 65472)
    if n < RATE_LIMIT:
        odds[c, 1] = n + 1
    while coder[RANGE] < TOP:
        coder[RANGE] <<= 8
        if coder[DECODING] == 1:
            coder[LOW] = (coder[LOW] << 8) | read_byte(coder, data)
        else:
            shift_low(coder, data)
    return bit


@kernel
def code_number(coder: Int64Array, data: UInt8Array, odds: Int64Array, c: int, number: int) -> int:
    """Code a number of 0 or more: the bit length of number + 1 in unary, then its lower bits.

    Uses NUMBER_CONTEXTS contexts from c. Returns -1 if the length is more than MAX_LENGTH.
    """
    length = 0
    while (number + 1) >> (length + 1) > 0:
        length += 1
    coded = 0
    while code_bit(coder, data, odds, c + coded, 1 if coded < length else 0) == 1:
        coded += 1
        if coded > MAX_LENGTH:
            return -1
    value = 1
    for i in range(coded):
        # The two bits after the leading one are worth a context each, the rest share one.
        context = c + 32 + coded * 4 + (value if i < 2 else 0)
        bit = ((number + 1) >> (coded - 1 - i)) & 1
        value = (value << 1) | code_bit(coder, data, odds, context, bit)
    return value - 1


@kernel
def code_split(
    coder: Int64Array,
    data: UInt8Array,
    odds: Int64Array,
    count: int,
    area: int,
    low: int,
    high: int,
    left: int,
) -> int:
    """Code how many of `count` points lie in the first half of a box, between low and high."""
    depth = 0
    size = 0
    while count >> (size + 1) > 0:
        size += 1
    while low < high:
        middle = (low + high) >> 1
        if count < N_SMALL:
            context = (area * N_SMALL + count) * N_SMALL + middle
        else:
            context = N_AREA_CLASSES * N_SMALL * N_SMALL + min(size, N_LARGE - 1) * N_LARGE
            context += min(depth, N_LARGE - 1)
        if code_bit(coder, data, odds, context, 1 if left > middle else 0) == 1:
            low = middle + 1
        else:
            high = middle
        depth += 1
    return low


@kernel
def code_positions(
    coder: Int64Array,
    data: UInt8Array,
    odds: Int64Array,
    points: Int32Array,
    columns: int,
    rows: int,
) -> None:
    """Code the points of a lattice by halving boxes and counting the points in the first half.

    The first box has sides of powers of two and holds the lattice. The longer side is halved, the
    width where they are equal; the first half is coded before the second.

    Parameters
    ----------
    odds : ndarray
        Shape (SPLIT_CONTEXTS, 2), int64.
    points : ndarray
        Shape (n, 2), int32, distinct, 0 <= x < columns, 0 <= y < rows. When writing, in the order
        in which they are reached; when reading, filled in that order.
    """
    n_points = points.shape[0]
    log_width, log_height = 0, 0
    while 1 << log_width < columns:
        log_width += 1
    while 1 << log_height < rows:
        log_height += 1
    # Boxes still to visit: x, y, logarithms of the sides, number of points. A box is halved at
    # most 40 times and leaves one half waiting each time.
    boxes = np.empty((64, 5), np.int64)
    boxes[0, 0], boxes[0, 1], boxes[0, 2], boxes[0, 3] = 0, 0, log_width, log_height
    boxes[0, 4] = n_points
    size = 1
    done = 0
    while size > 0:
        size -= 1
        x, y, across, down = boxes[size, 0], boxes[size, 1], boxes[size, 2], boxes[size, 3]
        count = boxes[size, 4]
        if count == 0:
            continue
        if across + down == 0:
            points[done, 0] = x
            points[done, 1] = y
            done += 1
            continue
        halve_width = across >= down
        if halve_width:
            across -= 1
        else:
            down -= 1
        x2 = x + (1 << across) if halve_width else x
        y2 = y if halve_width else y + (1 << down)
        room = sites(x, y, across, down, columns, rows)
        room2 = sites(x2, y2, across, down, columns, rows)
        left = 0
        if coder[DECODING] == 0:
            while left < count and (
                points[done + left, 0] < x2 if halve_width else points[done + left, 1] < y2
            ):
                left += 1
        low, high = max(0, count - room2), min(count, room)
        left = code_split(coder, data, odds, count, across + down, low, high, left)
        for second in (True, False):
            boxes[size, 0] = x2 if second else x
            boxes[size, 1] = y2 if second else y
            boxes[size, 2], boxes[size, 3] = across, down
            boxes[size, 4] = count - left if second else left
            size += 1


@kernel
def sites(x: int, y: int, across: int, down: int, columns: int, rows: int) -> int:
    """Number of lattice sites in a box."""
    width = max(0, min(x + (1 << across), columns) - x)
    height = max(0, min(y + (1 << down), rows) - y)
    return width * height


@kernel
def code_triangles(
    coder: Int64Array, data: UInt8Array, odds: Int64Array, triangles: Int32Array, n_vertices: int
) -> int:
    """Code a canonical list of triangles: each by its differences from the one before.

    Parameters
    ----------
    odds : ndarray
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
        step = code_number(coder, data, odds, 0, a - first)
        if step < 0 or first + step >= n_vertices:
            return BAD_NUMBER
        first += step
        second = code_number(coder, data, odds, NUMBER_CONTEXTS, b - first - 1)
        third = code_number(coder, data, odds, 2 * NUMBER_CONTEXTS, c - first - 1)
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


@kernel
def lower_neighbours(triangles: Int32Array, n_vertices: int) -> tuple[Int64Array, Int32Array]:
    """For each vertex the neighbours of lower index, one for each triangle they share.

    Returns
    -------
    starts : ndarray
        Shape (n + 1,), int64: where the neighbours of each vertex start in the next array.
    neighbours : ndarray
        Shape (3 m,), int32.
    """
    starts = np.zeros(n_vertices + 1, np.int64)
    for t in range(triangles.shape[0]):
        for corner in range(3):
            starts[max(triangles[t, corner], triangles[t, (corner + 1) % 3]) + 1] += 1
    for v in range(n_vertices):
        starts[v + 1] += starts[v]
    filled = starts.copy()
    neighbours = np.empty(3 * triangles.shape[0], np.int32)
    for t in range(triangles.shape[0]):
        for corner in range(3):
            a, b = triangles[t, corner], triangles[t, (corner + 1) % 3]
            high = max(a, b)
            neighbours[filled[high]] = min(a, b)
            filled[high] += 1
    return starts, neighbours


@kernel
def code_levels(
    coder: Int64Array,
    data: UInt8Array,
    odds: Int64Array,
    vertices: Int32Array,
    triangles: Int32Array,
    levels: Int32Array,
    lowest: Int32Array,
    highest: Int32Array,
) -> int:
    """Code colour levels, each as its difference from the mean of the neighbours before it.

    A neighbour weighs 2**40 over its squared distance. The context of a difference is made of how
    far the neighbours' levels are spread and of the size of the vertex's difference in the
    component before.

    Parameters
    ----------
    odds : ndarray
        Shape (c * COMPONENT_CONTEXTS, 2), int64.
    vertices : ndarray
        Shape (n, 2), int32, in raster order.
    triangles : ndarray
        Shape (m, 3), int32, indices below n.
    levels : ndarray
        Shape (n, c), int32: taken or filled in.
    lowest, highest : ndarray
        Shape (c,), int32: range of each component's levels.

    Returns
    -------
    int
        OK or BAD_NUMBER.
    """
    n_vertices, n_components = levels.shape
    starts, neighbours = lower_neighbours(triangles, n_vertices)
    for v in range(n_vertices):
        peer = 0
        for z in range(n_components):
            total, weights = np.int64(0), np.int64(0)
            least, most = np.int64(highest[z]), np.int64(lowest[z])
            for i in range(starts[v], starts[v + 1]):
                u = neighbours[i]
                dx = np.int64(vertices[u, 0]) - vertices[v, 0]
                dy = np.int64(vertices[u, 1]) - vertices[v, 1]
                weight = (np.int64(1) << 40) // (dx * dx + dy * dy)
                level = np.int64(levels[u, z])
                total += weight * level
                weights += weight
                least = min(least, level)
                most = max(most, level)
            if weights > 0:
                prediction = (2 * total + weights) // (2 * weights)
                spread = min(bit_length(most - least), N_SPREADS - 2)
            else:  # the first vertex: every other one has a neighbour before it
                prediction = np.int64(0)
                spread = N_SPREADS - 1
            base = z * COMPONENT_CONTEXTS
            context = base + (spread * N_PEERS + peer) * SIZE_CONTEXTS
            error = levels[v, z] - prediction
            size = code_size(coder, data, odds, context, abs(error))
            if size < 0:
                return BAD_NUMBER
            negative = 0
            if size > 0:
                sign_context = base + N_SPREADS * N_PEERS * SIZE_CONTEXTS + peer
                negative = code_bit(coder, data, odds, sign_context, 1 if error < 0 else 0)
            level = prediction - size if negative == 1 else prediction + size
            if level < lowest[z] or level > highest[z]:
                return BAD_NUMBER
            levels[v, z] = level
            peer = min(bit_length(size), N_PEERS - 1)
    return OK


@kernel
def bit_length(number: int | np.int64) -> int:
    """Number of bits of a number of 0 or more."""
    length = 0
    while number >> length > 0:
        length += 1
    return length


@kernel
def code_size(coder: Int64Array, data: UInt8Array, odds: Int64Array, c: int, size: int) -> int:
    """Code the size of a difference: its bit length in unary, then its lower bits.

    Uses SIZE_CONTEXTS contexts from c: 10 for the length, 7 for the bit below the leading one, 6
    for those after it. Returns -1 if the length is more than 10.
    """
    length = bit_length(size)
    coded = 0
    while code_bit(coder, data, odds, c + min(coded, 9), 1 if coded < length else 0) == 1:
        coded += 1
        if coded > 10:
            return -1
    if coded == 0:
        return 0
    value = 1
    for i in range(coded - 1):
        context = c + 10 + (min(coded, 8) - 2 if i == 0 else 4 + min(coded, 8))
        bit = (size >> (coded - 2 - i)) & 1
        value = (value << 1) | code_bit(coder, data, odds, context, bit)
    return value


def fresh_odds(n_contexts: int) -> Int64Array:
    """Even odds for a number of contexts, shape (n, 2), int64."""
    odds = np.zeros((n_contexts, 2), dtype=np.int64)
    odds[:, 0] = 1 << 15
    return odds
