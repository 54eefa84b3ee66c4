"""Reading photographs."""

from __future__ import annotations

import io
import struct
import zlib

import numpy as np
import pytest
from PIL import Image

import vmesh
from vmesh.formats.pdf.page_size import make_page
from vmesh.formats.picture.conversion import flatten
from vmesh.formats.picture.picture import read_picture


def saved(image: Image.Image, format_name: str = "PNG", **options: object) -> io.BytesIO:
    stream = io.BytesIO()
    image.save(stream, format_name, **options)
    stream.seek(0)
    return stream


def noise(shape: tuple[int, ...]) -> np.ndarray:
    return np.random.default_rng(1).integers(0, 256, shape).astype(np.uint8)


@pytest.mark.parametrize(
    ("mode", "shape"),
    [
        ("1", (5, 7)),
        ("L", (5, 7)),
        ("LA", (5, 7, 4)),
        ("P", (5, 7, 3)),
        ("RGB", (5, 7, 3)),
        ("RGBA", (5, 7, 4)),
        ("CMYK", (5, 7, 3)),
    ],
)
def test_pictures_of_every_mode_are_read(mode: str, shape: tuple[int, ...]) -> None:
    image = Image.fromarray(noise((5, 7, 3))).convert(mode)
    format_name = "TIFF" if mode == "CMYK" else "PNG"
    picture = read_picture(saved(image, format_name))
    assert picture.array.shape == shape
    assert picture.array.dtype == np.uint8


def test_grey_of_sixteen_bits_stays_what_it_is() -> None:
    wide = np.array([[0, 128, 129, 257 * 100, 65535]], dtype=np.uint16)
    picture = read_picture(saved(Image.fromarray(wide)))
    assert picture.array.dtype == np.uint16
    assert picture.array.tolist() == wide.tolist()
    # And is rounded where 8 bits are wanted.
    assert flatten(picture.array)[0, :, 0].tolist() == [0, 0, 1, 100, 255]


def test_a_transparent_palette_color_becomes_alpha() -> None:
    image = Image.fromarray(np.array([[0, 1]], dtype=np.uint8), mode="P")
    image.putpalette([255, 0, 0, 0, 255, 0])
    picture = read_picture(saved(image, transparency=1))
    assert picture.array[0, :, 3].tolist() == [255, 0]


@pytest.mark.parametrize("orientation", range(1, 9))
def test_exif_orientation_is_applied_and_not_kept(orientation: int) -> None:
    image = Image.fromarray(noise((4, 6, 3)))
    exif = Image.Exif()
    exif[0x0112] = orientation
    exif[0x010E] = "a description"
    picture = read_picture(saved(image, "PNG", exif=exif))
    array = np.asarray(image)
    upright = {
        1: array,
        2: array[:, ::-1],
        3: array[::-1, ::-1],
        4: array[::-1],
        5: array.transpose(1, 0, 2),
        6: np.rot90(array, -1),
        7: np.rot90(array, 2).transpose(1, 0, 2),
        8: np.rot90(array),
    }[orientation]
    assert np.array_equal(picture.array, upright)
    assert picture.metadata.exif[:2] in (b"II", b"MM")
    kept = Image.Exif()
    kept.load(picture.metadata.exif)
    assert kept.get(0x0112, 1) == 1
    assert kept[0x010E] == "a description"


def test_a_profile_for_other_components_is_left_behind() -> None:
    from PIL import ImageCms

    profile = ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes()
    color = read_picture(saved(Image.new("RGB", (3, 3)), icc_profile=profile))
    grey = read_picture(saved(Image.new("L", (3, 3)), icc_profile=profile))
    assert color.metadata.icc == profile
    assert grey.metadata.icc == b""


@pytest.mark.parametrize("data", [b"", b"not an image", b"\x89PNG\r\n\x1a\n", b"GIF89a"])
def test_what_is_not_an_image_is_refused(data: bytes) -> None:
    with pytest.raises(vmesh.ImageError):
        read_picture(io.BytesIO(data))


