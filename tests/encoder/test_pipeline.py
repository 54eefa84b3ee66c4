"""The encoder as a whole: every picture becomes a sound mesh, and every goal is met."""

from __future__ import annotations

import io
import re
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from PIL import Image

from tests.pictures import (
    PICTURES,
    checkerboard,
    constant,
    disc,
    drawn,
    grey_ramp,
    noise,
    psnr,
    ramp,
    step_edge,
)
from tests.strategies import pictures
from vmesh.arrays import UInt8Array
from vmesh.codec.reader import loads
from vmesh.codec.writer import dumps, metadata_size
from vmesh.encoder.colors import sample_colors
from vmesh.encoder.image import premultiplied_planes
from vmesh.encoder.pipeline import STAGES, count_steps, encode
from vmesh.encoder.settings import MAX_EFFORT, Method, Sampler, Settings
from vmesh.formats.picture.conversion import flatten
from vmesh.limits import MAX_SIDE
from vmesh.mesh import Mesh, Metadata

EFFORTS = range(1, MAX_EFFORT + 1)


@pytest.fixture(scope="module")
def cat(chelsea: UInt8Array) -> UInt8Array:
    """A part of a photograph, 64 x 80 pixels: an eye and fur."""
    return np.ascontiguousarray(chelsea[80:144, 110:190])


@pytest.fixture(scope="module")
def cup(coffee: UInt8Array) -> UInt8Array:
    """A part of a photograph, 96 x 128 pixels: smooth, with sharp edges."""
    return np.ascontiguousarray(coffee[110:206, 170:298])


def check(mesh: Mesh, picture: UInt8Array) -> None:
    """Check that a mesh is sound, that of the picture, and comes back from its file."""
    mesh.check()
    assert (mesh.height, mesh.width) == picture.shape[:2]
    assert mesh.n_components == (1 if picture.ndim == 2 else picture.shape[2])
    vertices = {(x, y) for x, y in mesh.points.tolist()}
    assert {(0, 0), (mesh.width, 0), (0, mesh.height), (mesh.width, mesh.height)} <= vertices
    assert loads(dumps(mesh)) == mesh.canonical()


def psnr_of(picture: UInt8Array, **settings: Any) -> float:
    return psnr(drawn(encode(picture, **settings)), picture)


# --- Every picture --------------------------------------------------------------------------------


@pytest.mark.parametrize("goal", [{}, {"vertices": 4}, {"density": 0.3}, {"density": 1.0}])
@pytest.mark.parametrize("name", PICTURES)
def test_every_picture_becomes_a_sound_mesh(name: str, goal: dict[str, Any]) -> None:
    for effort in (1, 4):
        check(encode(PICTURES[name], effort=effort, **goal), PICTURES[name])


@pytest.mark.parametrize("colors", ["fitted", "sampled"])
@pytest.mark.parametrize("sampler", ["multiclass", "channels"])
@pytest.mark.parametrize("name", PICTURES)
def test_every_picture_becomes_a_sound_mesh_of_blue_noise(
    name: str, sampler: Sampler, colors: str
) -> None:
    chosen: dict[str, Any] = {"method": "blue-noise", "sampler": sampler, "colors": colors}
    goals: tuple[dict[str, Any], ...] = ({}, {"vertices": 4}, {"density": 0.3}, {"density": 1.0})
    for goal in goals:
        mesh = encode(PICTURES[name], **chosen, **goal)
        check(mesh, PICTURES[name])
        assert mesh == mesh.canonical()


@pytest.mark.parametrize("effort", EFFORTS)
def test_every_effort_makes_a_sound_mesh(cat: UInt8Array, effort: int) -> None:
    goals: tuple[dict[str, Any], ...] = ({}, {"vertices": 80})
    for goal in goals:
        check(encode(cat, effort=effort, **goal), cat)


