"""The remesher: sound after each of its stages, and never further from the picture than before."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from tests import twins
from tests.pictures import PICTURES, checkerboard, disc, noise, step_edge
from tests.strategies import pictures
from tests.surfaces import check_mesh, evenly
from vmesh.arrays import Int32Array, UInt8Array
from vmesh.encoder.colors import fit_components, sample_colors
from vmesh.encoder.draft import UNIT
from vmesh.encoder.effort import Effort
from vmesh.encoder.image import premultiplied_planes, weighted
from vmesh.encoder.proposals import propose
from vmesh.encoder.remeshing import Remesher
from vmesh.encoder.settings import Settings
from vmesh.mesh.canonical_order import raster_keys

EFFORT = Effort(density=0.1, max_rounds=3, least_gain=0.0, share_decay=0.8)


def draft_of(image: UInt8Array, n: int, effort: Effort = EFFORT) -> Remesher:
    """A draft that starts from about n sampled vertices."""
    return Remesher(weighted(image), proposal(image, n), effort)


def proposal(image: UInt8Array, n: int) -> Int32Array:
    return propose(weighted(image), Settings(vertices=max(4, n)))[1].vertices()


def check_mesh_of(draft: Remesher, image: UInt8Array) -> None:
    """Check the mesh that a draft has after a stage: its vertices in raster order on centres."""
    vertices, triangles = draft.geometry()
    assert draft.n_vertices == len(vertices)
    assert (np.diff(raster_keys(vertices)) > 0).all()
    check_mesh(vertices.astype(np.int64), triangles, image.shape[1], image.shape[0])
    inside = (vertices > 0).all(axis=1) & (vertices < 2 * np.array(image.shape[1::-1])).all(axis=1)
    assert (vertices[inside] % 2 == 1).all()


def run_all_stages(
    image: UInt8Array, n_start: int, n: int, check: Callable[[Remesher, UInt8Array], None]
) -> None:
    draft = draft_of(image, n_start)
    check(draft, image)
    for share in (2, 1):
        draft.thin(share * n, lambda: None)
        check(draft, image)
    draft.refine(draft.n_vertices, lambda: check(draft, image))
    for change in (1.0, 1.3, 0.7, 1.02, 0.5):
        draft.resize(max(4, round(change * draft.n_vertices)))
        check(draft, image)


@pytest.mark.parametrize("n", [4, 40, 200])
def test_the_mesh_of_a_photograph_is_sound_after_every_stage(chelsea: UInt8Array, n: int) -> None:
    run_all_stages(np.ascontiguousarray(chelsea[90:138, 110:174]), 600, n, check_mesh_of)


@pytest.mark.parametrize(
    "image",
    [
        step_edge(40, 50),
        checkerboard(30, 36, 5)[:, :, None],
        disc(40, 44, (255, 0, 0), (20, 90, 160)),
        noise(2, 150),
        noise(150, 2, 4),
        noise(1, 80),
        np.full((30, 20, 3), 80, dtype=np.uint8),
    ],
    ids=["step edge", "checkerboard", "disc", "flat", "tall", "one row", "constant"],
)
def test_the_mesh_of_a_synthetic_picture_is_sound_after_every_stage(image: UInt8Array) -> None:
    run_all_stages(image, image.shape[0] * image.shape[1] // 3, 30, check_mesh_of)


@hypothesis_settings(max_examples=40)
@given(pictures(), st.floats(0.1, 1.0), st.integers(4, 40))
def test_the_mesh_of_a_small_picture_is_sound_after_every_stage(
    image: UInt8Array, density: float, n: int
) -> None:
    n_start = round(density * image.shape[0] * image.shape[1])
    run_all_stages(image, n_start, n, check_mesh_of)


def least_error(image: UInt8Array, vertices: Int32Array, triangles: Int32Array) -> float:
    """Squared error of a mesh in the colours that leave the least, alpha and colours alike."""
    planes = np.ascontiguousarray(premultiplied_planes(image).transpose(1, 2, 0))
    start = sample_colors(planes, vertices, UNIT)
    weights = np.ones(image.shape[:2])
    colors, _ = fit_components(planes, weights, vertices, triangles, UNIT, start)
    errors = twins.triangle_errors(
        vertices.astype(np.int64), triangles.tolist(), colors, evenly(planes)
    )
    return sum(errors)


@pytest.mark.parametrize("n_components", [1, 3, 4])
def test_a_draft_knows_its_error_after_every_stage(chelsea: UInt8Array, n_components: int) -> None:
    def check_error(draft: Remesher, image: UInt8Array) -> None:
        # Up to where the fit of the colours ends.
        assert draft.error == pytest.approx(least_error(image, *draft.geometry()), rel=2e-3)

    part = chelsea[90:138, 110:174]
    fade = np.broadcast_to(np.linspace(0, 255, 64).astype(np.uint8), part.shape[:2])
    image = np.ascontiguousarray(np.dstack([part, fade])[:, :, :n_components])
    run_all_stages(image, 600, 60, check_error)


@pytest.mark.parametrize("n", [4, 5, 17, 100, 599])
def test_thinning_stops_at_the_number_wanted(chelsea: UInt8Array, n: int) -> None:
    image = np.ascontiguousarray(chelsea[90:138, 110:174])
    draft = draft_of(image, 600)
    draft.thin(n, lambda: None)
    assert draft.n_vertices == n


@pytest.mark.parametrize("name", PICTURES)
def test_every_picture_can_be_thinned_to_its_corners(name: str) -> None:
    image = PICTURES[name].reshape(*PICTURES[name].shape[:2], -1)
    draft = draft_of(image, image.shape[0] * image.shape[1])
    draft.thin(4, lambda: None)
    width, height = image.shape[1], image.shape[0]
    corners = [[0, 0], [2 * width, 0], [0, 2 * height], [2 * width, 2 * height]]
    assert draft.geometry()[0].tolist() == corners


def test_thinning_to_more_than_there_are_changes_nothing() -> None:
    image = noise(20, 30)
    vertices = proposal(image, 100)
    draft = Remesher(weighted(image), vertices, EFFORT)
    draft.thin(1000, lambda: None)
    assert np.array_equal(draft.geometry()[0], vertices)


def test_thinning_stops_at_the_error_or_the_cost_allowed(chelsea: UInt8Array) -> None:
    image = np.ascontiguousarray(chelsea[90:138, 110:174])
    errors = []
    for allowed in (2e5, 1e6, 4e6):
        draft = draft_of(image, 900)
        draft.thin(4, lambda: None, max_error=allowed)
        assert allowed <= draft.error < 2 * allowed
        errors.append(draft.n_vertices)
    assert errors == sorted(errors, reverse=True)
    counts = []
    for cost in (500.0, 5000.0, 50_000.0):
        draft = draft_of(image, 900)
        draft.thin(4, lambda: None, max_cost=cost)
        counts.append(draft.n_vertices)
    assert counts[0] > counts[1] > counts[2] > 4


def test_the_error_falls_with_the_rounds_of_refinement(chelsea: UInt8Array) -> None:
    image = np.ascontiguousarray(chelsea[60:156, 100:228])
    draft = draft_of(image, 1500, Effort(0.1, max_rounds=6, least_gain=0.0, share_decay=0.85))
    draft.thin(250, lambda: None)
    errors = [draft.error]
    draft.refine(250, lambda: errors.append(draft.error))
    assert draft.n_vertices == 250
    assert len(errors) == 8
    assert errors[1] < 0.9 * errors[0]
    assert all(b < 1.02 * a for a, b in pairwise(errors))
    assert errors[-1] < 0.92 * errors[1]


def test_refinement_ends_when_it_gains_too_little(chelsea: UInt8Array) -> None:
    image = np.ascontiguousarray(chelsea[60:156, 100:228])
    n_rounds = []
    for least_gain in (0.0, 0.5, 10.0):
        effort = Effort(0.1, max_rounds=30, least_gain=least_gain, share_decay=0.85)
        draft = draft_of(image, 1000, effort)
        draft.thin(100, lambda: None)
        rounds = iter(range(100))
        draft.refine(100, partial(next, rounds))
        n_rounds.append(next(rounds))
    assert n_rounds[0] > n_rounds[1] >= n_rounds[2] > 3


@pytest.mark.parametrize("change", [0.5, 0.9, 0.99, 1.01, 1.1, 1.5])
def test_a_draft_takes_the_size_it_is_given(chelsea: UInt8Array, change: float) -> None:
    image = np.ascontiguousarray(chelsea[60:156, 100:228])
    draft = draft_of(image, 1000)
    draft.thin(200, lambda: None)
    before = draft.error
    draft.resize(round(change * 200))
    assert draft.n_vertices == round(change * 200)
    assert (draft.error < before) or change < 1
    draft.resize(4)
    assert draft.n_vertices == 4


@pytest.mark.parametrize("n_components", [1, 3, 4])
def test_colors_that_cannot_be_seen_do_not_count(n_components: int) -> None:
    image = noise(30, 30, n_components)
    if n_components == 4:
        image[:, 15:, 3] = 0
    draft = draft_of(image, 200)
    draft.thin(80, lambda: None)
    x = draft.geometry()[0][:, 0]
    share = np.count_nonzero(x > 30) / len(x)
    assert share < 0.25 if n_components == 4 else 0.35 < share < 0.65
