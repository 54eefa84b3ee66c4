from __future__ import annotations

import numpy as np
import pytest

from vmesh.arrays import UInt8Array, UInt16Array
from vmesh.encoder.image import premultiplied_planes
from vmesh.encoder.salience import ONE, compute_salience
from vmesh.encoder.sampling import diffusion_tables, sample
from vmesh.encoder.settings import Diffusion, Sampler


def salience_of(picture: UInt8Array) -> UInt16Array:
    return compute_salience(premultiplied_planes(picture))


@pytest.mark.parametrize("sampler", ["multiclass", "channels"])
@pytest.mark.parametrize("diffusion", ["zhou-fang", "ostromoukhov"])
@pytest.mark.parametrize("n_points", [300, 1500, 6000, 30_000])
def test_as_many_points_are_found_as_were_asked_for(
    chelsea: UInt8Array, sampler: Sampler, diffusion: Diffusion, n_points: int
) -> None:
    samples = sample(salience_of(chelsea), n_points=n_points, sampler=sampler, diffusion=diffusion)
    assert samples.n_points == pytest.approx(n_points, rel=0.02)
    assert len(samples.vertices()) == samples.n_points


@pytest.mark.parametrize("n_points", [20, 31, 61, 92, 123])
def test_a_small_picture_never_gets_many_times_the_points(
    coffee: UInt8Array, n_points: int
) -> None:
    salience = salience_of(coffee[100:196, 200:264])
    samples = sample(salience, n_points=n_points, sampler="channels")
    assert samples.n_points == pytest.approx(n_points, rel=0.1)


def test_more_points_than_the_salience_holds_are_found_all_the_same() -> None:
    salience = np.zeros((1, 60, 60), dtype=np.uint16)
    salience[0, 30, 30] = ONE
    assert sample(salience, n_points=900).n_points == pytest.approx(900, rel=0.02)


def test_a_picture_without_salience_takes_evenly_spread_points() -> None:
    samples = sample(np.zeros((3, 64, 64), dtype=np.uint16), n_points=500)
    assert samples.n_points == pytest.approx(500, rel=0.02)
    quarters = [half for row in np.split(samples.classes, 2) for half in np.split(row, 2, axis=1)]
    counts = [np.count_nonzero(quarter) for quarter in quarters]
    assert min(counts) > 0.8 * max(counts)


def test_without_salience_and_without_a_number_only_the_corners_remain() -> None:
    samples = sample(np.zeros((1, 9, 9), dtype=np.uint16))
    assert samples.vertices().tolist() == [[0, 0], [18, 0], [0, 18], [18, 18]]


def test_planes_sampled_together_never_share_a_pixel(chelsea: UInt8Array) -> None:
    together = sample(salience_of(chelsea)).classes
    assert set(np.unique(together).tolist()) == {0, 1, 2, 4}


def test_planes_sampled_together_give_more_points_than_each_for_itself(
    chelsea: UInt8Array,
) -> None:
    salience = salience_of(chelsea)
    together, apart = sample(salience), sample(salience, sampler="channels")
    assert together.n_points > 1.1 * apart.n_points
    # Each for itself, two planes often choose the same pixel.
    assert set(np.unique(apart.classes).tolist()) == set(range(8))


def test_vertices_are_distinct_in_raster_order_on_centres_and_on_the_border(
    chelsea: UInt8Array,
) -> None:
    height, width = chelsea.shape[:2]
    vertices = sample(salience_of(chelsea), n_points=3000).vertices()
    keys = (vertices[:, 1].astype(np.int64) << 32) | vertices[:, 0]
    assert (np.diff(keys) > 0).all()
    x, y = vertices.T
    on_border = (x == 0) | (y == 0) | (x == 2 * width) | (y == 2 * height)
    assert (vertices[~on_border] % 2 == 1).all()
    inside = vertices[~on_border]
    assert (inside >= 3).all()
    assert (inside <= [2 * width - 3, 2 * height - 3]).all()
    for corner in ((0, 0), (2 * width, 0), (0, 2 * height), (2 * width, 2 * height)):
        assert (vertices == corner).all(axis=1).sum() == 1


@pytest.mark.parametrize("diffusion", ["zhou-fang", "ostromoukhov"])
def test_the_published_coefficients_are_shares_of_the_whole(diffusion: Diffusion) -> None:
    weights, strengths = diffusion_tables(diffusion)
    assert weights.shape == (256, 3)
    assert (weights >= 0).all()
    assert (abs(weights.sum(axis=1) - 65536) <= 3).all()
    assert np.array_equal(weights, weights[::-1])
    assert ((strengths >= 0) & (strengths <= 65536)).all()
    assert np.array_equal(strengths, strengths[::-1])
    assert strengths.any() == (diffusion == "zhou-fang")