@pytest.mark.parametrize(
    "picture",
    [noise(1, 2), noise(2, 1), noise(1, 3), noise(3, 2000), noise(700, 1, 1), ramp(2, 900)],
    ids=["1 x 2", "2 x 1", "1 x 3", "3 x 2000", "700 x 1", "2 x 900"],
)
@pytest.mark.parametrize("effort", [1, 2, 5])
def test_long_and_tiny_pictures_become_sound_meshes(picture: UInt8Array, effort: int) -> None:
    goals: tuple[dict[str, Any], ...] = ({}, {"vertices": 6}, {"target_size": 150})
    for goal in goals:
        check(encode(picture, effort=effort, **goal), picture)


@settings(max_examples=40)
@given(pictures())
def test_small_pictures_of_any_kind_become_sound_meshes(picture: UInt8Array) -> None:
    check(encode(picture), picture)
    check(encode(picture, quality=100, effort=2), picture)


@pytest.mark.parametrize("color", [(0,), (255,), (90,), (1, 2, 3), (255, 0, 128), (9, 8, 7, 255)])
def test_a_constant_picture_is_drawn_exactly_with_steps_of_one(color: tuple[int, ...]) -> None:
    picture = constant(11, 7, *color)
    for colors in ("fitted", "sampled"):
        mesh = encode(picture, color_step=1, method="blue-noise", colors=colors)
        assert np.array_equal(drawn(mesh).reshape(picture.shape), picture)
    # Levels are chosen without the rounding of the colour transform.
    result = drawn(encode(picture, color_step=1)).reshape(picture.shape)
    assert np.abs(result.astype(int) - picture).max() <= 1


@pytest.mark.parametrize("effort", [1, 5, 9])
@pytest.mark.parametrize("color", [(0,), (77,), (255, 255, 255), (90, 80, 70), (9, 8, 7, 0)])
def test_a_constant_picture_takes_next_to_no_bytes(color: tuple[int, ...], effort: int) -> None:
    mesh = encode(constant(96, 128, *color), effort=effort)
    assert len(dumps(mesh)) < 60
    assert mesh.n_vertices == 4


def test_a_ramp_needs_only_its_corners() -> None:
    assert encode(ramp(64, 64)).n_vertices == 4


def test_an_edge_between_two_colors_is_held_by_few_vertices() -> None:
    picture = step_edge(48, 64)
    mesh = encode(picture, quality=90)
    spread = encode(picture, method="blue-noise", vertices=4 * mesh.n_vertices)
    assert psnr(drawn(mesh), picture) > psnr(drawn(spread), picture)
    assert len(dumps(mesh)) < len(dumps(spread))


# --- Goals ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("effort", [2, 5, 9])
@pytest.mark.parametrize("n", [4, 5, 333, 1000])
def test_the_number_of_vertices_is_met_exactly(cat: UInt8Array, n: int, effort: int) -> None:
    assert encode(cat, vertices=n, effort=effort).n_vertices == n


@pytest.mark.parametrize("effort", [2, 5])
@pytest.mark.parametrize(
    "picture",
    [constant(40, 60, 9), ramp(40, 60), step_edge(40, 60), checkerboard(40, 60, 7)],
    ids=["constant", "ramp", "step edge", "checkerboard"],
)
def test_the_number_of_vertices_is_met_where_there_is_nothing_to_gain(
    picture: UInt8Array, effort: int
) -> None:
    assert encode(picture, vertices=60, effort=effort).n_vertices == 60


@pytest.mark.parametrize("density", [0.01, 0.1, 0.5])
def test_the_density_is_met_exactly(cat: UInt8Array, density: float) -> None:
    assert encode(cat, density=density).n_vertices == round(density * 64 * 80)


@pytest.mark.parametrize("method", ["adaptive", "blue-noise"])
@pytest.mark.parametrize("sampler", ["multiclass", "channels"])
@pytest.mark.parametrize("target", [{"vertices": 500}, {"vertices": 4000}, {"density": 0.02}])
def test_the_number_of_sampled_vertices_is_met_within_two_percent(
    coffee: UInt8Array, sampler: Sampler, target: dict[str, Any], method: Method
) -> None:
    mesh = encode(coffee, method=method, effort=1, sampler=sampler, **target)
    wanted = target.get("vertices") or target["density"] * coffee.shape[0] * coffee.shape[1]
    assert mesh.n_vertices == pytest.approx(wanted, rel=0.02)


