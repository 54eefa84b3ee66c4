"""Drafts of a picture in tiles, each of which is worked on as a picture of its own.

The tiles share nothing but the cost of a vertex, so they are the jobs of the threads.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Final, Generic, TypeVar

import numpy as np

from vmesh.arrays import Int32Array
from vmesh.encoder.draft import Draft
from vmesh.encoder.rate_model import ERROR_POWER, SAMPLED_POWER, lambda_of
from vmesh.encoder.remeshing import Remesher
from vmesh.encoder.threads import Run
from vmesh.encoder.tiles.joining import NEAR, join
from vmesh.grid import Grid

Part = TypeVar("Part", bound=Draft)

_CORNERS: Final = 4
_NO_ERROR: Final = 1e-9  # instead of 0, where it divides
# What the least useful vertex costs falls with a larger power of their number than this: a search
# in such steps comes from above.
_COST_POWER: Final = 1.5
# A dense sample has many vertices that are worth next to nothing: the average of all is right for
# so many times fewer.
_CAUTION: Final = 4.0
# A search for a number ends where there are so many times more.
_NEAR: Final = 1.1
_MAX_THINNINGS: Final = 8
_SMALL_CHANGE: Final = 0.05  # of the vertices of a tile
# Where the tiles have more vertices for each pixel than this, they are left beside the lines: there
# is no sliver that is much smaller than the other triangles.
_DENSE: Final = 0.5
# How often the tiles' numbers are corrected for the vertices that they share.
_MAX_CORRECTIONS: Final = 16
REPORTS: Final = 6
"""Number of progress reports, at most, while something is done to all tiles."""


class TiledDraft(Generic[Part]):
    """A draft that is made of a draft for each tile of a grid.

    Parameters
    ----------
    grid : Grid
    parts : sequence of Draft
        Drafts of the tiles, in the order of the grid.
    run : callable
        Runs the jobs, of which each has tiles of its own.
    near : int
        As for :func:`join`.
    """

    def __init__(self, grid: Grid, parts: Sequence[Part], run: Run, near: int = NEAR) -> None:
        self._grid = grid
        self._near = near
        self._parts = list(parts)
        self._run = run
        self._joined: tuple[Int32Array, Int32Array] | None = None

    @property
    def parts(self) -> tuple[Part, ...]:
        """The drafts of the tiles."""
        return tuple(self._parts)

    @property
    def n_vertices(self) -> int:
        """Number of vertices of the joined mesh."""
        return len(self.geometry()[0])

    @property
    def error(self) -> float:
        """Squared error of the tiles, each with colours of its own."""
        return sum(part.error for part in self._parts)

    def resize(self, n_vertices: int) -> None:
        """Change the number of vertices of the joined mesh to about this."""
        for _ in range(_MAX_CORRECTIONS):
            numbers = self._numbers(n_vertices)
            if self.n_vertices == n_vertices or numbers == self._counts:
                break
            self._resize_parts(numbers)

    def geometry(self) -> tuple[Int32Array, Int32Array]:
        """Vertices, (n, 2), and triangles, (m, 3), int32, in canonical order."""
        if self._joined is None:
            is_dense = self._n_apart > _DENSE * self._grid.width * self._grid.height
            near = 0 if is_dense else self._near
            self._joined = join(self._grid, [part.geometry() for part in self._parts], near)
        return self._joined

    @property
    def _counts(self) -> list[int]:
        return [part.n_vertices for part in self._parts]

    @property
    def _n_apart(self) -> int:
        """Number of vertices of all tiles; shared ones count in each."""
        return sum(self._counts)

    def _numbers(self, n_vertices: int) -> list[int]:
        """Numbers of vertices for the tiles that make about so many when they are joined."""
        total = round(self._n_apart * n_vertices / self.n_vertices)
        return apportion(self._counts, total)

    def _resize_parts(self, numbers: list[int]) -> None:
        pairs = zip(self._parts, numbers, strict=True)
        jobs = [(part, number) for part, number in pairs if part.n_vertices != number]
        self._do(lambda job: job[0].resize(job[1]), jobs, _say_nothing)

    def _do(
        self, work: Callable[[Any], None], jobs: Sequence[Any], report: Callable[[], None]
    ) -> None:
        """Do some jobs, each on a tile of its own, and report now and then."""
        for i, _ in enumerate(self._run(work, jobs)):
            if (i + 1) * REPORTS // len(jobs) > i * REPORTS // len(jobs):
                report()
        self._joined = None


class TiledSamples(TiledDraft[Draft]):
    """A draft of vertices where they were sampled, tile by tile."""

    def balance(self) -> None:
        """Share the vertices out so that a bit is worth about as much in every tile."""
        worth = [part.n_vertices * lambda_of(part) ** (1 / SAMPLED_POWER) for part in self._parts]
        self._resize_parts(apportion(worth, self._n_apart))


class TiledRemesher(TiledDraft[Remesher]):
    """A draft that is thinned and refined tile by tile."""

    _cost = 0.0  # what all tiles were thinned to

    @property
    def peak(self) -> int:
        """The largest sample that the picture may hold."""
        return self._parts[0].peak

    @property
    def n_samples(self) -> int:
        """Number of samples that the error is summed over."""
        return sum(part.n_samples for part in self._parts)

    def replace(self, parts: dict[int, Remesher]) -> None:
        """Put other drafts, by number, in place of those of the tiles."""
        for i, part in parts.items():
            self._parts[i] = part
        self._joined = None

    def thin(
        self,
        n_vertices: int,
        report: Callable[[], None],
        *,
        max_cost: float = np.inf,
        max_error: float = np.inf,
    ) -> None:
        """Remove the least useful vertices, as :meth:`Remesher.thin` does.

        In all tiles vertices go up to the same cost. Unless it is given, it is one that leaves
        about the number of vertices, or the error, that is asked for.
        """
        if max_cost < np.inf:
            self._thin_parts(max_cost, report)
            return
        for _ in range(_MAX_THINNINGS):
            report()
            if self._cost > 0.0:
                self._thin_parts(self._cost, _say_nothing)
            excess = self._excess(n_vertices, max_error)
            if excess < _NEAR:
                break
            self._cost = self._next_cost(excess)

    def refine(self, n_vertices: int, report: Callable[[], None]) -> None:
        """Refine each tile, as :meth:`Remesher.refine` does, to about so many vertices in all."""
        jobs = list(zip(self._parts, super()._numbers(n_vertices), strict=True))
        self._do(lambda job: job[0].refine(job[1], _say_nothing), jobs, report)

    def thin_exactly(self, n_vertices: int) -> None:
        """Remove vertices until the joined mesh has so many, from each tile its share.

        None but the corners of the tiles may lie on the lines between them.
        """
        inner = [number - _CORNERS for number in self._counts]
        n_corners = self.n_vertices - sum(inner)
        left = _proportional(inner, max(0, n_vertices - n_corners))
        jobs = list(zip(self._parts, left, strict=True))
        self._do(lambda job: job[0].thin(_CORNERS + job[1], _say_nothing), jobs, _say_nothing)

    def _numbers(self, n_vertices: int) -> list[int]:
        """Numbers of vertices for the tiles: one alone makes up for a small difference."""
        numbers = self._counts
        change = n_vertices - self.n_vertices
        enough = [number for number in numbers if _SMALL_CHANGE * number >= abs(change)]
        if not enough:
            return super()._numbers(n_vertices)
        # The smallest such tile takes the least time.
        numbers[numbers.index(min(enough))] += change
        return numbers

    def _excess(self, n_vertices: int, max_error: float) -> float:
        """Factor by which there are too many vertices for the number or the error wanted."""
        allowed: float = (max_error / max(self.error, _NO_ERROR)) ** (1 / ERROR_POWER)
        return min(self._n_apart / n_vertices, allowed)

    def _next_cost(self, excess: float) -> float:
        """Cost to thin to next where there are so many times more vertices than wanted."""
        before, factor = self._cost, excess
        if before == 0.0:
            before, factor = self.error / self._n_apart, excess / _CAUTION
        return float(before * factor**_COST_POWER)

    def _thin_parts(self, max_cost: float, report: Callable[[], None]) -> None:
        def thin(part: Remesher) -> None:
            part.thin(_CORNERS, _say_nothing, max_cost=max_cost)

        self._do(thin, self._parts, report)


def apportion(weights: Sequence[float], total: int) -> list[int]:
    """Numbers of vertices in proportion to weights, by the method of largest remainders.

    They add up to the total unless a tile has to be given the vertices of its corners.
    """
    return [max(_CORNERS, number) for number in _proportional(weights, total)]


def _proportional(weights: Sequence[float], total: int) -> list[int]:
    """Whole numbers in proportion to weights that add up to a total."""
    exact = np.asarray(weights) * (total / max(sum(weights), _NO_ERROR))
    whole = np.floor(exact).astype(np.int64)
    # The rest of the total goes to the numbers that lost most by rounding.
    order = np.argsort(whole - exact, kind="stable")
    whole[order[: max(0, total - int(whole.sum()))]] += 1
    result: list[int] = whole.tolist()
    return result


def _say_nothing() -> None:
    """Report nothing, as jobs do: only the thread that waits for them may call a report."""
