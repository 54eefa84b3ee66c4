"""Hypothesis strategies: valid meshes of small canvases, and what they are made of."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

from vmesh.arrays import Int32Array, UInt8Array
from vmesh.color_lattice import ColorLattice
from vmesh.kernels.delaunay import delaunay
from vmesh.mesh import Mesh, Metadata
from vmesh.mesh.canonical_order import sorted_triangles

MAX_CANVAS = 12


def raster_sorted(points: Int32Array) -> Int32Array:
    """Points by y, then x."""
    return points[np.lexsort((points[:, 0], points[:, 1]))]


def flipped(
    vertices: Int32Array, triangles: Int32Array, n_flips: int, random: np.random.Generator
) -> Int32Array:
    """Canonical triangles after up to `n_flips` random flips of edges of convex quads."""
    faces = [tuple(int(v) for v in face) for face in triangles]
    for _ in range(n_flips):
        owner = {}
        for t, (a, b, c) in enumerate(faces):
            owner[a, b], owner[b, c], owner[c, a] = (t, c), (t, a), (t, b)
        edges = [edge for edge in owner if edge[::-1] in owner]
        if not edges:
            break
        b, c = edges[random.integers(len(edges))]
        (t, a), (u, d) = owner[b, c], owner[c, b]
        if _doubled_area(vertices, a, d, c) > 0 and _doubled_area(vertices, a, b, d) > 0:
            faces[t], faces[u] = (a, d, c), (a, b, d)
    return sorted_triangles(np.array(faces, dtype=np.int32).reshape(-1, 3))


def _doubled_area(vertices: Int32Array, a: int, b: int, c: int) -> int:
    (ax, ay), (bx, by), (cx, cy) = vertices[[a, b, c]].tolist()
    return int((bx - ax) * (cy - ay) - (by - ay) * (cx - ax))


def lattices() -> st.SearchStrategy[ColorLattice]:
    """Steps of grey, RGB and RGBA, in samples of 8 bits and of more."""
    return st.sampled_from([8, 8, 8, 9, 12, 16]).flatmap(_lattices_of)


def _lattices_of(depth: int) -> st.SearchStrategy[ColorLattice]:
    step = st.integers(1, (1 << depth) - 1)
    return st.one_of(
        st.tuples(step), st.tuples(step, step, step), st.tuples(step, step, step, step)
    ).map(lambda steps: ColorLattice(steps, depth))


def metadata() -> st.SearchStrategy[Metadata]:
    """Metadata blocks, and ancillary chunks that no version knows."""
    block = st.binary(max_size=40)
    unknown = st.lists(st.tuples(st.sampled_from([b"n", b"z", b"a"]), block), max_size=3)
    return st.builds(Metadata, icc=block, exif=block, xmp=block, unknown=unknown.map(tuple))


@st.composite
def point_sets(draw: st.DrawFn, most: int = 40) -> tuple[int, int, Int32Array]:
    """Columns and rows of a lattice, and distinct points on it in raster order."""
    columns, rows = draw(st.integers(1, 40)), draw(st.integers(1, 40))
    site = st.tuples(st.integers(0, columns - 1), st.integers(0, rows - 1))
    sites = draw(st.sets(site, min_size=1, max_size=most))
    return columns, rows, raster_sorted(np.array(sorted(sites), dtype=np.int32))


@st.composite
def pictures(draw: st.DrawFn, most: int = 12) -> UInt8Array:
    """Pictures of shape (h, w, c): noise of a few or many levels, in blocks or single pixels."""
    height, width = draw(st.integers(1, most)), draw(st.integers(1, most))
    n_components, block = draw(st.sampled_from([1, 3, 4])), draw(st.integers(1, 4))
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    levels = random.integers(0, 256, draw(st.sampled_from([1, 2, 256])), dtype=np.uint8)
    blocks = random.choice(levels, (height, width, n_components))
    y, x = np.mgrid[:height, :width] // block
    result: UInt8Array = np.ascontiguousarray(blocks[y, x])
    return result


@st.composite
def meshes(draw: st.DrawFn) -> Mesh:
    """Valid meshes in canonical order, with implied triangles or with flipped edges."""
    width, height = draw(st.integers(1, MAX_CANVAS)), draw(st.integers(1, MAX_CANVAS))
    subdivision = draw(st.integers(0, 3))
    far_x, far_y = width << subdivision, height << subdivision
    site = st.tuples(st.integers(0, far_x), st.integers(0, far_y))
    corners = {(0, 0), (far_x, 0), (0, far_y), (far_x, far_y)}
    sites = corners | draw(st.sets(site, max_size=40))
    vertices = raster_sorted(np.array(sorted(sites), dtype=np.int32))
    lattice = draw(lattices())
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    triangles = flipped(vertices, delaunay(vertices), draw(st.integers(0, 6)), random)
    lowest, highest = lattice.level_bounds()
    shape = (len(vertices), lattice.n_components)
    levels = random.integers(lowest, highest, shape, endpoint=True, dtype=np.int32)
    return Mesh(width, height, vertices, triangles, levels, lattice, subdivision, draw(metadata()))