@pytest.mark.parametrize("target_size", [150, 400, 1000, 2500])
@pytest.mark.parametrize("effort", [2, 5])
def test_the_size_is_met_from_below(cup: UInt8Array, target_size: int, effort: int) -> None:
    size = len(dumps(encode(cup, target_size=target_size, effort=effort)))
    assert 0.98 * target_size <= size <= target_size


@pytest.mark.parametrize("target_size", [400, 1000, 2500])
def test_the_size_of_a_sampled_mesh_is_met_from_below(cup: UInt8Array, target_size: int) -> None:
    size = len(dumps(encode(cup, target_size=target_size, effort=1)))
    assert 0.98 * target_size <= size <= target_size


@pytest.mark.parametrize("picture", [noise(40, 50), noise(40, 50, 1)[:, :, 0], noise(40, 50, 4)])
def test_the_size_of_noise_is_met_from_below(picture: UInt8Array) -> None:
    size = len(dumps(encode(picture, target_size=500)))
    assert 490 <= size <= 500


@pytest.mark.parametrize("target_size", [1200, 3000])
def test_metadata_count_in_the_size(cup: UInt8Array, target_size: int) -> None:
    # Bytes that nothing compresses.
    metadata = Metadata(icc=noise(1, 800, 1).tobytes(), exif=noise(1, 200, 1, seed=2).tobytes())
    mesh = encode(cup, target_size=target_size, metadata=metadata)
    assert mesh.metadata == metadata
    assert 0.98 * target_size <= len(dumps(mesh)) <= target_size


def test_most_of_a_file_may_be_metadata(cup: UInt8Array) -> None:
    metadata = Metadata(icc=noise(1, 20_000, 1).tobytes())
    mesh = encode(cup, target_size=21_000, metadata=metadata)
    assert 0.98 * 21_000 <= len(dumps(mesh)) <= 21_000
    assert len(dumps(mesh.replaced(metadata=Metadata()))) < 1100


@pytest.mark.parametrize("effort", [1, 5])
@pytest.mark.parametrize(("target_size", "metadata"), [(1, b""), (25, b""), (300, b"x" * 400)])
def test_a_size_too_small_is_refused_with_the_size_it_takes(
    cat: UInt8Array, target_size: int, metadata: bytes, effort: int
) -> None:
    block = bytes(i * i * 31 % 251 for i in range(len(metadata)))
    with pytest.raises(ValueError, match=r"smallest file of this picture takes [0-9]+ bytes") as e:
        encode(cat, target_size=target_size, effort=effort, metadata=Metadata(xmp=block))
    found = re.search(r"takes (\d+) bytes(?:, (\d+) of them metadata)?$", str(e.value))
    assert found is not None
    needed = int(found[1])
    assert needed > target_size
    assert int(found[2] or 0) == metadata_size(Metadata(xmp=block))
    again = encode(cat, target_size=needed, effort=effort, metadata=Metadata(xmp=block))
    assert len(dumps(again)) <= needed


@pytest.mark.parametrize("target_psnr", [22.0, 26.5, 31.0])
@pytest.mark.parametrize("effort", [2, 5])
def test_the_psnr_is_met_from_above(cup: UInt8Array, target_psnr: float, effort: int) -> None:
    reached = psnr_of(cup, target_psnr=target_psnr, effort=effort)
    assert target_psnr <= reached <= target_psnr + 0.1


@pytest.mark.parametrize("target_psnr", [36.0, 40.0])
def test_a_psnr_that_many_vertices_reach_is_met(cat: UInt8Array, target_psnr: float) -> None:
    assert psnr_of(cat, density=0.4) > target_psnr + 1
    assert target_psnr <= psnr_of(cat, target_psnr=target_psnr) <= target_psnr + 0.1


@pytest.mark.parametrize("effort", [1, 5])
@pytest.mark.parametrize("picture", [constant(20, 30, 90), constant(9, 9, 1, 2, 3)])
def test_a_picture_without_any_error_reaches_every_psnr(picture: UInt8Array, effort: int) -> None:
    mesh = encode(picture, target_psnr=50.0, effort=effort)
    assert np.array_equal(drawn(mesh).reshape(picture.shape), picture)


