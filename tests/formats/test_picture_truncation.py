"""Files that were cut off: refused with what is there of them, or read as far as they go."""

from __future__ import annotations

import zlib

import imagecodecs
import numpy as np
import pytest
from PIL import Image, ImageFile

import vmesh
from tests.formats.files import PNG_START, chunk, png, read, saved, scene, tiff

ALPHA = np.dstack([scene(), np.full(scene().shape[:2], 255, np.uint8)])


def shares_rows(picture: np.ndarray, whole: np.ndarray, rows: slice) -> float:
    """Share of the pixels in some rows that are nearly as in the whole picture."""
    difference = np.abs(picture[rows].astype(int) - whole[rows])
    return float((difference.reshape(len(difference), -1).max(axis=1) <= 3).mean())


FILES: dict[str, bytes] = {
    "baseline JPEG": saved(scene(), "JPEG", quality=95),
    "JPEG with restarts": saved(scene(), "JPEG", quality=95, restart_marker_blocks=3),
    "grey JPEG": saved(scene()[:, :, 0], "JPEG", quality=95),
    "PNG": saved(scene(), "PNG"),
    "PNG with alpha": saved(ALPHA, "PNG"),
    "PNG of 16 bits": bytes(imagecodecs.png_encode(scene().astype(np.uint16) * 257)),
    "WebP": saved(scene(), "WEBP", quality=95),
    "lossless WebP": saved(scene(), "WEBP", lossless=True),
    "GIF": saved(Image.fromarray(scene()).quantize(128), "GIF", interlace=0),
    "TIFF": saved(scene(), "TIFF"),
    "TIFF, LZW": tiff(scene(), photometric="rgb", compression="lzw", predictor=True),
    "TIFF, deflate": tiff(scene(), photometric="rgb", compression="deflate"),
    "TIFF, PackBits": tiff(scene(), photometric="rgb", compression="packbits"),
    "TIFF of 16 bits": tiff(scene().astype(np.uint16), photometric="rgb", rowsperstrip=8),
    "PPM": saved(scene(), "PPM"),
    "PCX": saved(scene(), "PCX"),
}
FROM_BELOW = {"BMP": saved(scene(), "BMP"), "TGA": saved(scene(), "TGA")}


