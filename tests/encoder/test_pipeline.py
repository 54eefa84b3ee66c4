from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tests.pictures import PICTURES, constant, disc, drawn, grey_ramp, noise, psnr, ramp
from vmesh.arrays import UInt8Array
from vmesh.codec.writer import dumps
from vmesh.encoder.colors import fit_colors, sample_colors
from vmesh.encoder.image import as_image, visible_planes
from vmesh.encoder.pipeline import STAGES, encode
from vmesh.kernels.delaunay import delaunay
from vmesh.mesh import MAX_SIDE, Metadata


@pytest.mark.parametrize("colors", ["fitted", "sampled"])
@pytest.mark.parametrize("sampler", ["multiclass", "channels"])
@pytest.mark.parametrize("name", PICTURES)
def test_every_picture_becomes_a_valid_canonical_mesh(name: str, sampler: str, colors: str) -> None:
    picture = PICTURES[name]
    for settings in ({}, {"vertices": 4}, {"density": 0.3}, {"density": 1.0}):
        chosen: dict[str, Any] = {"sampler": sampler, "colors": colors, **settings}
        mesh = encode(picture, **chosen)
        mesh.check()
        assert mesh == mesh.canonical()
        assert (mesh.height, mesh.width) == picture.shape[:2]
        assert mesh.n_components == (1 if picture.ndim == 2 else picture.shape[2])


@pytest.mark.parametrize("name", PICTURES)
def test_the_corners_of_the_canvas_are_vertices(name: str) -> None:
    mesh = encode(PICTURES[name])
    present = {(x, y) for x, y in mesh.points.tolist()}
    assert {(0, 0), (mesh.width, 0), (0, mesh.height), (mesh.width, mesh.height)} <= present


def test_the_same_picture_and_seed_give_the_same_bytes(chelsea: UInt8Array) -> None:
    part = chelsea[:120, :160]
    first = dumps(encode(part, vertices=800, seed=3))
    assert dumps(encode(part.copy(), vertices=800, seed=3)) == first
    assert dumps(encode(np.asfortranarray(part), vertices=800, seed=3)) == first
    assert dumps(encode(part, vertices=800, seed=4)) != first


@pytest.mark.parametrize("seed", [2**31, 2**62, 2**63, 2**64 + 5])
def test_a_seed_of_any_size_is_taken(seed: int) -> None:
    first, again = (dumps(encode(noise(16, 16), seed=seed, density=0.1)) for _ in range(2))
    assert first == again


@pytest.mark.parametrize("sampler", ["multiclass", "channels"])
@pytest.mark.parametrize("target", [{"vertices": 500}, {"vertices": 4000}, {"density": 0.02}])
def test_the_number_of_vertices_is_met_within_two_percent(
    coffee: UInt8Array, sampler: str, target: dict[str, Any]
) -> None:
    mesh = encode(coffee, sampler=sampler, **target)
    wanted = target.get("vertices") or target["density"] * coffee.shape[0] * coffee.shape[1]
    assert mesh.n_vertices == pytest.approx(wanted, rel=0.02)


def test_a_smaller_gamma_gives_more_vertices(chelsea: UInt8Array) -> None:
    counts = [encode(chelsea, gamma=g).n_vertices for g in (2.0, 1.5, 1.0, 0.8, 0.6, 0.4)]
    assert counts == sorted(counts)
    assert len(set(counts)) == len(counts)


def test_more_vertices_are_closer_to_the_picture(coffee: UInt8Array) -> None:
    qualities = [psnr(drawn(encode(coffee, vertices=n)), coffee) for n in (500, 2000, 8000)]
    assert qualities[0] + 1 < qualities[1] < qualities[2] - 1


def test_fitted_colors_are_closer_to_the_picture_than_sampled_ones(coffee: UInt8Array) -> None:
    fitted, sampled = (
        psnr(drawn(encode(coffee, vertices=3000, colors=colors)), coffee)
        for colors in ("fitted", "sampled")
    )
    assert fitted > sampled + 1


def test_a_finer_color_step_is_closer_to_the_picture(coffee: UInt8Array) -> None:
    qualities = [
        psnr(drawn(encode(coffee, vertices=3000, color_step=step)), coffee) for step in (64, 16, 1)
    ]
    assert qualities == sorted(qualities)


@pytest.mark.parametrize("color", [(0,), (255,), (90,), (1, 2, 3), (255, 0, 128), (9, 8, 7, 255)])
def test_a_constant_picture_is_drawn_exactly_with_steps_of_one(color: tuple[int, ...]) -> None:
    picture = constant(11, 7, *color)
    for settings in ({}, {"vertices": 30}, {"colors": "sampled"}):
        chosen: dict[str, Any] = {"color_step": 1, **settings}
        result = drawn(encode(picture, **chosen))
        assert np.array_equal(result.reshape(picture.shape), picture)


def test_a_ramp_needs_only_its_corners() -> None:
    picture = ramp(64, 64)
    assert psnr(drawn(encode(picture, vertices=4, color_step=1)), picture) > 45


