"""Samples of every type: read as they are, spread over 16 bits and told, or refused in words."""

from __future__ import annotations

import io

import imagecodecs
import numpy as np
import pytest
from PIL import Image

import vmesh
from tests.formats.files import read, saved, scene, tiff
from vmesh.formats.picture.picture import picture_of

DEEP = scene().astype(np.uint16) * 257 + 3


def rising(dtype: str) -> np.ndarray:
    """Levels from the lowest to the highest of a type, shape (8, 16)."""
    info = np.iinfo(dtype)
    levels = [info.min + (int(info.max) - int(info.min)) * n // 127 for n in range(128)]
    return np.array(levels, dtype=dtype).reshape(8, 16)


@pytest.mark.parametrize("compression", [None, "lzw", "deflate", "packbits", "zstd"])
@pytest.mark.parametrize("layout", ["strips", "tiles", "planes"])
@pytest.mark.parametrize("order", ["<", ">"])
def test_all_bits_of_deep_colours_in_tiff_are_kept(
    compression: str | None, layout: str, order: str
) -> None:
    options = {"tile": (16, 16)} if layout == "tiles" else {"rowsperstrip": 10}
    stored = np.moveaxis(DEEP, 2, 0) if layout == "planes" else DEEP
    data = tiff(
        stored,
        photometric="rgb",
        planarconfig="separate" if layout == "planes" else "contig",
        compression=compression,
        predictor=compression in ("lzw", "deflate"),
        byteorder=order,
        **options,
    )
    assert np.array_equal(read(data).array, DEEP)


@pytest.mark.parametrize("n_samples", [2, 3, 4])
def test_all_bits_of_deep_colours_in_png_are_kept(n_samples: int) -> None:
    deep = np.dstack([DEEP, DEEP[:, ::-1, 0]])[:, :, -n_samples:]
    array = read(imagecodecs.png_encode(np.ascontiguousarray(deep))).array
    assert array.dtype == np.uint16
    assert np.array_equal(array, deep[:, :, [0, 0, 0, 1]] if n_samples == 2 else deep)


def test_deep_colours_of_jpeg_2000_are_kept_where_they_are_white_too() -> None:
    deep = DEEP.copy()
    deep[:9] = 65_535
    assert np.array_equal(read(imagecodecs.jpeg2k_encode(deep, level=0)).array, deep)


def test_colours_that_a_tiff_has_multiplied_by_alpha_are_divided() -> None:
    alpha = np.linspace(20_000, 65_535, 64).astype(np.uint16)[None, :, None].repeat(48, axis=0)
    multiplied = np.rint(DEEP * (alpha / 65_535)).astype(np.uint16)
    data = tiff(np.dstack([multiplied, alpha]), photometric="rgb", extrasamples=["assocalpha"])
    array = read(data).array
    assert np.array_equal(array[:, :, 3:], alpha)
    assert np.abs(array[:, :, :3].astype(int) - DEEP).max() <= 2


@pytest.mark.parametrize("n_bits", [10, 12, 14])
def test_white_of_fewer_than_sixteen_bits_is_white(n_bits: int) -> None:
    largest = (1 << n_bits) - 1
    levels = np.array([[0, largest // 2, largest]], dtype=np.uint16)
    data = tiff(levels, photometric="minisblack", bitspersample=n_bits)
    array = read(data).array
    assert array[0, [0, 2]].tolist() == [0, 65_535]
    assert abs(int(array[0, 1]) - 32_767) < 65_536 >> n_bits


@pytest.mark.parametrize("dtype", ["int8", "int16", "uint32", "int32", "uint64", "int64"])
@pytest.mark.parametrize("kind", ["minisblack", "miniswhite"])
def test_integers_without_a_known_white_are_spread_and_told(dtype: str, kind: str) -> None:
    picture = read(tiff(rising(dtype), photometric=kind))
    tones = picture.array.astype(int).ravel()
    assert sorted((tones[0], tones[-1])) == [0, 65_535]
    steps = np.diff(tones if kind == "minisblack" else tones[::-1])
    assert np.abs(steps - 516).max() <= 520
    assert (steps >= 0).all()
    assert dtype in picture.notes[0]


@pytest.mark.parametrize("dtype", ["float16", "float32", "float64"])
def test_floats_of_0_to_1_are_what_they_are(dtype: str) -> None:
    levels = np.array([[0.25, 0.5, 0.75]], dtype=dtype)
    picture = read(tiff(levels, photometric="minisblack"))
    assert picture.array.tolist() == [[16_384, 32_768, 49_151]]
    assert picture.notes == ()


def test_floats_beyond_are_spread_and_told() -> None:
    picture = read(tiff(np.array([[-2.0, 0.0, 2.0]], dtype="f4"), photometric="minisblack"))
    assert picture.array.tolist() == [[0, 32_768, 65_535]]
    assert "from -2, now black, to 2, now white" in picture.notes[0]


def test_samples_that_are_no_numbers_are_black_and_told() -> None:
    levels = np.array([[np.nan, np.inf, -np.inf, 0.0, 0.5, 1.0]], dtype="f4")
    picture = read(tiff(levels, photometric="minisblack"))
    assert picture.array.tolist() == [[0, 65_535, 0, 0, 32_768, 65_535]]
    assert "3 of its samples are no numbers" in picture.notes[0]


def test_nothing_but_what_is_no_number_is_black() -> None:
    assert not read(tiff(np.full((3, 3), np.nan, np.float32))).array.any()


def test_float_colours_are_read_in_proportion() -> None:
    picture = read(tiff((scene() / 255).astype(np.float32), photometric="rgb"))
    assert np.abs(picture.array / 65_535 - scene() / 255).max() < 1e-4


def test_complex_numbers_are_refused_as_unsupported() -> None:
    with pytest.raises(vmesh.ImageError, match="unsupported"):
        read(tiff(np.ones((4, 4), np.complex64)))


@pytest.mark.parametrize("mode", ["I", "F", "I;16"])
def test_images_of_numbers_become_grey_of_sixteen_bits(mode: str) -> None:
    levels = np.array([[0, 1000, 65_535]], dtype={"I": "i4", "F": "f4", "I;16": "u2"}[mode])
    if mode == "F":
        levels /= 65_535
    picture = picture_of(Image.fromarray(levels))
    assert picture.array.tolist() == [[0, 1000, 65_535]]
    assert picture.notes == ()


def test_negative_values_of_an_image_are_not_cut() -> None:
    picture = picture_of(Image.fromarray(np.array([[-100, 0, 100]], dtype="i4")))
    assert picture.array.tolist() == [[0, 32_768, 65_535]]
    assert picture.notes


@pytest.mark.parametrize("dtype", ["int16", "uint32", "int32", "float32"])
def test_saving_through_pillow_gives_the_tones_of_the_file(dtype: str) -> None:
    vmesh.register()
    levels = rising(dtype) if dtype != "float32" else np.linspace(-3, 3, 128, dtype="f4")
    data = tiff(levels.reshape(8, 16), photometric="minisblack")
    stream = io.BytesIO()
    with Image.open(io.BytesIO(data)) as image, pytest.warns(UserWarning, match="now black"):
        image.save(stream, "VMESH", vertices=60, effort=1)
    mesh = vmesh.encode(read(data).array, vertices=60, effort=1)
    assert vmesh.dumps(mesh) == stream.getvalue()


def test_multiplied_grey_of_an_image_is_divided() -> None:
    image = Image.fromarray(np.array([[[100, 128]]], dtype="u1"), "LA").convert("La")
    array = picture_of(image).array.astype(int)
    assert np.abs(array - [[[100, 100, 100, 128]]]).max() <= 1


@pytest.mark.parametrize("largest", [1, 100, 255, 256, 1000, 4095, 65_535])
def test_portable_maps_of_any_largest_value_reach_white(largest: int) -> None:
    levels = np.array([[0, largest // 2, largest]])
    raw = levels.astype(">u2" if largest > 255 else "u1").tobytes()
    grey = read(b"P5 3 1 %d\n" % largest + raw).array
    white = np.iinfo(grey.dtype).max
    assert np.abs(grey - levels / largest * white).max() <= 0.51
    colour = read(b"P6 1 1 %d\n" % largest + raw)
    assert np.abs(colour.array[0, 0] - levels[0] / largest * 255).max() <= 0.51
    assert bool(colour.notes) == (largest > 255)


def test_an_oriented_deep_tiff_is_turned_and_keeps_its_metadata() -> None:
    from vmesh.formats.color.profiles import srgb_profile

    data = tiff(
        DEEP,
        photometric="rgb",
        iccprofile=srgb_profile(),
        resolution=(300, 300),
        extratags=[(274, 3, 1, 6, True), (271, 2, None, "Camera", True)],
    )
    picture = read(data)
    assert np.array_equal(picture.array, np.rot90(DEEP, -1))
    assert picture.metadata.icc == srgb_profile()
    exif = Image.Exif()
    exif.load(picture.metadata.exif)
    assert exif.get(274, 1) == 1
    assert exif[271] == "Camera"
    assert exif[282] == 300


def test_an_oriented_deep_png_is_turned_and_keeps_its_metadata() -> None:
    exif = Image.Exif()
    exif[274], exif[271] = 6, "Camera"
    eight = saved(scene(), "PNG", exif=exif, dpi=(300, 300))
    start, end = eight.index(b"IHDR") + 17 + 4, eight.index(b"IDAT") - 4
    deep = imagecodecs.png_encode(DEEP)
    data = deep[:33] + eight[start:end] + deep[33:]
    picture = read(data)
    assert np.array_equal(picture.array, np.rot90(DEEP, -1))
    kept = Image.Exif()
    kept.load(picture.metadata.exif)
    assert kept.get(274, 1) == 1
    assert (kept[271], kept[282]) == ("Camera", 300)


def test_a_deep_picture_is_measured_before_it_is_decoded() -> None:
    limits = vmesh.Limits(max_pixels=1000)
    for data in (tiff(DEEP, photometric="rgb"), imagecodecs.png_encode(DEEP)):
        with pytest.raises(vmesh.LimitError, match="64 x 48"):
            read(data, limits)


def test_a_tile_that_is_larger_than_the_limits_is_refused() -> None:
    data = bytearray(tiff(DEEP, photometric="rgb", tile=(16, 16), compression="deflate"))
    for tag in (322, 323):
        at = data.index(tag.to_bytes(2, "little") + b"\x04\0")
        data[at + 8 : at + 12] = (1 << 20).to_bytes(4, "little")
    with pytest.raises((vmesh.LimitError, vmesh.ImageError)):
        read(bytes(data))


@pytest.mark.parametrize("kind", ["tiff", "png", "jpeg 2000"])
def test_a_damaged_deep_file_is_refused_or_read(kind: str) -> None:
    data = {
        "tiff": tiff(DEEP[:9, :9], photometric="rgb", compression="deflate"),
        "png": imagecodecs.png_encode(DEEP[:9, :9].copy()),
        "jpeg 2000": imagecodecs.jpeg2k_encode(DEEP[:9, :9].copy(), level=0),
    }[kind]
    random = np.random.default_rng(1)
    for _ in range(150):
        damaged = bytearray(data)
        for at in random.integers(0, len(data), 3):
            damaged[at] = random.integers(0, 256)
        try:
            read(bytes(damaged))
        except (vmesh.ImageError, vmesh.LimitError):
            continue