@pytest.mark.parametrize("format_name", ["PNG", "JPEG", "WEBP", "TIFF", "GIF", "BMP"])
def test_an_image_cut_at_any_length_is_refused_or_read_whole(format_name: str) -> None:
    data = saved(Image.fromarray(noise((12, 12, 3))), format_name).getvalue()
    whole = read_picture(io.BytesIO(data)).array
    for length in range(len(data)):
        try:
            picture = read_picture(io.BytesIO(data[:length]))
        except vmesh.ImageError:
            continue
        # A trailer may be missing without harm to the pixels.
        assert np.array_equal(picture.array, whole)


def png_of_size(width: int, height: int) -> io.BytesIO:
    """A PNG whose header claims a size and whose pixels are missing."""

    def chunk(tag: bytes, content: bytes) -> bytes:
        checksum = zlib.crc32(tag + content)
        return struct.pack(">I", len(content)) + tag + content + struct.pack(">I", checksum)

    header = chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
    return io.BytesIO(b"\x89PNG\r\n\x1a\n" + header + chunk(b"IDAT", b"") + chunk(b"IEND", b""))


@pytest.mark.parametrize("size", [(60_000, 60_000), (2**31 - 1, 2**31 - 1)])
def test_enormous_dimensions_in_a_header_are_refused(size: tuple[int, int]) -> None:
    with pytest.raises(vmesh.LimitError):
        read_picture(png_of_size(*size))


@pytest.mark.parametrize("size", [(0, 0), (0, 5), (5, 0), (70_000, 1)])
def test_pictures_without_pixels_or_with_too_long_sides_are_refused(size: tuple[int, int]) -> None:
    with pytest.raises(vmesh.ImageError):
        read_picture(png_of_size(*size))


def test_the_pixel_limit_holds_for_photographs() -> None:
    with pytest.raises(vmesh.LimitError, match="limit"):
        read_picture(saved(Image.new("L", (100, 100))), limits=vmesh.Limits(max_pixels=9_999))


def test_flattening_lays_pictures_on_white() -> None:
    picture = np.array([[[10, 20, 30, 255], [10, 20, 30, 0]]], dtype=np.uint8)
    assert flatten(picture).tolist() == [[[10, 20, 30], [255, 255, 255]]]


def test_exif_that_makes_no_sense_costs_no_picture() -> None:
    image = Image.fromarray(noise((6, 7, 3)))
    data = saved(image, "JPEG", exif=b"Exif\0\0MM\0*\0\0\0\x08\xff\xff\x01\x12").getvalue()
    picture = read_picture(io.BytesIO(data))
    assert picture.array.shape == (6, 7, 3)


@pytest.mark.parametrize("format_name", ["PNG", "JPEG", "TIFF", "BMP"])
def test_the_density_that_a_picture_has_outside_of_exif_sets_the_page(format_name: str) -> None:
    image = Image.fromarray(noise((30, 60, 3)))
    picture = read_picture(saved(image, format_name, dpi=(300, 150)))
    mesh = vmesh.encode(picture.array, metadata=picture.metadata, vertices=20, effort=1)
    page = make_page(mesh)
    assert (page.width, page.height) == pytest.approx((60 / 300 * 72, 30 / 150 * 72), rel=1e-3)


@pytest.mark.parametrize("density", [{}, {"dpi": (72, 72)}, {"dpi": (96, 96)}])
def test_a_density_that_says_nothing_costs_no_bytes(density: dict[str, tuple[int, int]]) -> None:
    image = Image.fromarray(noise((6, 7, 3)))
    for format_name in ("PNG", "JPEG"):
        assert read_picture(saved(image, format_name, **density)).metadata.exif == b""


def test_programs_are_not_started_for_postscript() -> None:
    with pytest.raises(vmesh.ImageError):
        read_picture(io.BytesIO(b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 9 9\n"))


def test_the_pixel_limit_is_the_caller_s_and_not_pillow_s() -> None:
    before = Image.MAX_IMAGE_PIXELS
    with pytest.raises(vmesh.ImageError, match="damaged"):
        read_picture(png_of_size(14_000, 14_000))
    assert before == Image.MAX_IMAGE_PIXELS
