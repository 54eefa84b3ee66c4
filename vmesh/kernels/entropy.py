"""The entropy coder of a .vmesh file and the models of the parts of a mesh (spec, sections 5 to 8).

One kernel per part serves both directions: what it codes it either takes from its arrays and
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

from math import comb

import numpy as np

from vmesh.arrays import Int32Array, Int64Array, UInt8Array
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

# A number's class is its bit length; contexts of one number model.
NUMBER_CONTEXTS = 32 + 32 * 4
MAX_LENGTH = 31

N_AREA_CLASSES = 40  # a box halved once has at most 2**39 sites
N_SMALL = 8  # counts below this have a context of their own
N_LARGE = 24
SPLIT_CONTEXTS = N_AREA_CLASSES * N_SMALL * N_SMALL + N_LARGE * N_LARGE

# Classes of how far the levels of a vertex's parents are spread, by their variance in 1/1024; one
# more for the vertex without parents.
SPREADS = (11, 64, 214, 576, 1388, 3136, 6808, 14400, 29936, 61504, 125346, 254016)
N_SPREADS = 14
N_UNARY = 14
MAX_SIZE_LENGTH = 16  # of the bits of a size beyond that: differences of 16-bit chroma have 17
LARGEST_DEVIATION = 511
SIZE_CONTEXTS = N_UNARY + 2
COMPONENT_CONTEXTS = N_SPREADS * SIZE_CONTEXTS + 3

# Classes of the sum of the cotangents of the angles across an edge, in sixteenths.
ANGLES = (3, 7, 12, 18, 26, 38, 60)
N_ANGLES = 8
N_SLOPES = 5
FLIP_CONTEXTS = 2 * N_ANGLES * N_SLOPES
MAX_FLIPS = 1  # for each half-edge

# Odds at the start, in 1/32, as they were found on average in meshes of ten photographs, and how
# many bits they count as. Whether the size of a difference is more than 0, than 1, than each number
# from 2 on, for each spread; for the first component and for the others.
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
# Whether an edge is flipped, when it is looked at again and for the first time; for each class of
# angles and in it for each slope.
# fmt: off
FLIP_PRIORS = (
    2, 3, 3, 4, 6, 9, 10, 10, 13, 17, 9, 10, 9, 12, 16, 8, 8, 8, 10, 15,
    7, 7, 8, 9, 13, 6, 6, 6, 6, 11, 5, 4, 5, 5, 8, 3, 2, 2, 3, 5,
    6, 8, 9, 9, 12, 10, 11, 11, 13, 16, 7, 8, 9, 10, 14, 5, 7, 6, 7, 10,
    4, 5, 6, 6, 8, 3, 4, 4, 4, 6, 2, 2, 2, 2, 4, 2, 1, 2, 2, 3,
)
# fmt: on
LEVELS_SEEN = 16
FLIPS_SEEN = 16
SPLIT_SEEN = 16


@inner_kernel
def write_byte(coder: Int64Array, data: UInt8Array, byte: int) -> None:
    """Append a byte; beyond the room in `data` only the position advances."""
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


@lean_kernel
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


@lean_kernel
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


@inner_kernel
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


@inner_kernel
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
def code_levels(
    coder: Int64Array,
    data: UInt8Array,
    odds: Int64Array,
    order: Int32Array,
    starts: Int64Array,
    parents: Int32Array,
    levels: Int32Array,
    lowest: Int32Array,
    highest: Int32Array,
) -> int:
    """Code colour levels, each as its difference from the mean of its parents.

    All parents count alike for the first component; for the others those count more that are
    closer in the first. The context of a difference is how far the parents' levels are spread.

    Parameters
    ----------
    odds : ndarray
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
            size = code_size(coder, data, odds, context, abs(error))
            negative = 0
            if size > 0:
                sign_context = base + N_SPREADS * SIZE_CONTEXTS + lean
                negative = code_bit(coder, data, odds, sign_context, 1 if error < 0 else 0)
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
def code_size(coder: Int64Array, data: UInt8Array, odds: Int64Array, c: int, size: int) -> int:
    """Code the size of a difference: in unary up to N_UNARY, what is more in bits of its length.

    Uses SIZE_CONTEXTS contexts from c. Returns -1 if what is more is longer than MAX_SIZE_LENGTH.
    """
    coded = 0
    while coded < N_UNARY:
        if code_bit(coder, data, odds, c + coded, 1 if size > coded else 0) == 0:
            return coded
        coded += 1
    rest = size - N_UNARY + 1
    length = 0
    while code_bit(coder, data, odds, c + N_UNARY, 1 if rest >> (length + 1) > 0 else 0) == 1:
        length += 1
        if length > MAX_SIZE_LENGTH:
            return -1
    value = 1
    for i in range(length):
        bit = (rest >> (length - 1 - i)) & 1
        value = (value << 1) | code_bit(coder, data, odds, c + N_UNARY + 1, bit)
    return N_UNARY - 1 + value


