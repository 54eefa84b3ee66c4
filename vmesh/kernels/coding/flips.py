"""Flips that lead from the canonical Delaunay triangles to those of a mesh (spec, section 8.2)."""

from __future__ import annotations

import numpy as np

from vmesh.arrays import Int32Array, Int64Array, UInt8Array
from vmesh.kernels.coding.range_coder import (
    BAD_NUMBER,
    DECODING,
    LIMIT,
    OK,
    POSITION,
    code_bit,
    even_model,
)
from vmesh.kernels.half_edges import flip, next_edge, previous_edge
from vmesh.kernels.jit import inner_kernel, kernel
from vmesh.kernels.predicates import orient

# Classes of the sum of the cotangents of the angles across an edge, in sixteenths.
ANGLES = (3, 7, 12, 18, 26, 38, 60)
N_ANGLES = 8
N_SLOPES = 5
FLIP_CONTEXTS = 2 * N_ANGLES * N_SLOPES
MAX_FLIPS = 1  # for each half-edge

# Initial probabilities, in 1/32, that an edge is flipped: first where it is looked at again, then
# where it is looked at for the first time; for each class of angles, a value for each slope.
# fmt: off
FLIP_PRIORS = (
    2, 3, 3, 4, 6, 9, 10, 10, 13, 17, 9, 10, 9, 12, 16, 8, 8, 8, 10, 15,
    7, 7, 8, 9, 13, 6, 6, 6, 6, 11, 5, 4, 5, 5, 8, 3, 2, 2, 3, 5,
    6, 8, 9, 9, 12, 10, 11, 11, 13, 16, 7, 8, 9, 10, 14, 5, 7, 6, 7, 10,
    4, 5, 6, 6, 8, 3, 4, 4, 4, 6, 2, 2, 2, 2, 4, 2, 1, 2, 2, 3,
)
# fmt: on
FLIPS_SEEN = 16


@inner_kernel
def cotangent(points: Int64Array, a: int, b: int, c: int) -> int:
    """Cotangent of the angle at a of the positive triangle a, b, c in sixteenths, rounded down."""
    bx, by = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1]
    cx, cy = points[c, 0] - points[a, 0], points[c, 1] - points[a, 1]
    sixteenths: int = 16 * (bx * cx + by * cy) // max(orient(points, a, b, c), 1)
    return sixteenths


@kernel
def code_flips(
    coder: Int64Array,
    data: UInt8Array,
    model: Int64Array,
    points: Int64Array,
    levels: Int32Array,
    origin: Int64Array,
    twin: Int64Array,
    removed: Int64Array,
    created: Int64Array,
) -> int:
    """Code which edges of the Delaunay triangulation are flipped, a bit for each edge in question.

    A queue holds the edges in question: at first all inner edges, then the four sides around each
    flipped one. An edge whose quad is not strictly convex is passed over. The context is made of
    the angles across the edge, of the differences of luma along it and along the other diagonal,
    and of whether the edge is looked at for the first time.

    Parameters
    ----------
    model : ndarray
        Shape (FLIP_CONTEXTS, 2), int64.
    points : ndarray
        Shape (n, 2), int64.
    levels : ndarray
        Shape (n,), int32: luma.
    origin, twin : ndarray
        Shape (3 m,), int64: half-edges of the canonical Delaunay triangles; on return those of
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
    queue = np.empty(n_edges, np.int64)
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
        a, b, c, d = origin[previous_edge(e)], origin[e], origin[f], origin[previous_edge(f)]
        if orient(points, a, d, c) <= 0 or orient(points, d, a, b) <= 0:
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
        bit = code_bit(coder, data, model, context, bit)
        if coder[POSITION] > coder[LIMIT]:
            return OK
        if bit == 0:
            continue
        n_flips += 1
        if n_flips > MAX_FLIPS * n_edges:
            return BAD_NUMBER
        flip(origin, twin, e)
        # The four sides, from c around; those on the border do not wait.
        for g in (next_edge(e), f, next_edge(f), e):
            h = twin[g]
            if h >= 0 and not waiting[g] and not waiting[h]:
                end = at + size
                queue[end if end < n_edges else end - n_edges] = g
                waiting[g] = True
                size += 1
    return OK


def initial_flip_model() -> Int64Array:
    """Initial model of the flips, shape (FLIP_CONTEXTS, 2), int64."""
    model = even_model(FLIP_CONTEXTS)
    model[:, 0] = np.array(FLIP_PRIORS) << 11
    model[:, 1] = FLIPS_SEEN
    return model