def test_a_psnr_out_of_reach_of_the_colors_steps_is_refused_with_what_is_reached() -> None:
    with pytest.raises(ValueError, match=r"reaches [0-9.]+ dB with colors in such steps, not 60"):
        encode(noise(20, 30), target_psnr=60.0, color_step=30)


@pytest.mark.parametrize("effort", [1, 5])
def test_a_higher_quality_is_never_further_from_the_picture(cup: UInt8Array, effort: int) -> None:
    meshes = [encode(cup, quality=q, effort=effort) for q in (0, 10, 30, 50, 70, 90, 100)]
    reached = [psnr(drawn(mesh), cup) for mesh in meshes]
    assert all(a < b for a, b in pairwise(reached))
    sizes = [len(dumps(mesh)) for mesh in meshes]
    assert all(a < b for a, b in pairwise(sizes))


@pytest.mark.parametrize("part", ["cat", "cup"])
def test_the_highest_quality_is_closer_to_the_picture_than_a_jpeg_of_more_bytes(
    part: str, request: pytest.FixtureRequest
) -> None:
    picture: UInt8Array = request.getfixturevalue(part)
    mesh = encode(picture, quality=100)
    jpeg = io.BytesIO()
    Image.fromarray(picture).save(jpeg, "JPEG", quality=90)
    assert len(dumps(mesh)) < len(jpeg.getvalue())
    assert psnr(drawn(mesh), picture) > psnr(np.asarray(Image.open(jpeg)), picture)


def test_a_quality_is_about_the_same_at_every_effort(cat: UInt8Array) -> None:
    lower, higher = (psnr_of(cat, quality=quality) for quality in (60, 90))
    for effort in (2, 5, 9):
        assert lower < psnr_of(cat, quality=75, effort=effort) < higher


def test_more_effort_is_better_at_the_same_number_of_vertices(
    cat: UInt8Array, cup: UInt8Array, coffee: UInt8Array
) -> None:
    # What little there is to gain on one small picture is up to chance.
    parts = (cat, cup[:64, :80], coffee[:64, :80], coffee[200:264, 300:380])
    reached = [
        np.mean([psnr_of(part, vertices=150, effort=effort) for part in parts])
        for effort in (1, 3, 5, 9)
    ]
    assert all(a < b for a, b in pairwise(reached))


def test_adaptive_meshes_are_better_with_half_the_vertices_and_fewer_bytes(
    cup: UInt8Array,
) -> None:
    plain = encode(cup, method="blue-noise", vertices=400)
    adaptive = encode(cup, vertices=plain.n_vertices // 2)
    assert psnr(drawn(adaptive), cup) > psnr(drawn(plain), cup)
    assert len(dumps(adaptive)) < len(dumps(plain))


@pytest.mark.parametrize("method", ["adaptive", "blue-noise"])
def test_more_vertices_are_closer_to_the_picture(cup: UInt8Array, method: str) -> None:
    reached = [psnr_of(cup, method=method, vertices=n) for n in (60, 250, 1000)]
    assert all(a < b for a, b in pairwise(reached))


def test_a_smaller_gamma_gives_more_vertices(chelsea: UInt8Array) -> None:
    gammas = (2.0, 1.5, 1.0, 0.8, 0.6, 0.4)
    counts = [encode(chelsea, method="blue-noise", gamma=g).n_vertices for g in gammas]
    assert counts == sorted(counts)
    assert len(set(counts)) == len(counts)


def test_fitted_colors_are_closer_to_the_picture_than_sampled_ones(cup: UInt8Array) -> None:
    fitted, sampled = (
        psnr_of(cup, method="blue-noise", vertices=300, colors=colors)
        for colors in ("fitted", "sampled")
    )
    assert fitted > sampled


@pytest.mark.parametrize("method", ["adaptive", "blue-noise"])
def test_a_finer_color_step_is_closer_to_the_picture(cup: UInt8Array, method: Method) -> None:
    reached = [psnr_of(cup, method=method, vertices=500, color_step=step) for step in (64, 16, 1)]
    assert reached == sorted(reached)
    assert encode(cup, method=method, vertices=50, color_step=24).lattice.steps[0] == 24


# --- The same again -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "chosen",
    [
        {"vertices": 200},
        {"quality": 60, "effort": 3},
        {"target_size": 500},
        {"target_psnr": 25.0},
        {"quality": 40, "effort": 1},
        {"method": "blue-noise", "vertices": 200},
    ],
)
def test_the_same_picture_and_settings_give_the_same_bytes(
    cat: UInt8Array, chosen: dict[str, Any]
) -> None:
    first = dumps(encode(cat, **chosen))
    assert dumps(encode(np.asfortranarray(cat), **chosen)) == first
    with ThreadPoolExecutor(2) as pool:
        assert set(pool.map(lambda _: dumps(encode(cat, **chosen)), range(2))) == {first}
    assert dumps(encode(cat, seed=4, **chosen)) != first


