"""Remeshing: from a dense proposal to a mesh that leaves little error for its vertices."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, Final

import numpy as np

from vmesh.arrays import Float64Array, Int32Array, Int64Array
from vmesh.encoder.colors import fit_components, sample_colors
from vmesh.encoder.draft import UNIT
from vmesh.encoder.effort import Effort
from vmesh.encoder.image import peak_of, premultiplied_planes
from vmesh.encoder.independent_sets import independent_sets
from vmesh.encoder.rate_model import flip_cost, lambda_of
from vmesh.encoder.threads import Run, run_here, shares
from vmesh.kernels.delaunay import delaunay
from vmesh.kernels.half_edges import find_twins, sort_triangles
from vmesh.kernels.remeshing import (
    Surface,
    WeightedImage,
    Workspace,
    flip_edges,
    insert,
    make_workspace,
    measure,
    propose_insertions,
    relocate,
    thin,
    weigh,
)
from vmesh.mesh.canonical_order import raster_keys

# Colours are fitted anew whenever this share of the vertices is left.
_REFIT_SHARE: Final = 0.6
_FINE_SHARE: Final = 0.85  # where the error is what stops the thinning
# Shares of the vertices that are exchanged in a round: the first, and the least.
_FIRST_SHARE: Final = 0.2
_LEAST_SHARE: Final = 0.03
# What chance may multiply a cost by, less 1: without it the same vertices come and go. On kodim05
# and kodim23 it gives 23.10 and 34.81 dB with 0, 23.26 and 34.87 with 4 (effort 7, 4,000
# vertices); 23.47 and 35.10 with 4, 23.53 and 35.14 with 8 (effort 9).
_CHANCE: Final = 8.0
_SMALL_CHANGE: Final = 0.05  # of the number of vertices: nothing is exchanged for it
_HASTE: Final = 0.6  # factor of the share where the error has risen
_PATIENCE: Final = 3  # rounds that are judged together
_CROWDED: Final = 0.5  # vertices for each pixel
_INSERTION_PASSES: Final = 6


class Remesher:
    """A draft that keeps the best vertices of a dense proposal and moves them to better places.

    Parameters
    ----------
    image : WeightedImage
    vertices : ndarray
        Shape (n, 2), int32, in half pixels, in raster order, the corners of the picture among them.
    effort : Effort
        How long the mesh is refined.
    run : callable
        Runs the jobs that do not depend on each other.
    """

    def __init__(
        self, image: WeightedImage, vertices: Int32Array, effort: Effort, run: Run = run_here
    ) -> None:
        self._effort = effort
        self._run = run
        self._random = np.random.default_rng(0)
        # A round takes little time on a small picture, so it may gain little.
        self._least_gain = effort.least_gain * min(1.0, image.weights.size / 2**18)
        # Colours count as much as they can be seen: all components, alpha among them, alike.
        samples = np.ascontiguousarray(premultiplied_planes(image.samples).transpose(1, 2, 0))
        self._picture = WeightedImage(samples, image.weights)
        self._workspace = self._make_workspace()
        colors = sample_colors(samples, vertices, UNIT)
        self._surface = _open_surface(vertices.astype(np.int64), colors, delaunay(vertices), 0)
        self.n_proposed = self.n_vertices = len(vertices)
        self.error = 0.0
        self._refit()

    @property
    def peak(self) -> int:
        """The largest sample that the picture may hold."""
        return peak_of(self._picture.samples)

    @property
    def n_samples(self) -> int:
        """Number of samples that the error is summed over."""
        return self._picture.samples.size

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
            Costs and error, both squared, at which to stop: where each vertex left costs more, or
            where the error has grown to this.
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

    def thin_exactly(self, n_vertices: int) -> None:
        """Remove vertices until there are so many."""
        self.thin(n_vertices, lambda: None)

    def refine(self, n_vertices: int, report: Callable[[], None]) -> None:
        """Move and flip, then exchange vertices round by round while that gains enough.

        Parameters
        ----------
        n_vertices : int
            Number of vertices to end with.
        report : callable
            Called after each round.
        """
        self._settle()
        report()
        self._exchange_rounds(n_vertices, _FIRST_SHARE, report)

    def resize(self, n_vertices: int) -> None:
        """Change the number of vertices, as far as the picture allows."""
        change = abs(n_vertices - self.n_vertices) / self.n_vertices
        if change > _SMALL_CHANGE:
            share = min(2 * change, _FIRST_SHARE)
            self._exchange_rounds(n_vertices, share, lambda: None)
        else:
            self._exchange(n_vertices, 0.0)
            self._settle()

    def _exchange_rounds(self, n_vertices: int, share: float, report: Callable[[], None]) -> None:
        """Exchange vertices round by round, first this share of them, while that gains enough."""
        if n_vertices > _CROWDED * self._picture.weights.size:
            # There is hardly a pixel left for what comes into the place of what goes.
            if n_vertices != self.n_vertices:
                self._exchange(n_vertices, 0.0)
                self._settle()
            return
        errors = []
        for _ in range(self._effort.max_rounds):
            self._exchange(n_vertices, share)
            self._settle()
            report()
            errors.append(self.error)
            share = max(self._effort.share_decay * share, _LEAST_SHARE)
            if len(errors) <= _PATIENCE:
                continue
            # The gain of a single round says little: the shares are taken by chance.
            before = errors[-1 - _PATIENCE]
            if errors[-1] > before and share > _LEAST_SHARE:
                # Chance takes more than the rounds bring back.
                share = max(_HASTE * share, _LEAST_SHARE)
            elif errors[-1] > before * (1.0 - _PATIENCE * self._least_gain):
                break

    def _exchange(self, n_vertices: int, share: float) -> None:
        """Remove the least useful vertices and insert others where they gain most."""
        n_exchanged = int(share * n_vertices)
        n_remove = max(0, self.n_vertices - n_vertices + n_exchanged)
        self._remove(n_remove, np.inf, _CHANCE)
        self._compact(max(0, n_vertices - self.n_vertices))
        self._insert(n_vertices - self.n_vertices)
        self._compact(0)

    def _settle(self) -> None:
        """Move vertices and flip edges to where the error is least."""
        self._relocate()
        charge = flip_cost(lambda_of(self))
        flip_edges(self._surface, self._picture, self._workspace, charge)
        self._refit()

    def geometry(self) -> tuple[Int32Array, Int32Array]:
        """Vertices, (n, 2), and triangles, (m, 3), int32, in canonical order."""
        points, triangles = self._surface.points, self._surface.origin.reshape(-1, 3)
        order = np.argsort(raster_keys(points))
        rank = np.empty(len(order), dtype=np.int32)
        rank[order] = np.arange(len(order))
        return points[order].astype(np.int32), sort_triangles(rank[triangles], len(order))

    def _remove(self, n_remove: int, max_cost: float, chance: float = 0.0) -> int:
        """Remove the least useful vertices; returns how many.

        The cost of each is multiplied by up to 1 + `chance`.
        """
        surface, picture = self._surface, self._picture
        costs = np.empty(len(surface.points))
        self._share_out(
            len(costs),
            lambda work, first, last: weigh(surface, picture, work, first, last, costs),
        )
        factors = 1.0 + chance * self._random.random(len(costs))
        removed = thin(surface, picture, self._workspace, costs, factors, n_remove, max_cost)
        self.n_vertices -= removed
        return removed

    def _insert(self, n_insert: int) -> None:
        """Insert vertices where they gain most, and where they gain nothing only if need be."""
        surface, picture = self._surface, self._picture
        gains = np.full(len(surface.errors), np.nan)
        places = np.zeros((len(gains), 2), dtype=np.int64)
        for least_gain in (0.0, -np.inf):
            # No two go into neighbouring triangles at once: the next call sees the changes of this.
            for _ in range(_INSERTION_PASSES):
                if n_insert <= 0:
                    break
                self._share_out(
                    len(gains),
                    lambda work, first, last: propose_insertions(
                        surface, picture, work, first, last, gains, places
                    ),
                )
                order = np.argsort(-gains, kind="stable")
                useful = order[gains[order] > least_gain]
                work = self._workspace
                inserted = insert(surface, picture, work, useful, gains, places, n_insert)
                if inserted == 0:
                    break
                n_insert -= inserted
                self.n_vertices += inserted

    def _refit(self) -> None:
        """Fit all colours anew and measure the error that is left."""
        surface = self._surface
        corners = surface.origin.reshape(-1, 3)
        triangles = corners[corners[:, 0] >= 0].astype(np.int32)
        surface.colors[:], _ = fit_components(
            *self._picture,
            surface.points.astype(np.int32),
            triangles,
            UNIT,
            surface.colors,
        )
        self._share_out(
            len(surface.errors),
            lambda work, first, last: measure(surface, self._picture, work, first, last),
        )
        self.error = float(surface.errors.sum())

    def _relocate(self) -> None:
        """Move all vertices whose surroundings have changed to better places."""
        surface, picture = self._surface, self._picture
        for groups in independent_sets(surface.points, surface.origin.reshape(-1, 3)):
            self._do(
                lambda group: relocate(surface, picture, self._make_workspace(), group), groups
            )

    def _share_out(self, n_items: int, job: Callable[[Workspace, int, int], None]) -> None:
        """Do a job for all items, called with each share of them and a workspace of its own."""
        self._do(lambda share: job(self._make_workspace(), *share), shares(n_items))

    def _do(self, job: Callable[[Any], object], arguments: Iterable[Any]) -> None:
        """Do jobs that do not depend on each other."""
        for _ in self._run(job, arguments):
            pass

    def _make_workspace(self) -> Workspace:
        height, _, n_components = self._picture.samples.shape
        return make_workspace(height, n_components)

    def _compact(self, n_spare: int) -> None:
        """Drop what is not in use, and add capacity for some more vertices."""
        surface = self._surface
        triangles = surface.origin.reshape(-1, 3)
        alive = triangles[:, 0] >= 0
        triangles = triangles[alive]
        used = np.flatnonzero(surface.leaving >= 0)
        rank = np.empty(len(surface.points), dtype=np.int32)
        rank[used] = np.arange(len(used))
        self._surface = _open_surface(
            surface.points[used], surface.colors[used], rank[triangles], n_spare
        )
        self._surface.dirty[: len(used)] = surface.dirty[used]
        self._surface.errors[: len(triangles)] = surface.errors[alive]


def _open_surface(
    points: Int64Array,
    colors: Float64Array,
    triangles: Int32Array,
    n_spare: int,
) -> Surface:
    """A surface with capacity for some more vertices, its errors not measured yet."""
    n_points, n_triangles = len(points), len(triangles)
    n_edges = 3 * n_triangles
    more = 6 * n_spare
    leaving = np.full(n_points + n_spare, -1, dtype=np.int64)
    leaving[triangles.ravel()] = np.arange(n_edges, dtype=np.int64)
    return Surface(
        points=np.concatenate([points, np.zeros((n_spare, 2), dtype=np.int64)]),
        colors=np.concatenate([colors, np.zeros((n_spare, colors.shape[1]))]),
        origin=np.concatenate([triangles.ravel(), np.full(more, -1, dtype=np.int64)]),
        twin=np.concatenate([find_twins(triangles, n_points), np.full(more, -1, dtype=np.int64)]),
        leaving=leaving,
        errors=np.zeros(n_triangles + 2 * n_spare),
        dirty=np.ones(n_points + n_spare, dtype=np.bool_),
    )