@inner_kernel
def flip(origin: Int32Array, twin: Int32Array, e: int | np.int64) -> None:
    """Turn the diagonal of the two triangles at half-edge e; the same as that of ``delaunay``."""
    f = twin[e]
    e_prev = e + 2 if e % 3 == 0 else e - 1
    f_prev = f + 2 if f % 3 == 0 else f - 1
    outer_e = twin[e_prev]
    outer_f = twin[f_prev]
    origin[e] = origin[f_prev]
    origin[f] = origin[e_prev]
    twin[e] = outer_f
    twin[f] = outer_e
    if outer_f >= 0:
        twin[outer_f] = e
    if outer_e >= 0:
        twin[outer_e] = f
    twin[e_prev] = f_prev
    twin[f_prev] = e_prev


@inner_kernel
def area(points: Int64Array, a: int, b: int, c: int) -> int:
    """Doubled signed area of the triangle a, b, c."""
    bx, by = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1]
    cx, cy = points[c, 0] - points[a, 0], points[c, 1] - points[a, 1]
    doubled: int = bx * cy - by * cx
    return doubled


@inner_kernel
def cotangent(points: Int64Array, a: int, b: int, c: int) -> int:
    """Cotangent of the angle at a of the positive triangle a, b, c in sixteenths, rounded down."""
    bx, by = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1]
    cx, cy = points[c, 0] - points[a, 0], points[c, 1] - points[a, 1]
    sixteenths: int = 16 * (bx * cx + by * cy) // max(area(points, a, b, c), 1)
    return sixteenths


@kernel
def code_flips(
    coder: Int64Array,
    data: UInt8Array,
    odds: Int64Array,
    points: Int64Array,
    levels: Int32Array,
    origin: Int32Array,
    twin: Int32Array,
    removed: Int64Array,
    created: Int64Array,
) -> int:
    """Code which edges of the Delaunay triangulation are flipped, one bit for each in question.

    A queue holds the edges in question: at first all inner edges, then the four sides around each
    flipped one. An edge whose quad is not strictly convex is passed over. The context is made of
    the angles across the edge, of the differences of luma along it and along the other diagonal,
    and of whether the edge is looked at for the first time.

    Parameters
    ----------
    odds : ndarray
        Shape (FLIP_CONTEXTS, 2), int64.
    points : ndarray
        Shape (n, 2), int64.
    levels : ndarray
        Shape (n,), int32: luma.
    origin, twin : ndarray
        Shape (3 m,), int32: half-edges of the canonical Delaunay triangles; on return those of
        the coded mesh.
    removed, created : ndarray
        Shape (k,), int64: when writing, the flips to make, as pairs of the edge that goes, in
        ascending order, and of the one that comes, the lower vertex in the upper 32 bits.

    Returns
    -------
    int
        OK, or BAD_NUMBER if there are more flips than MAX_FLIPS for each half-edge.
    """
    n_edges = origin.shape[0]
    # A ring of places: an edge waits once at most.
    queue = np.empty(n_edges, np.int32)
    waiting = np.zeros(n_edges, np.bool_)
    size, at, n_first = 0, 0, 0
    for inner in range(n_edges):
        if twin[inner] > inner:
            queue[size] = inner
            waiting[inner] = True
            size += 1
    n_first = size
    n_flips = 0
    while size > 0:
        e = np.int64(queue[at])
        at = at + 1 if at + 1 < n_edges else 0
        size -= 1
        first = 1 if n_first > 0 else 0
        n_first -= first
        waiting[e] = False
        f = np.int64(twin[e])
        if f < 0:
            continue
        if origin[e] > origin[f]:
            e, f = f, e
        e_next, e_prev = e - 2 if e % 3 == 2 else e + 1, e + 2 if e % 3 == 0 else e - 1
        f_next, f_prev = f - 2 if f % 3 == 2 else f + 1, f + 2 if f % 3 == 0 else f - 1
        a, b, c, d = origin[e_prev], origin[e], origin[f], origin[f_prev]
        if area(points, a, d, c) <= 0 or area(points, d, a, b) <= 0:
            continue
        cotangents = cotangent(points, a, b, c) + cotangent(points, d, c, b)
        angles = 0
        while angles < N_ANGLES - 1 and cotangents >= ANGLES[angles]:
            angles += 1
        along, across = abs(levels[b] - levels[c]), abs(levels[a] - levels[d])
        if along == across:
            slope = 2
        elif along < across:
            slope = 0 if 2 * along < across else 1
        else:
            slope = 4 if 2 * across < along else 3
        bit = 0
        if coder[DECODING] == 0:
            edge = np.int64(b) << 32 | c
            place = np.searchsorted(removed, edge)
            if place < removed.shape[0] and removed[place] == edge:
                bit = 1 if created[place] == np.int64(min(a, d)) << 32 | max(a, d) else 0
        context = (first * N_ANGLES + angles) * N_SLOPES + slope
        bit = code_bit(coder, data, odds, context, bit)
        if coder[POSITION] > coder[LIMIT]:
            return OK
        if bit == 0:
            continue
        n_flips += 1
        if n_flips > MAX_FLIPS * n_edges:
            return BAD_NUMBER
        flip(origin, twin, e)
        # The four sides, from c around; those on the border do not wait.
        for g in (e_next, f, f_next, e):
            h = twin[g]
            if h >= 0 and not waiting[g] and not waiting[h]:
                end = at + size
                queue[end if end < n_edges else end - n_edges] = g
                waiting[g] = True
                size += 1
    return OK