@pytest.mark.parametrize("seed", [2**31, 2**62, 2**63, 2**64 + 5])
def test_a_seed_of_any_size_is_taken(seed: int) -> None:
    first, again = (dumps(encode(noise(16, 16), seed=seed, density=0.1)) for _ in range(2))
    assert first == again


@pytest.mark.parametrize("method", ["adaptive", "blue-noise"])
def test_a_grey_picture_is_the_same_with_and_without_its_third_dimension(method: Method) -> None:
    picture = grey_ramp(20, 30)
    assert encode(picture, method=method) == encode(picture[:, :, None], method=method)
    assert encode(picture, method=method).lattice.n_components == 1


# --- Alpha ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("chosen", [{}, {"effort": 1}, {"method": "blue-noise"}])
@pytest.mark.parametrize("hidden", [(255, 0, 0), (0, 255, 0), (255, 255, 255)])
def test_colors_of_transparent_pixels_leave_no_trace(
    hidden: tuple[int, int, int], chosen: dict[str, Any]
) -> None:
    visible = (20, 90, 160)
    plain = encode(disc(60, 60, visible, visible), **chosen)
    assert dumps(encode(disc(60, 60, hidden, visible), **chosen)) == dumps(plain)


@pytest.mark.parametrize("chosen", [{}, {"effort": 1}, {"method": "blue-noise"}])
def test_what_is_hidden_in_a_fully_transparent_picture_leaves_no_trace(
    chosen: dict[str, Any],
) -> None:
    picture = noise(30, 40, 4)
    picture[:, :, 3] = 0
    data = dumps(encode(picture, **chosen))
    assert data == dumps(encode(np.zeros_like(picture), **chosen))
    assert len(data) < 60


@pytest.mark.parametrize("effort", [1, 5])
def test_transparent_surroundings_cost_next_to_nothing(cat: UInt8Array, effort: int) -> None:
    framed = np.zeros((128, 160, 4), dtype=np.uint8)
    framed[32:96, 40:120] = np.dstack([cat, np.full(cat.shape[:2], 255, dtype=np.uint8)])
    own, around = (len(dumps(encode(p, quality=60, effort=effort))) for p in (cat, framed))
    assert around < 1.6 * own + 200


@pytest.mark.parametrize("effort", [1, 5])
def test_an_opaque_picture_costs_little_more_than_one_without_alpha(
    cat: UInt8Array, effort: int
) -> None:
    opaque = np.dstack([cat, np.full(cat.shape[:2], 255, dtype=np.uint8)])
    plain, with_alpha = (encode(p, vertices=200, effort=effort) for p in (cat, opaque))
    assert len(dumps(with_alpha)) < 1.15 * len(dumps(plain))


# --- Progress, metadata and what is refused -------------------------------------------------------


@pytest.mark.parametrize("effort", EFFORTS)
def test_progress_names_the_stages_in_order(effort: int) -> None:
    stages: list[str] = []
    encode(noise(24, 24), effort=effort, progress=stages.append)
    expected = STAGES[:-1] if effort > 1 else ("sampling", "colors")
    assert tuple(dict.fromkeys(stages)) == expected
    assert stages == sorted(stages, key=STAGES.index)
    assert len(stages) <= 2 * count_steps(Settings(effort=effort))


