"""What is measured for a report."""

from __future__ import annotations

import io
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

import vmesh
from tests.pictures import PICTURES, grey_ramp
from tests.report.studies import study_of
from vmesh.arrays import SampleArray, UInt8Array
from vmesh.formats.picture.conversion import flatten
from vmesh.metrics import compare, psnr
from vmesh.report.rivals import RIVALS, Point
from vmesh.report.study import Study

OF_ALL_KINDS: dict[str, SampleArray] = {
    name: PICTURES[name]
    for name in ("one pixel", "one grey pixel", "one column", "grey noise", "disc", "constant")
} | {"16 bits": grey_ramp(20, 30).astype(np.uint16) * 257}


@pytest.fixture(scope="module")
def photograph(coffee: UInt8Array) -> UInt8Array:
    return np.ascontiguousarray(coffee[100:200, 200:350])


@pytest.fixture(scope="module")
def found(photograph: UInt8Array) -> Study:
    return study_of(photograph, vertices=400)


def jpegs(pixels: UInt8Array) -> list[Point]:
    """Every JPEG of a picture that a report may choose from."""
    points = []
    for quality in range(1, 96):
        stream = io.BytesIO()
        Image.fromarray(pixels).save(
            stream, "JPEG", quality=quality, optimize=True, progressive=True
        )
        decoded = np.asarray(Image.open(stream))
        points.append(Point(len(stream.getvalue()), psnr(pixels, decoded)))
    return points


def test_the_mesh_is_the_one_that_encode_makes(found: Study, photograph: UInt8Array) -> None:
    assert found.mesh == vmesh.encode(photograph, vertices=400, effort=1)
    assert found.data == vmesh.dumps(found.mesh)


def test_figures_are_those_of_compare(found: Study, photograph: UInt8Array) -> None:
    rendered = flatten(vmesh.render(found.mesh))
    assert found.closeness == compare(photograph, rendered)
    point = next(point for point in found.curves[0].points if point.n_bytes == len(found.data))
    assert point.psnr == found.closeness["psnr_rgb"]


def test_parts_add_up_to_the_file(found: Study) -> None:
    assert sum(part["bytes"] for part in found.figures["parts"]) == len(found.data)


def test_a_mesh_is_one_of_four_whose_sizes_double(found: Study) -> None:
    sizes = np.array([point.n_bytes for point in found.curves[0].points])
    assert sizes == pytest.approx(len(found.data) * np.array([0.25, 0.5, 1, 2]), rel=0.25)
    assert sizes[2] == len(found.data)


def test_the_largest_file_within_the_bytes_of_the_mesh_stands_for_a_codec(
    found: Study, photograph: UInt8Array
) -> None:
    budgets = [point.n_bytes for point in found.curves[0].points]
    every = jpegs(photograph)
    largest = (max((p for p in every if p.n_bytes <= most), default=None) for most in budgets)
    assert list(found.curves[1].points) == [point for point in largest if point is not None]
    for curve in found.curves[1:]:
        for point in curve.points:
            assert any(0.5 * most < point.n_bytes <= most for most in budgets)


def test_codecs_get_grey_pictures_as_grey_ones() -> None:
    grey = PICTURES["grey noise"]
    image = io.BytesIO()
    Image.fromarray(grey).save(image, "JPEG", quality=95, optimize=True, progressive=True)
    curve = RIVALS[0].curve_of(flatten(grey), [100_000])
    assert curve.points[0].n_bytes == len(image.getvalue())


def test_a_codec_that_pillow_lacks_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    Image.init()
    monkeypatch.delitem(Image.SAVE, "WEBP")
    curves = {curve.codec: curve for curve in study_of(PICTURES["noise"]).curves}
    assert curves["WebP"].points == ()
    assert curves["WebP"].absence == "cannot be written by this Pillow"
    assert curves["JPEG"].points != ()


def test_a_codec_whose_files_are_larger_is_left_out() -> None:
    curves = study_of(PICTURES["one pixel"]).curves
    assert {curve.absence for curve in curves[1:]} == {"has no file as small as these"}


def test_a_codec_that_holds_no_such_picture_is_left_out() -> None:
    strip = np.zeros((1, 65_501, 3), dtype=np.uint8)
    assert RIVALS[0].curve_of(strip, [10_000]).absence == "holds sides of at most 65500 pixels"


def test_pictures_beyond_the_limit_of_pillow_are_measured(
    found: Study, photograph: UInt8Array, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Image, "MAX_IMAGE_PIXELS", 100)
    assert study_of(photograph, vertices=400).curves == found.curves


@pytest.mark.parametrize("method", ["adaptive", "blue-noise"])
@pytest.mark.parametrize("name", OF_ALL_KINDS)
def test_pictures_of_all_kinds_are_measured(name: str, method: str) -> None:
    picture = OF_ALL_KINDS[name]
    found = study_of(picture, method=method)
    rendered = flatten(vmesh.render(found.mesh), found.mesh.depth)
    assert found.closeness["psnr_rgb"] == compare(flatten(picture), rendered)["psnr_rgb"]
    sizes = [point.n_bytes for point in found.curves[0].points]
    assert sizes == sorted(set(sizes))
    assert len(found.data) in sizes


def test_metadata_count_for_no_codec(found: Study, photograph: UInt8Array) -> None:
    told = study_of(photograph, metadata=vmesh.Metadata(xmp=b"<x/>" * 99), vertices=400)
    assert len(told.data) > len(found.data)
    assert told.curves == found.curves


def test_the_same_photograph_gives_the_same_but_for_times(
    found: Study, photograph: UInt8Array
) -> None:
    again = study_of(photograph, vertices=400)
    assert list(again.seconds) == ["encode", "write", "read", "render"]
    assert all(seconds > 0 for seconds in again.seconds.values())
    assert np.array_equal(again.original, found.original)
    assert replace(again, seconds={}, original=found.original) == replace(found, seconds={})


def test_a_goal_that_cannot_be_met_is_an_error(photograph: UInt8Array) -> None:
    with pytest.raises(ValueError, match="the smallest file of this picture takes"):
        study_of(photograph, target_size=20)
