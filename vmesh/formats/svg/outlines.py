"""Outlines of regions as path data, in the mesh's own lattice units.

::

      ______________        An outline is a loop of half-edges with the region on their right
     |  region     /        (y points down). Nothing is rounded, so that neighbours have the very
     |      ______/         same side: crisp edges then leave no pixel between them, and give each
     |_____|                to the region that holds its centre.

Programs that smooth all edges let what is beneath shine through where two regions meet. For them
regions are trapped: each side that a region shares with one that is painted later is drawn out to
the middle of the triangle across, where the later region covers it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from vmesh.arrays import Int64Array
from vmesh.kernels.half_edges import find_twins, walk_outlines
from vmesh.mesh import Mesh


@dataclass(frozen=True, eq=False)
class Outlines:
    """Loops of corners, region after region. Layers with the same regions share one.

    Parameters
    ----------
    corners : ndarray
        Shape (k, 2), int64, in lattice units.
    loops : ndarray
        Shape (l,), int64: where each loop starts in `corners`.
    regions : ndarray
        Shape (l,), int64: the region of each loop, ascending from 0 without gaps.
    bounds : ndarray
        Shape (k, 2), int64: as `corners`, but a place under another region is replaced by the
        corner before it.
    """

    corners: Int64Array
    loops: Int64Array
    regions: Int64Array
    bounds: Int64Array

    @cached_property
    def starts(self) -> Int64Array:
        """Start of each region in `corners`, shape (n,)."""
        return self.loops[np.diff(self.regions, prepend=-1) > 0]

    @cached_property
    def owners(self) -> Int64Array:
        """The region of each corner, shape (k,)."""
        return np.repeat(self.regions, np.diff(self.loops, append=len(self.corners)))

    @cached_property
    def boxes(self) -> Int64Array:
        """Left, top, width and height of each region, shape (n, 4), in lattice units."""
        low = np.minimum.reduceat(self.corners, self.starts)
        extent = np.maximum.reduceat(self.corners, self.starts) - low
        boxes: Int64Array = np.concatenate([low, extent], axis=1)
        return boxes

    def trapped(self, sides: Int64Array, places: Int64Array) -> Outlines:
        """Outlines with sides drawn out to a place each; a side has the number of its corner."""
        corners = np.insert(self.corners, sides + 1, places, axis=0)
        bounds = np.insert(self.bounds, sides + 1, self.bounds[sides], axis=0)
        loops = self.loops + np.searchsorted(sides, self.loops)
        return Outlines(corners, loops, self.regions, bounds)

    @cached_property
    def path_data(self) -> list[str]:
        """Path data of each region; a loop is relative to the one before, a corner too."""
        steps = np.diff(self.corners, axis=0, prepend=0)
        starts = self.corners[self.loops]
        is_first = np.diff(self.regions, prepend=-1) > 0
        steps[self.loops] = starts - np.where(is_first[:, None], 0, np.roll(starts, 1, axis=0))
        numbers = steps.ravel().tolist()
        cuts = [*(2 * self.loops).tolist(), len(numbers)]
        texts = [""] * len(self.starts)
        for i, region in enumerate(self.regions.tolist()):
            coordinates = " ".join(map(str, numbers[cuts[i] : cuts[i + 1]]))
            texts[region] += f"m{coordinates.replace(' -', '-')}z"
        return texts


def outlines_of(mesh: Mesh, regions: Int64Array, *, trapped: bool = False) -> Outlines:
    """Outlines of regions, which are painted in the order of their numbers.

    Parameters
    ----------
    mesh : Mesh
    regions : ndarray
        Shape (m,), int64: the region of each triangle, or -1 for none.
    trapped : bool
        Whether regions reach under those that are painted after them.
    """
    twins = find_twins(mesh.triangles, mesh.n_vertices)
    own = np.repeat(regions, 3)
    across = np.where(twins >= 0, own[twins], -1)
    inner = across == own
    outer = np.flatnonzero(~inner & (own >= 0))
    starts = outer[np.argsort(own[outer], kind="stable")]
    ordered, loops = walk_outlines(starts, twins, inner)
    vertices = mesh.vertices.astype(np.int64)
    corners = vertices[mesh.triangles.ravel()[ordered]]
    outlines = Outlines(corners, loops, own[ordered[loops]], corners)
    if not trapped:
        return outlines
    under = np.flatnonzero(across[ordered] > own[ordered])
    above = mesh.triangles[twins[ordered[under]] // 3]
    middles = (2 * vertices[above].sum(axis=1) + 3) // 6
    return outlines.trapped(under, middles)
