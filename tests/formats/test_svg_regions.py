"""Merged regions against a slow search through all pairs."""

from __future__ import annotations

from functools import reduce
from itertools import combinations

import numpy as np
import pytest

import vmesh
from tests import twins
from vmesh.formats.svg.regions import Moments, merge

Region = frozenset[int]


def error_of(moments: Moments, region: Region) -> float:
    """Squared error of the best gradient on some triangles."""
    parts = [moments.take(np.array([t])) for t in sorted(region)]
    return float(reduce(Moments.joined, parts).errors()[0])


def merged_slowly(mesh: vmesh.Mesh, moments: Moments, largest: float) -> set[Region]:
    """Regions of which no two that are each other's cheapest neighbours are left to join."""
    edges = twins.directed_edges(mesh.triangles)
    across = {(e // 3, edges[v, u] // 3) for (u, v), e in edges.items() if (v, u) in edges}
    regions = {Region({t}) for t in range(mesh.n_triangles)}
    while True:
        costs = {
            Region(a | b): error_of(moments, a | b) - error_of(moments, a) - error_of(moments, b)
            for a, b in combinations(regions, 2)
            if any((s, t) in across for s in a for t in b)
        }
        cheap = {union: cost for union, cost in costs.items() if cost < largest}
        best = {
            region: min((u for u in cheap if region < u), key=cheap.__getitem__, default=region)
            for region in regions
        }
        joined = {u for u in cheap if sum(best[r] == u for r in regions if r < u) == 2}
        if not joined:
            return regions
        regions = {r for r in regions if not any(r < u for u in joined)} | joined


@pytest.mark.parametrize("largest", [500.0, 2000.0, 20000.0])
def test_regions_are_those_of_a_search_through_all_pairs(
    coffee: np.ndarray, largest: float
) -> None:
    mesh = vmesh.encode(coffee[100:148, 200:260], vertices=25)
    moments = Moments.of_triangles(mesh, mesh.colors.astype(np.float64))
    regions, found = merge(mesh, moments, largest)
    sets = [Region(np.flatnonzero(regions == i).tolist()) for i in range(regions.max() + 1)]
    assert set(sets) == merged_slowly(mesh, moments, largest)
    assert np.allclose(found.errors(), [error_of(moments, region) for region in sets], atol=1e-6)
    assert len(sets) < mesh.n_triangles