@pytest.mark.parametrize("name", [*FILES, *FROM_BELOW])
def test_half_a_file_is_refused_with_what_is_there_and_read_on_request(name: str) -> None:
    data = (FILES | FROM_BELOW)[name]
    half = data[: len(data) // 2]
    with pytest.raises(vmesh.ImageError, match=r"cut off: about \d+ % .*--allow-truncated"):
        read(half)
    whole, part = read(data).array, read(half, allow_truncated=True)
    assert part.array.shape == whole.shape
    assert part.array.dtype == whole.dtype
    first, last = slice(0, 6), slice(-6, None)
    there, missing = (first, last) if name in FILES else (last, first)
    assert shares_rows(part.array, whole, there) == 1
    assert shares_rows(part.array, whole, missing) < 0.5
    rest = part.array[missing]
    assert (rest[..., 3] == 0).all() if rest.shape[-1] == 4 else np.ptp(rest.reshape(6, -1)) < 9
    assert "cut off" in part.notes[-1]


def test_more_of_a_file_gives_more_of_its_picture() -> None:
    data = FILES["baseline JPEG"]
    whole = read(data).array
    there = []
    for length in (len(data) * share // 10 for share in (5, 7, 9)):
        array = read(data[:length], allow_truncated=True).array
        there.append(shares_rows(array, whole, slice(None)))
    assert there == sorted(there)
    assert there[0] < there[-1]


def test_half_of_a_progressive_jpeg_is_all_of_a_coarse_picture() -> None:
    data = saved(scene(), "JPEG", quality=90, progressive=True)
    half = data[: len(data) * 6 // 10]
    with pytest.raises(vmesh.ImageError, match="all of its picture is there, but without its"):
        read(half)
    coarse = read(half, allow_truncated=True).array
    grey = np.full_like(coarse, 128)
    whole = read(data).array.astype(int)
    error, worst = (np.abs(array[-12:] - whole[-12:]).mean() for array in (coarse, grey))
    assert error < worst / 2


@pytest.mark.parametrize("options", [{}, {"progressive": True}, {"restart_marker_blocks": 2}])
@pytest.mark.parametrize("n_missing", [1, 2])
def test_a_jpeg_that_lacks_its_end_marker_alone_is_read(
    options: dict[str, object], n_missing: int
) -> None:
    data = saved(scene(), "JPEG", **options)
    picture = read(data[:-n_missing])
    assert np.array_equal(picture.array, read(data).array)
    assert picture.notes == ("the end of the file is missing, but nothing of its picture is",)


def test_bytes_behind_a_picture_do_no_harm() -> None:
    for name in ("baseline JPEG", "PNG", "GIF", "TIFF", "BMP"):
        data = (FILES | FROM_BELOW)[name]
        picture = read(data + bytes(range(200)))
        assert np.array_equal(picture.array, read(data).array)
        assert picture.notes == ()


def test_an_interlaced_png_is_filled_from_its_coarser_passes() -> None:
    smooth = (np.mgrid[0:64, 0:64][0] * 2 + 40).astype(np.uint8)
    starts = [(0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4)]
    starts += [(0, 2, 2, 4), (1, 0, 2, 2), (0, 1, 1, 2)]
    rows = [smooth[y::down, x::across] for x, y, across, down in starts]
    header = png(smooth, 8, 0)[16:28] + b"\1"
    filtered = b"".join(b"\0" + row.tobytes() for part in rows for row in part)
    stream = zlib.compress(filtered, 0)
    data = PNG_START + chunk(b"IHDR", header) + chunk(b"IDAT", stream) + chunk(b"IEND", b"")
    assert np.array_equal(read(data).array, smooth)
    part = read(data[: len(data) // 3], allow_truncated=True).array
    assert np.abs(part.astype(int) - smooth).max() <= 16


@pytest.mark.parametrize("format_name", ["AVIF", "JPEG2000"])
def test_what_can_only_be_read_whole_is_refused_in_part(format_name: str) -> None:
    data = saved(scene(), format_name)
    for allow in (False, True):
        with pytest.raises(vmesh.ImageError, match="can only be read whole"):
            read(data[: len(data) // 2], allow_truncated=allow)


@pytest.mark.parametrize("name", ["baseline JPEG", "PNG", "WebP", "GIF", "TIFF", "PNG of 16 bits"])
def test_a_file_cut_anywhere_is_read_or_refused(name: str) -> None:
    data = FILES[name]
    shape = read(data).array.shape
    for length in range(0, len(data), 1 + len(data) // 60):
        try:
            picture = read(data[:length], allow_truncated=True)
        except vmesh.ImageError:
            continue
        assert picture.array.shape[:2] == shape[:2]


def test_a_damaged_file_that_is_not_cut_off_is_not_called_so() -> None:
    data = bytearray(FILES["PNG"])
    middle = data.index(b"IDAT") + 300
    data[middle] ^= 255
    with pytest.raises(vmesh.ImageError, match="damaged"):
        read(bytes(data))


def test_the_tolerance_of_pillow_stays_as_it_was() -> None:
    for allow in (False, True):
        try:
            read(FILES["baseline JPEG"][:1500], allow_truncated=allow)
        except vmesh.ImageError:
            continue
        finally:
            assert ImageFile.LOAD_TRUNCATED_IMAGES is False


def test_an_enormous_picture_of_which_nothing_is_there_is_refused() -> None:
    data = bytearray(saved(np.zeros((8, 8, 3), np.uint8), "BMP"))
    data[18:26] = (12_000).to_bytes(4, "little") * 2
    with pytest.raises(vmesh.ImageError):
        read(bytes(data))
