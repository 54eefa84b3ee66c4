"""Remeshing: from a dense proposal to the mesh that leaves the least error for its vertices."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final

import numpy as np

from vmesh.arrays import Float64Array, Int32Array, Int64Array, UInt8Array
from vmesh.encoder.colors import fit_components, sample_colors
from vmesh.encoder.drafts import price_of
from vmesh.encoder.image import visible_planes
from vmesh.kernels.delaunay import delaunay, sort_triangles
from vmesh.kernels.half_edges import find_twins
from vmesh.kernels.remeshing import (
    Surface,
    flip_edges,
    insert,
    make_room,
    measure,
    propose_insertions,
    relocate,
    thin,
)

_UNIT: Final = 2  # lattice units in a pixel
# Colours are fitted anew whenever this share of the vertices is left.
_REFIT_SHARE: Final = 0.6
_FINE_SHARE: Final = 0.85  # where the error is what stops the thinning
_RESIZE_SHARE: Final = 0.02
# Bits that an edge costs which is not Delaunay.
_FLIP_BITS: Final = 3.5
_INSERTION_PASSES: Final = 6


class Remesher:
    """A draft that keeps the best vertices of a dense proposal and moves them to better places.

    Parameters
    ----------
    image : ndarray
        Shape (h, w, c), uint8.
    vertices : ndarray
        Shape (n, 2), int32, in half pixels, in raster order, the corners of the picture among them.
    """

    def __init__(self, image: UInt8Array, vertices: Int32Array) -> None:
        # Colours count as much as they can be seen: all components, alpha among them, alike.
        self._picture = np.ascontiguousarray(visible_planes(image).transpose(1, 2, 0))
        self._weights = np.ones(image.shape[:2])
        self._room = make_room(image.shape[0], image.shape[2])
        colors = sample_colors(self._picture, vertices, _UNIT)
        self._surface = _open_surface(vertices.astype(np.int64), colors, delaunay(vertices), 0)
        self.n_vertices = len(vertices)
        self.error = 0.0
        self._refit()

    def thin(
        self,
        n_vertices: int,
        report: Callable[[], None],
        *,
        max_cost: float = np.inf,
        max_error: float = np.inf,
    ) -> None:
        """Remove the least useful vertices, one by one, with colours fitted anew on the way.

        Parameters
        ----------
        n_vertices : int
            Number of vertices to stop at.
        report : callable
            Called before each fit of the colours.
        max_cost, max_error : float
            Stop where each vertex left costs more squared error than this, or where the error
            has grown to this.
        """
        share = _REFIT_SHARE if max_error == np.inf else _FINE_SHARE
        report()
        while self.n_vertices > n_vertices and self.error < max_error:
            wanted = self.n_vertices - max(n_vertices, int(share * self.n_vertices))
            removed = self._remove(wanted, max_cost)
            report()
            self._refit()
            if removed < wanted:
                break
        self._compact(0)

    def refine(self, n_vertices: int, shares: Sequence[float], report: Callable[[], None]) -> None:
        """Let the mesh settle, and exchange shares of its vertices one after the other.

        Parameters
        ----------
        n_vertices : int
            Number of vertices to end with.
        shares : sequence of float
            Share of the vertices to exchange before each round.
        report : callable
            Called after each round.
        """
        for share in shares:
            self._exchange(n_vertices, share)
            self._settle()
            report()

    def resize(self, n_vertices: int) -> None:
        """Change the number of vertices, as far as there is anything to gain from more."""
        self._exchange(n_vertices, _RESIZE_SHARE)
        self._settle()

    def _exchange(self, n_vertices: int, share: float) -> None:
        """Remove the least useful vertices and insert others where they gain most."""
        n_exchanged = int(share * n_vertices)
        self._remove(max(0, self.n_vertices - n_vertices + n_exchanged), np.inf)
        self._compact(max(0, n_vertices - self.n_vertices))
        for _ in range(_INSERTION_PASSES):
            wanted = n_vertices - self.n_vertices
            if wanted <= 0 or self._insert(wanted) == 0:
                break
        self._compact(0)

    def _settle(self) -> None:
        """Move vertices and flip edges to where the error is least."""
        relocate(self._surface, self._picture, self._room)
        charge = _FLIP_BITS * price_of(self)
        flip_edges(self._surface, self._picture, self._room, charge)
        self._refit()

    def geometry(self) -> tuple[Int32Array, Int32Array]:
        """Vertices, (n, 2), and triangles, (m, 3), int32, in canonical order."""
        points, triangles = self._surface.points, self._surface.origin.reshape(-1, 3)
        order = np.lexsort((points[:, 0], points[:, 1]))
        rank = np.empty(len(order), dtype=np.int32)
        rank[order] = np.arange(len(order))
        return points[order].astype(np.int32), sort_triangles(rank[triangles], len(order))

    def _remove(self, n_remove: int, max_cost: float) -> int:
        removed = thin(self._surface, self._picture, self._room, n_remove, max_cost)
        self.n_vertices -= removed
        return removed

    def _insert(self, n_insert: int) -> int:
        """Insert vertices where they gain most, no two of them side by side; how many."""
        n_triangles = len(self._surface.errors)
        gains = np.zeros(n_triangles)
        places = np.zeros((n_triangles, 2), dtype=np.int64)
        propose_insertions(self._surface, self._picture, self._room, gains, places)
        order = np.argsort(-gains, kind="stable")
        useful = order[gains[order] > 0.0]
        inserted = insert(self._surface, self._picture, self._room, useful, places, n_insert)
        self.n_vertices += inserted
        return inserted

    def _refit(self) -> None:
        """Fit all colours anew and measure what error is left."""
        surface = self._surface
        triangles = surface.origin.reshape(-1, 3)
        triangles = np.ascontiguousarray(triangles[triangles[:, 0] >= 0])
        surface.colors[:], _ = fit_components(
            self._picture,
            self._weights,
            surface.points.astype(np.int32),
            triangles,
            _UNIT,
            surface.colors,
        )
        self.error = measure(surface, self._picture, self._room)

    def _compact(self, n_spare: int) -> None:
        """Drop what is not in use, and make room for some more vertices."""
        surface = self._surface
        triangles = surface.origin.reshape(-1, 3)
        triangles = triangles[triangles[:, 0] >= 0]
        used = np.flatnonzero(surface.leaving >= 0)
        rank = np.empty(len(surface.points), dtype=np.int32)
        rank[used] = np.arange(len(used))
        self._surface = _open_surface(
            surface.points[used], surface.colors[used], rank[triangles], n_spare
        )
        self._surface.restless[: len(used)] = surface.restless[used]
        measure(self._surface, self._picture, self._room)


def _open_surface(
    points: Int64Array,
    colors: Float64Array,
    triangles: Int32Array,
    n_spare: int,
) -> Surface:
    """A surface with room for some more vertices, its errors not measured yet."""
    n_points, n_triangles = len(points), len(triangles)
    n_edges = 3 * n_triangles
    more = 6 * n_spare
    leaving = np.full(n_points + n_spare, -1, dtype=np.int32)
    leaving[triangles.ravel()] = np.arange(n_edges, dtype=np.int32)
    return Surface(
        points=np.concatenate([points, np.zeros((n_spare, 2), dtype=np.int64)]),
        colors=np.concatenate([colors, np.zeros((n_spare, colors.shape[1]))]),
        origin=np.concatenate([triangles.ravel(), np.full(more, -1, dtype=np.int32)]),
        twin=np.concatenate([find_twins(triangles, n_points), np.full(more, -1, dtype=np.int32)]),
        leaving=leaving,
        errors=np.zeros(n_triangles + 2 * n_spare),
        restless=np.ones(n_points + n_spare, dtype=np.bool_),
    )
