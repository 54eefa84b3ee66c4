"""Rendering to pixels and writing image files."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import vmesh
from tests.pictures import share_apart
from vmesh.formats.raster.rendering import write_raster
from vmesh.metrics import psnr


@pytest.fixture(scope="module")
def mesh(coffee: np.ndarray) -> vmesh.Mesh:
    return vmesh.encode(coffee, vertices=3000)


def ramp_mesh(colors: list[list[int]]) -> vmesh.Mesh:
    vertices = [[0, 0], [64, 0], [0, 64], [64, 64]]
    return vmesh.Mesh.from_colors(64, 64, vertices, [[0, 1, 3], [0, 3, 2]], colors)


@pytest.mark.parametrize(
    ("options", "shape"),
    [
        ({}, (400, 600, 3)),
        ({"scale": 0.5}, (200, 300, 3)),
        ({"scale": 2.25}, (900, 1350, 3)),
        ({"width": 150}, (100, 150, 3)),
        ({"height": 100}, (100, 150, 3)),
        ({"width": 10, "height": 300}, (300, 10, 3)),
        ({"scale": 0.0001}, (1, 1, 3)),
    ],
)
def test_the_size_is_what_was_asked_for(
    mesh: vmesh.Mesh, options: dict[str, float], shape: tuple[int, ...]
) -> None:
    assert vmesh.render(mesh, **options).shape == shape  # type: ignore[arg-type]


def test_supersampling_gives_the_means_of_a_larger_picture(mesh: vmesh.Mesh) -> None:
    large = vmesh.render(mesh, scale=4)
    reduced = large.reshape(400, 4, 600, 4, 3).mean(axis=(1, 3))
    assert np.abs(vmesh.render(mesh, supersample=4) - reduced).max() <= 0.5


def test_a_ramp_is_exact() -> None:
    ramp = vmesh.render(ramp_mesh([[0], [128], [0], [128]]))
    expected = np.floor(128 * (np.arange(64) + 0.5) / 64 + 0.5)
    assert (ramp == expected).all()


def test_a_rotation_is_transparent_outside_of_the_picture(mesh: vmesh.Mesh) -> None:
    turned = vmesh.render(mesh, transform=(0.8, 0.6, -0.6, 0.8, 0, 0))
    assert turned.shape == (680, 720, 4)
    assert not turned[0, 0].any()
    covered = (turned[:, :, 3] == 255).mean() * 680 * 720
    assert covered == pytest.approx(600 * 400, rel=0.001)
    assert set(np.unique(turned[:, :, 3])) == {0, 255}


def test_a_reflection_mirrors_the_pixels(mesh: vmesh.Mesh) -> None:
    mirrored = vmesh.render(mesh, transform=(-1, 0, 0, 1, 0, 0))
    assert mirrored.shape == (400, 600, 3)
    # Centres that lie on an edge may choose the other side.
    assert share_apart(mirrored[:, ::-1], vmesh.render(mesh)) < 0.01


def test_a_quarter_turn_swaps_the_sides(mesh: vmesh.Mesh) -> None:
    assert vmesh.render(mesh, transform=(0, 1, -1, 0, 0, 0)).shape == (600, 400, 3)


def test_a_transformed_mesh_and_a_transforming_render_agree(mesh: vmesh.Mesh) -> None:
    matrix = (1.1, 0.3, -0.2, 0.9, 0, 0)
    moved = vmesh.render(mesh.transform(matrix))
    drawn = vmesh.render(mesh, transform=matrix)
    assert moved.shape == drawn.shape
    # Vertices are rounded to the finest lattice of the mesh, or of the raster.
    assert share_apart(moved, drawn) < 0.01


def test_supersampling_weighs_colors_by_their_alpha() -> None:
    # Left half opaque red, right half transparent green.
    vertices = [[0, 0], [32, 0], [64, 0], [0, 64], [32, 64], [64, 64]]
    triangles = [[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]]
    red, green = [255, 0, 0, 255], [0, 255, 0, 0]
    mesh = vmesh.Mesh.from_colors(64, 64, vertices, triangles, [red, red, green, red, red, green])
    pixel = vmesh.render(mesh, width=1, height=1, supersample=16)[0, 0]
    assert pixel[0] > 200
    assert pixel[3] == pytest.approx(255 * 0.75, abs=3)


@pytest.mark.parametrize(
    "options",
    [
        {"scale": 0},
        {"scale": -1},
        {"scale": float("nan")},
        {"scale": 2, "width": 5},
        {"width": 0},
        {"supersample": 0},
        {"supersample": 17},
        {"transform": (1, 0, 0, 0, 0, 0)},
        {"transform": (1, 2, 3)},
        {"scale": 1000},
    ],
)
def test_wrong_arguments_are_refused(mesh: vmesh.Mesh, options: dict[str, object]) -> None:
    with pytest.raises(ValueError, match=r"expected|singular|over"):
        vmesh.render(mesh, **options)  # type: ignore[arg-type]


def test_limits_hold_before_anything_is_drawn(mesh: vmesh.Mesh) -> None:
    with pytest.raises(vmesh.LimitError, match="pixels"):
        vmesh.render(mesh, scale=100, limits=vmesh.Limits(max_pixels=1_000_000))
    with pytest.raises(vmesh.LimitError, match="visit"):
        vmesh.render(mesh, limits=vmesh.Limits(max_work=1000))


@pytest.mark.parametrize("suffix", ["png", "jpg", "webp", "tif"])
def test_image_files_open_with_pillow_and_keep_their_profile(
    mesh: vmesh.Mesh, suffix: str, tmp_path: Path
) -> None:
    from PIL import ImageCms

    profile = ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes()
    tagged = mesh.replaced(metadata=vmesh.Metadata(icc=profile))
    path = tmp_path / f"picture.{suffix}"
    vmesh.export(tagged, path, scale=0.5)
    with Image.open(path) as image:
        assert image.size == (300, 200)
        assert image.info["icc_profile"] == profile
        shown = np.asarray(image.convert("RGB"))
    rendered = vmesh.render(mesh, scale=0.5)
    if suffix in ("png", "tif"):
        assert np.array_equal(shown, rendered)
        return
    # What loses something loses less than by Pillow's own choice.
    coarser = io.BytesIO()
    Image.fromarray(rendered).save(coarser, {"jpg": "JPEG", "webp": "WEBP"}[suffix])
    assert psnr(shown, rendered) > psnr(np.asarray(Image.open(coarser)), rendered)


def test_jpeg_lays_transparent_pictures_on_white() -> None:
    raster = np.zeros((8, 8, 4), dtype=np.uint8)
    stream = io.BytesIO()
    write_raster(raster, stream, "JPEG")
    assert (np.asarray(Image.open(stream)) > 250).all()


def test_an_unknown_ending_is_refused(mesh: vmesh.Mesh, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"\.png"):
        vmesh.export(mesh, tmp_path / "picture.gif")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("suffix", ["png", "jpg", "webp", "tif"])
@pytest.mark.parametrize("exif", [b"garbage", b"II*\0", b"Exif\0\0" + bytes(70_000)])
def test_metadata_that_make_no_sense_cost_no_picture(
    mesh: vmesh.Mesh, suffix: str, exif: bytes, tmp_path: Path
) -> None:
    odd = mesh.replaced(metadata=vmesh.Metadata(exif=exif))
    vmesh.export(odd, tmp_path / f"picture.{suffix}", scale=0.1)
    with Image.open(tmp_path / f"picture.{suffix}") as image:
        assert image.size == (60, 40)


@pytest.mark.parametrize("suffix", ["png", "jpg", "webp", "tif"])
def test_exif_is_written_into_every_format(mesh: vmesh.Mesh, suffix: str, tmp_path: Path) -> None:
    exif = Image.Exif()
    exif[0x010E] = "a description"
    block = exif.tobytes().removeprefix(b"Exif\0\0")
    described = mesh.replaced(metadata=vmesh.Metadata(exif=block))
    vmesh.export(described, tmp_path / f"picture.{suffix}", scale=0.1)
    with Image.open(tmp_path / f"picture.{suffix}") as image:
        assert image.getexif()[0x010E] == "a description"


def test_bands_of_supersampling_count_as_work(mesh: vmesh.Mesh) -> None:
    limits = vmesh.Limits(max_work=5_000_000)
    assert vmesh.render(mesh, scale=2, limits=limits).shape == (800, 1200, 3)
    with pytest.raises(vmesh.LimitError, match="visit"):
        vmesh.render(mesh, scale=2, supersample=4, limits=limits)


def test_formats_with_short_sides_are_refused_in_words() -> None:
    with pytest.raises(ValueError, match="WEBP holds sides of at most 16383"):
        write_raster(np.zeros((1, 16_384), dtype=np.uint8), io.BytesIO(), "WEBP")