def test_a_grey_picture_is_the_same_with_and_without_its_third_dimension() -> None:
    picture = grey_ramp(20, 30)
    assert encode(picture) == encode(picture[:, :, None])
    assert encode(picture).lattice.n_components == 1


@pytest.mark.parametrize("colors", ["fitted", "sampled"])
@pytest.mark.parametrize("hidden", [(255, 0, 0), (0, 255, 0), (255, 255, 255)])
def test_colors_of_transparent_pixels_do_not_show(
    hidden: tuple[int, int, int], colors: str
) -> None:
    visible = (20, 90, 160)
    settings: dict[str, Any] = {"density": 0.05, "colors": colors}
    plain = encode(disc(60, 60, visible, visible), **settings)
    tricky = encode(disc(60, 60, hidden, visible), **settings)
    assert np.array_equal(plain.vertices, tricky.vertices)
    first, second = drawn(plain), drawn(tricky)
    assert np.array_equal(first[:, :, 3], second[:, :, 3])
    # As seen on any background; alpha reaches a little beyond the visible pixels.
    alpha = first[:, :, 3:] / 255
    difference = np.abs(first[:, :, :3].astype(float) - second[:, :, :3]) * alpha
    assert difference.max() <= 1


def test_progress_names_the_stages_in_order() -> None:
    stages: list[str] = []
    encode(noise(8, 8), method="adaptive", progress=stages.append)
    assert tuple(stages) == STAGES
    stages.clear()
    encode(noise(8, 8), progress=stages.append)
    assert tuple(stages) == tuple(stage for stage in STAGES if stage != "thinning")


def test_metadata_travel_with_the_mesh() -> None:
    metadata = Metadata(icc=b"profile")
    assert encode(noise(8, 8), metadata=metadata).metadata == metadata
    assert encode(noise(8, 8)).metadata == Metadata()


@pytest.mark.parametrize("dtype", [np.uint16, np.int32, np.float32, np.float64, bool, object])
def test_a_picture_of_another_dtype_is_refused(dtype: type) -> None:
    with pytest.raises(TypeError, match="uint8"):
        encode(np.zeros((4, 4, 3), dtype=dtype))


@pytest.mark.parametrize(
    "shape", [(), (4,), (4, 4, 2), (4, 4, 5), (4, 4, 3, 1), (0, 4), (4, 0, 3), (0, 0, 4)]
)
def test_a_picture_of_another_shape_is_refused(shape: tuple[int, ...]) -> None:
    with pytest.raises(ValueError, match="expected a picture"):
        encode(np.zeros(shape, dtype=np.uint8))


def test_a_picture_too_wide_for_a_file_is_refused() -> None:
    with pytest.raises(ValueError, match="pixels a side"):
        encode(np.zeros((1, MAX_SIDE + 1), dtype=np.uint8))


def test_lists_and_views_are_taken() -> None:
    picture = noise(12, 10)
    assert as_image(picture[::-1, ::2]).flags.c_contiguous
    assert encode(picture[::2, ::-1]) == encode(picture[::2, ::-1].copy())


def test_the_picture_is_left_as_it_is() -> None:
    picture = noise(12, 10, 4)
    before = picture.copy()
    encode(picture)
    assert np.array_equal(picture, before)


def test_visible_planes_are_multiplied_by_alpha() -> None:
    picture = np.array([[[200, 100, 0, 255], [200, 100, 0, 0], [200, 101, 1, 128]]], np.uint8)
    assert visible_planes(picture)[:, 0].tolist() == [
        [200, 0, 100], [100, 0, 51], [0, 0, 1], [255, 0, 128],
    ]  # fmt: skip


def test_sampled_colors_are_those_of_the_vertices_pixels() -> None:
    picture = noise(3, 4)
    vertices = np.array([[0, 0], [1, 1], [7, 5], [8, 6], [8, 0], [3, 6]], dtype=np.int32)
    pixels = [(0, 0), (0, 0), (2, 3), (2, 3), (0, 3), (2, 1)]
    expected = [picture[y, x].tolist() for y, x in pixels]
    assert sample_colors(picture, vertices, 2).tolist() == expected


def test_a_fit_to_a_mesh_drawn_earlier_finds_its_colors() -> None:
    mesh = encode(noise(24, 24), vertices=25)
    # A plane function of the position is held exactly by any mesh.
    x, y = mesh.points.T
    exact = np.stack([4 * x + 20, 250 - 5 * y, 60 + 2 * x + 3 * y], axis=1)
    rows, columns = np.mgrid[:24, :24] + 0.5
    planes = [4 * columns + 20, 250 - 5 * rows, 60 + 2 * columns + 3 * rows]
    picture = np.rint(np.stack(planes, axis=2)).astype(np.uint8)
    triangles = delaunay(mesh.vertices)
    fitted = fit_colors(picture, mesh.vertices, triangles, mesh.unit)
    assert np.abs(fitted - exact).max() < 4
