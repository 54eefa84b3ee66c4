"""Pages and frames: which one is read, and what is told of the others."""

from __future__ import annotations

import io

import numpy as np
import pytest
import tifffile
from PIL import Image

import vmesh
from tests.formats.files import read, saved, scene, tiff


def pages(*arrays: np.ndarray, **options: object) -> bytes:
    """A TIFF of several pages; `options` are lists with a value for each."""
    stream = io.BytesIO()
    with tifffile.TiffWriter(stream) as file:
        for index, array in enumerate(arrays):
            chosen = {name: values[index] for name, values in options.items()}  # type: ignore[index]
            colours = "rgb" if array.ndim == 3 else "minisblack"
            file.write(array, photometric=colours, metadata=None, **chosen)
    return stream.getvalue()


SMALL, LARGE, MIDDLE = scene(12, 16), scene(48, 64), scene(24, 32)


def test_the_largest_page_is_read_and_the_others_told() -> None:
    picture = read(pages(SMALL, LARGE, MIDDLE))
    assert np.array_equal(picture.array, LARGE)
    assert picture.notes == ("it has 3 pages; page 2, the largest, was read (--page)",)


def test_a_page_that_is_asked_for_is_read_without_a_word() -> None:
    picture = read(pages(SMALL, LARGE, MIDDLE), page=3)
    assert np.array_equal(picture.array, MIDDLE)
    assert picture.notes == ()


def test_of_pages_of_a_size_the_first_is_read() -> None:
    assert np.array_equal(read(pages(LARGE, 255 - LARGE)).array, LARGE)


def test_a_page_that_is_not_there_is_refused_with_their_number() -> None:
    with pytest.raises(vmesh.ImageError, match="page 4 was asked for, but the file has 3 pages"):
        read(pages(SMALL, LARGE, MIDDLE), page=4)
    with pytest.raises(vmesh.ImageError, match="but the file has 1 page"):
        read(saved(LARGE, "JPEG"), page=2)
    with pytest.raises(vmesh.ImageError, match="but the file has 1 page"):
        read(tiff(LARGE, photometric="rgb"), page=2)


def test_copies_that_say_that_they_are_smaller_are_passed_over() -> None:
    data = pages(LARGE[:10], LARGE, subfiletype=[0, 1])
    assert np.array_equal(read(data).array, LARGE[:10])


def test_pages_of_different_samples_are_read_each_by_its_own() -> None:
    deep = LARGE.astype(np.uint16) * 257 + 1
    floats = (MIDDLE[:, :, 0] / 255).astype(np.float32)
    data = pages(SMALL, deep, floats, SMALL[:, :, 0])
    assert np.array_equal(read(data).array, deep)
    assert read(data, page=1).array.dtype == np.uint8
    assert read(data, page=3).array.dtype == np.uint16
    assert np.array_equal(read(data, page=4).array, SMALL[:, :, 0])


def test_metadata_are_those_of_the_page() -> None:
    makes = [[(271, 2, None, make, True)] for make in ("small", "large")]
    data = pages(SMALL, LARGE.astype(np.uint16), extratags=makes)
    for page, words in ((1, "small"), (2, "large")):
        exif = Image.Exif()
        exif.load(read(data, page=page).metadata.exif)
        assert exif[271] == words


def test_a_chain_of_pages_that_bites_its_tail_ends() -> None:
    data = bytearray(pages(SMALL, SMALL))
    with tifffile.TiffFile(io.BytesIO(bytes(data))) as file:
        first, second = (page.offset for page in file.pages)
    n_tags = int.from_bytes(data[second : second + 2], "little")
    end = second + 2 + 12 * n_tags
    data[end : end + 4] = first.to_bytes(4, "little")
    assert np.array_equal(read(bytes(data)).array, SMALL)


def test_an_icon_gives_its_largest_picture() -> None:
    data = saved(scene(64, 64), "ICO", sizes=[(16, 16), (64, 64), (32, 32)])
    picture = read(data)
    assert picture.array.shape[:2] == (64, 64)
    assert "3 pages" in picture.notes[0]
    assert read(data, page=1).array.shape[:2] == (16, 16)
    with pytest.raises(vmesh.ImageError, match="3 pages"):
        read(data, page=4)


def test_a_phone_s_jpeg_with_companions_is_read_without_a_word() -> None:
    data = saved(LARGE, "MPO", save_all=True, append_images=[Image.fromarray(SMALL)])
    picture = read(data)
    assert picture.array.shape == LARGE.shape
    assert picture.notes == ()
    assert read(data, page=2).array.shape == SMALL.shape


@pytest.mark.parametrize("format_name", ["GIF", "WEBP", "AVIF"])
def test_the_first_frame_is_read_and_the_others_told(format_name: str) -> None:
    more = [Image.fromarray(scene()[::-1].copy()), Image.fromarray(255 - scene())]
    data = saved(scene(), format_name, save_all=True, append_images=more)
    picture = read(data)
    alone = read(saved(scene(), format_name))
    difference = picture.array[:, :, :3].astype(int) - alone.array[:, :, :3]
    assert np.abs(difference).mean() < 8
    assert "animation of 3 frames" in picture.notes[0]
    last = read(data, page=3)
    assert np.abs(last.array[:, :, :3].astype(int) - (255 - scene())).mean() < 12
    with pytest.raises(vmesh.ImageError, match="frame 4 was asked for, but the file has 3 frames"):
        read(data, page=4)


def gif(
    canvas: tuple[int, int], *frames: tuple[int, int, Image.Image], background: int = 0
) -> bytes:
    """A GIF of frames, each with its place."""
    pieces = []
    for left, top, image in frames:
        data = saved(image, "GIF", interlace=0)
        table = data[13 : 13 + (6 << (data[10] & 7))]
        start = data.index(b",", 13 + len(table))
        size = image.width.to_bytes(2, "little") + image.height.to_bytes(2, "little")
        place = left.to_bytes(2, "little") + top.to_bytes(2, "little")
        flags = bytes([128 | (data[10] & 7)])
        pieces.append(b"," + place + size + flags + table + data[start + 10 : -1])
    width, height = canvas
    screen = width.to_bytes(2, "little") + height.to_bytes(2, "little")
    table = bytes(range(255, 249, -1))
    return b"GIF89a" + screen + b"\x80" + bytes([background, 0]) + table + b"".join(pieces) + b";"


def plain(width: int, height: int, value: int) -> Image.Image:
    image = Image.new("P", (width, height), 1)
    image.putpalette(bytes((0, 0, 0, value, value, value)) + bytes(762))
    return image


@pytest.mark.parametrize("background", [0, 1])
def test_what_no_frame_of_a_gif_covers_is_transparent(background: int) -> None:
    data = gif((8, 6), (2, 1, plain(3, 4, 200)), background=background)
    array = read(data).array
    covered = np.zeros((6, 8), dtype=bool)
    covered[1:5, 2:5] = True
    assert np.array_equal(array[:, :, 3] == 255, covered)
    assert (array[covered][:, :3] == 200).all()


def test_a_later_frame_of_a_gif_lies_on_the_ones_before() -> None:
    data = gif((8, 6), (0, 0, plain(3, 3, 200)), (4, 2, plain(3, 3, 90)))
    array = read(data, page=2).array
    assert array[1, 1].tolist() == [200, 200, 200, 255]
    assert array[3, 5].tolist() == [90, 90, 90, 255]
    assert array[5, 0, 3] == 0


def test_a_gif_that_fills_its_canvas_has_no_alpha() -> None:
    assert read(gif((3, 4), (0, 0, plain(3, 4, 200)))).array.shape == (4, 3, 3)
