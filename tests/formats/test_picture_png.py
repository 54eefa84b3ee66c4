"""PNG files: transparent colours, long texts, gamma and what is wrong with damaged ones."""

from __future__ import annotations

import base64
import re
import zlib

import numpy as np
import pytest
from PIL import Image

import vmesh
from tests.formats.files import PNG_START, apng, chunk, png, read, saved, scene
from vmesh.formats.color.profiles import srgb_profile

GREY, RGB, PALETTE = 0, 2, 3
MEBIBYTE = 1 << 20


def levels(depth: int) -> np.ndarray:
    """All levels of a depth, or 16 of them and their neighbours, shape (4, n)."""
    largest = (1 << depth) - 1
    row = np.unique(np.concatenate([np.linspace(0, largest, 16).astype(int), [1, largest - 1]]))
    return np.tile(row, (4, 1))


@pytest.mark.parametrize("depth", [1, 2, 4, 8, 16])
def test_a_transparent_level_of_grey_is_transparent_and_no_other(depth: int) -> None:
    grey = levels(depth)
    key = int(grey[0, len(grey[0]) // 2])
    array = read(png(grey, depth, GREY, [(b"tRNS", key.to_bytes(2, "big"))])).array
    white = np.iinfo(array.dtype).max
    assert np.array_equal(array[:, :, 3], np.where(grey == key, 0, white))
    assert np.abs(array[:, :, 0] - grey / ((1 << depth) - 1) * white).max() <= 0.51


@pytest.mark.parametrize("depth", [8, 16])
def test_a_transparent_colour_is_transparent_and_no_other(depth: int) -> None:
    factor = 1 if depth == 8 else 257
    colours = scene().astype(int) * factor
    key = colours[5, 7]
    near = key.copy()
    near[2] += 1
    colours[0, 0] = near
    data = png(colours, depth, RGB, [(b"tRNS", key.astype(">u2").tobytes())])
    array = read(data).array
    assert np.array_equal(array[:, :, 3] == 0, (colours == key).all(axis=2))
    assert np.array_equal(array[:, :, :3], colours)


@pytest.mark.parametrize("depth", [1, 2, 4, 8])
def test_alpha_of_a_palette_is_read_at_every_depth(depth: int) -> None:
    n = 1 << depth
    colours = np.random.default_rng(1).integers(0, 256, (n, 3)).astype(np.uint8)
    alpha = np.linspace(0, 200, n // 2).astype(np.uint8)
    index = np.tile(np.arange(n), (3, 1))
    more = [(b"PLTE", colours.tobytes()), (b"tRNS", alpha.tobytes())]
    array = read(png(index, depth, PALETTE, more)).array
    assert np.array_equal(array[0, :, :3], colours)
    assert array[0, :, 3].tolist() == [*alpha, *[255] * (n - n // 2)]


def test_pictures_are_read_as_a_browser_shows_them() -> None:
    from tests.formats.browser import running

    script = """async (source) => {
        const image = new Image(); image.src = source; await image.decode();
        const canvas = document.createElement("canvas");
        canvas.width = image.naturalWidth; canvas.height = image.naturalHeight;
        const context = canvas.getContext("2d"); context.drawImage(image, 0, 0);
        return Array.from(context.getImageData(0, 0, canvas.width, canvas.height).data);
    }"""
    gamma = [(b"gAMA", (100_000).to_bytes(4, "big"))]
    wide = (31_270, 32_900, 68_000, 32_000, 26_500, 69_000, 15_000, 6_000)
    primaries = (b"cHRM", b"".join(number.to_bytes(4, "big") for number in wide))
    files = [
        *(png(levels(n), n, GREY, [(b"tRNS", b"\0\1")]) for n in (1, 2, 4, 8)),
        png(scene(), 8, RGB, gamma),
        png(scene(), 8, RGB, [(b"gAMA", (45_455).to_bytes(4, "big")), primaries]),
        png(scene(), 8, RGB, [*gamma, (b"sRGB", b"\0")]),
    ]
    with running() as browser:
        page = browser.new_page()
        for data in files:
            source = "data:image/png;base64," + base64.b64encode(data).decode()
            shown = np.array(page.evaluate(script, source)).reshape(-1, 4)
            array = read(data, to_srgb=True).array
            visible = shown[:, 3] > 0
            colours = array.reshape(len(shown), -1)
            assert np.abs(colours[visible, :3].astype(int) - shown[visible, :3]).max() <= 3
            if colours.shape[1] == 4:
                assert np.array_equal(colours[:, 3], shown[:, 3])


@pytest.mark.parametrize("kind", [b"tEXt", b"zTXt", b"iTXt"])
def test_a_long_text_costs_no_picture(kind: bytes) -> None:
    text = b"long " * MEBIBYTE
    content = {
        b"tEXt": b"Comment\0" + text,
        b"zTXt": b"Comment\0\0" + zlib.compress(text),
        b"iTXt": b"Comment\0\1\0\0\0" + zlib.compress(text),
    }[kind]
    for places in ({"more": [(kind, content)]}, {"last": [(kind, content)]}):
        picture = read(png(scene(), 8, RGB, **places))
        assert np.array_equal(picture.array, scene())


def test_a_long_profile_and_a_long_xmp_are_kept() -> None:
    profile = srgb_profile() + bytes(2 * MEBIBYTE)
    xmp = b"<x/>" + b" " * MEBIBYTE
    more = [
        (b"iCCP", b"wide\0\0" + zlib.compress(profile)),
        (b"iTXt", b"XML:com.adobe.xmp\0\1\0\0\0" + zlib.compress(xmp)),
    ]
    picture = read(png(scene(), 8, RGB, more))
    assert picture.metadata.icc == profile
    assert picture.metadata.xmp == xmp
    assert picture.notes == ()


def test_a_profile_over_the_limit_is_left_out_and_told() -> None:
    bomb = zlib.compress(bytes(64 * MEBIBYTE))
    more = [(b"iCCP", b"bomb\0\0" + bomb), (b"zTXt", b"Comment\0\0" + bomb)]
    picture = read(png(scene(), 8, RGB, more))
    assert picture.metadata.icc == b""
    assert [note for note in picture.notes if "profile" in note]


def test_metadata_that_are_too_long_together_are_left_out_from_the_longest_on() -> None:
    xmp = b" " * 900
    more = [
        (b"iCCP", b"wide\0\0" + zlib.compress(srgb_profile())),
        (b"iTXt", b"XML:com.adobe.xmp\0\0\0\0\0" + xmp),
    ]
    picture = read(png(scene(), 8, RGB, more), vmesh.Limits(max_metadata=1000))
    assert picture.metadata.xmp == b""
    assert picture.metadata.icc == srgb_profile()
    assert "XMP of 900 bytes was left out" in picture.notes[0]


def test_the_exif_in_a_text_of_old_programs_is_kept() -> None:
    exif = Image.Exif()
    exif[0x010E] = "a description"
    block = exif.tobytes()
    text = f"\nexif\n{len(block):8}\n{block.hex()}\n".encode()
    picture = read(
        png(scene(), 8, RGB, [(b"zTXt", b"Raw profile type exif\0\0" + zlib.compress(text))])
    )
    kept = Image.Exif()
    kept.load(picture.metadata.exif)
    assert kept[0x010E] == "a description"


def test_gamma_is_applied_unless_a_profile_goes_before_it() -> None:
    gamma = (b"gAMA", (100_000).to_bytes(4, "big"))
    linear = read(png(scene(), 8, RGB, [gamma]))
    assert linear.array.mean() > scene().mean() + 30
    profile = (b"iCCP", b"sRGB\0\0" + zlib.compress(srgb_profile()))
    assert np.array_equal(read(png(scene(), 8, RGB, [gamma, profile])).array, scene())
    srgb = (b"gAMA", (45_455).to_bytes(4, "big"))
    assert np.array_equal(read(png(scene(), 8, RGB, [srgb])).array, scene())
    nonsense = (b"gAMA", bytes(4))
    assert np.array_equal(read(png(scene(), 8, RGB, [nonsense])).array, scene())


def test_a_deep_interlaced_picture_is_read_like_a_plain_one() -> None:
    deep = scene(21, 13).astype(np.uint16) * 257 + 1
    starts = [(0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4)]
    starts += [(0, 2, 2, 4), (1, 0, 2, 2), (0, 1, 1, 2)]
    rows = b"".join(
        b"\0" + row.astype(">u2").tobytes()
        for x, y, across, down in starts
        for row in deep[y::down, x::across]
    )
    plain = png(deep, 16, RGB)
    header = plain[16:29][:-1] + b"\1"
    data = PNG_START + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows))
    assert np.array_equal(read(data + chunk(b"IEND", b"")).array, deep)


@pytest.mark.parametrize(
    ("damage", "words"),
    [
        (lambda d: d.replace(b"\r\n", b"\n", 1), "transfer as text"),
        (lambda d: d[:29] + bytes(4) + d[33:], "checksum of a chunk IHDR"),
        (lambda d: re.sub(b"(?s)(IDAT....)..", rb"\1xx", d, count=1), "damaged"),
        (lambda d: PNG_START + d[8:33] + chunk(b"IEND", b""), "no samples"),
        (lambda d: PNG_START + chunk(b"IHDR", d[16:24] + b"\x03\x02\0\0\0") + d[33:], "3 bits"),
        (lambda d: PNG_START + chunk(b"IHDR", d[16:24] + b"\x08\x05\0\0\0") + d[33:], "type 5"),
    ],
)
def test_what_is_wrong_with_a_damaged_file_is_said(damage: object, words: str) -> None:
    with pytest.raises(vmesh.ImageError, match=words):
        read(damage(png(scene(), 8, RGB)))  # type: ignore[operator]


@pytest.mark.parametrize("color_type", [GREY, RGB, PALETTE])
def test_a_damaged_file_is_read_or_refused(color_type: int) -> None:
    rows = scene(9, 9) if color_type == RGB else scene(9, 9)[:, :, 0]
    more = [(b"PLTE", bytes(range(256)) * 3)] if color_type == PALETTE else []
    data = png(rows, 8, color_type, [*more, (b"tRNS", b"\0\1\0\2\0\3")])
    random = np.random.default_rng(1)
    for _ in range(150):
        damaged = bytearray(data)
        for at in random.integers(8, len(data), 2):
            damaged[at] = random.integers(0, 256)
        try:
            read(bytes(damaged))
        except (vmesh.ImageError, vmesh.LimitError):
            continue


@pytest.mark.parametrize("still_is_first", [True, False])
def test_the_still_picture_of_an_animation_is_read_and_the_rest_told(still_is_first: bool) -> None:
    frames = [255 - scene(), scene()[::-1].copy(), scene()[:, ::-1].copy()]
    picture = read(apng(scene(), frames, still_is_first=still_is_first))
    assert np.array_equal(picture.array, scene())
    (note,) = picture.notes
    assert ("animation of 4 frames" if still_is_first else "the 3 frames of its animation") in note
    second = read(apng(scene(), frames, still_is_first=still_is_first), page=2)
    assert np.array_equal(second.array, frames[0])
    assert second.notes == ()


def test_a_deep_still_keeps_its_bits_in_an_animation() -> None:
    deep = scene().astype(np.uint16) * 257 + 5
    data = png(deep, 16, RGB, [(b"acTL", bytes(3) + b"\1" + bytes(4))])
    assert np.array_equal(read(data).array, deep)


def test_grey_with_a_transparent_level_of_pillow_is_read_as_before() -> None:
    image = Image.fromarray(scene()[:, :, 0])
    array = read(saved(image, "PNG", transparency=int(scene()[0, 0, 0]))).array
    assert array[0, 0, 3] == 0