def even_odds(n_contexts: int) -> Int64Array:
    """Even odds for a number of contexts, shape (n, 2), int64."""
    odds = np.zeros((n_contexts, 2), dtype=np.int64)
    odds[:, 0] = 1 << 15
    return odds


def split_odds() -> Int64Array:
    """Odds of the numbers of points at the start, shape (SPLIT_CONTEXTS, 2), int64.

    Each of a few points lies in either half alike; but in a box of two or four sites it lies in
    the last one, where the centres of pixels are on a lattice of half pixels.
    """
    odds = even_odds(SPLIT_CONTEXTS)
    for count in range(1, N_SMALL):
        for middle, (low, high) in enumerate(_search_steps(count)):
            above = sum(comb(count, left) for left in range(middle + 1, high + 1))
            share = 65536 * above // sum(comb(count, left) for left in range(low, high + 1))
            for area in range(N_AREA_CLASSES):
                context = (area * N_SMALL + count) * N_SMALL + middle
                odds[context, 0] = 2048 if area < 2 else share
                odds[context, 1] = SPLIT_SEEN
    return odds


def _search_steps(count: int) -> list[tuple[int, int]]:
    """The bounds between which a binary search of 0 to `count` asks for each middle."""
    steps = [(0, 0)] * count
    pending = [(0, count)]
    while pending:
        low, high = pending.pop()
        if low < high:
            middle = (low + high) >> 1
            steps[middle] = (low, high)
            pending += [(low, middle), (middle + 1, high)]
    return steps


def level_odds(n_components: int) -> Int64Array:
    """Odds of the levels at the start, shape (c * COMPONENT_CONTEXTS, 2), int64."""
    odds = even_odds(n_components * COMPONENT_CONTEXTS)
    for z in range(n_components):
        for spread in range(N_SPREADS):
            first = z * COMPONENT_CONTEXTS + spread * SIZE_CONTEXTS
            for i in range(N_UNARY):
                odds[first + i, 0] = LEVEL_PRIORS[min(z, 1)][min(i, 2)][spread] << 11
                odds[first + i, 1] = LEVELS_SEEN
    return odds


def flip_odds() -> Int64Array:
    """Odds of a flip at the start, shape (FLIP_CONTEXTS, 2), int64."""
    odds = even_odds(FLIP_CONTEXTS)
    odds[:, 0] = np.array(FLIP_PRIORS) << 11
    odds[:, 1] = FLIPS_SEEN
    return odds