def test_progress_names_the_search_for_a_size_last() -> None:
    stages: list[str] = []
    encode(noise(24, 24), target_size=200, progress=stages.append)
    assert tuple(dict.fromkeys(stages)) == STAGES


def test_progress_names_no_stages_that_blue_noise_does_without() -> None:
    stages: list[str] = []
    encode(noise(24, 24), method="blue-noise", progress=stages.append)
    assert stages == ["sampling", "colors"]


@pytest.mark.parametrize("method", ["adaptive", "blue-noise"])
def test_metadata_travel_with_the_mesh(method: Method) -> None:
    metadata = Metadata(icc=b"profile")
    assert encode(noise(8, 8), method=method, metadata=metadata).metadata == metadata
    assert encode(noise(8, 8), method=method).metadata == Metadata()


def test_goals_that_contradict_each_other_are_refused() -> None:
    with pytest.raises(ValueError, match="expected one of quality and vertices, not both"):
        encode(noise(8, 8), quality=50, vertices=10)
    with pytest.raises(ValueError, match="expected method adaptive with quality"):
        encode(noise(8, 8), method="blue-noise", quality=50)


@pytest.mark.parametrize("dtype", [np.int16, np.int32, np.float32, np.float64, bool, object])
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
    rows: list[UInt8Array] = list(picture)
    assert encode(rows) == encode(picture)
    view = picture[::2, ::-1]
    assert encode(view) == encode(view.copy())


def test_the_picture_is_left_as_it_is() -> None:
    picture = noise(12, 10, 4)
    before = picture.copy()
    encode(picture)
    assert np.array_equal(picture, before)


def test_premultiplied_planes_are_multiplied_by_alpha() -> None:
    picture = np.array([[[200, 100, 0, 255], [200, 100, 0, 0], [200, 101, 1, 128]]], np.uint8)
    assert premultiplied_planes(picture)[:, 0].tolist() == [
        [200, 0, 100], [100, 0, 51], [0, 0, 1], [255, 0, 128],
    ]  # fmt: skip


def test_sampled_colors_are_those_of_the_vertices_pixels() -> None:
    picture = noise(3, 4)
    vertices = np.array([[0, 0], [1, 1], [7, 5], [8, 6], [8, 0], [3, 6]], dtype=np.int32)
    pixels = [(0, 0), (0, 0), (2, 3), (2, 3), (0, 3), (2, 1)]
    expected = [picture[y, x].tolist() for y, x in pixels]
    assert sample_colors(picture, vertices, 2).tolist() == expected


@pytest.mark.parametrize(
    "options",
    [
        {"vertices": 300},
        {"quality": 70},
        {"target_psnr": 31.0},
        {"vertices": 300, "effort": 1},
        {"vertices": 300, "method": "blue-noise"},
    ],
    ids=str,
)
def test_sixteen_bits_are_encoded_as_well_as_eight(
    cup: UInt8Array, options: dict[str, Any]
) -> None:
    plain = encode(cup, **options)
    deep = encode(cup.astype(np.uint16) * 257, **options)
    assert (plain.depth, deep.depth) == (8, 16)
    shown = flatten(drawn(loads(dumps(deep))))
    assert abs(psnr(shown, cup) - psnr(drawn(plain), cup)) < 0.5
    assert len(dumps(deep)) < 1.1 * len(dumps(plain))


def test_more_bits_hold_what_eight_would_round_away() -> None:
    y, x = np.mgrid[:48, :64]
    soft = (30_000 + 150 * np.sin(x / 9) + 2 * y).astype(np.uint16)
    shown = drawn(encode(soft, vertices=400))[:, :, 0].astype(float)
    assert np.abs(shown - soft).max() < 60  # of 257 in a level of eight bits


def test_sixteen_bits_with_alpha_are_encoded(cup: UInt8Array) -> None:
    alpha = np.full(cup.shape[:2], 65_535, dtype=np.uint16)
    alpha[:, :40] = 0
    deep = np.dstack([cup.astype(np.uint16) * 257, alpha])
    mesh = encode(deep, vertices=300)
    mesh.check()
    shown = drawn(mesh)
    assert abs(shown[:, 60:, 3].astype(int) - 65_535).max() < 2000
    assert shown[:, :30, 3].max() < 2000
