"""Colours of photographs in all spaces: what is stored, and what outputs show."""

from __future__ import annotations

import base64
import io
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

import vmesh
from tests.formats.renderers import SVG_RENDERERS
from tests.pages import embedded_meshes
from tests.pictures import constant, grey_ramp, noise, ramp
from tests.profiles import grey_profile, managed, press_profile, wide_profile
from vmesh.arrays import SampleArray, UInt8Array
from vmesh.codec.profile_name import profile_name
from vmesh.formats.color.conversion import mesh_in_srgb, to_srgb
from vmesh.formats.color.profiles import srgb_profile
from vmesh.formats.picture.options import PictureOptions
from vmesh.formats.picture.picture import Picture, read_picture
from vmesh.metrics import psnr

WIDE = wide_profile()


def saved(image: Image.Image, format_name: str = "PNG", **options: Any) -> bytes:
    stream = io.BytesIO()
    image.save(stream, format_name, **options)
    return stream.getvalue()


def read(data: bytes, **options: Any) -> Picture:
    return read_picture(io.BytesIO(data), options=PictureOptions(**options))


def without_marker(jpeg: bytes) -> bytes:
    """A JPEG file without Adobe's marker."""
    at = jpeg.index(b"\xff\xee")
    (length,) = struct.unpack(">H", jpeg[at + 2 : at + 4])
    return jpeg[:at] + jpeg[at + 2 + length :]


def png(samples: SampleArray, *chunks: tuple[bytes, bytes]) -> bytes:
    """A PNG of grey or RGB of 8 bits with further chunks."""

    def chunk(tag: bytes, content: bytes) -> bytes:
        checksum = zlib.crc32(tag + content)
        return struct.pack(">I", len(content)) + tag + content + struct.pack(">I", checksum)

    height, width = samples.shape[:2]
    rows = b"".join(b"\0" + row.tobytes() for row in samples)
    header = struct.pack(">IIBBBBB", width, height, 8, 0 if samples.ndim == 2 else 2, 0, 0, 0)
    inner = b"".join(chunk(*item) for item in chunks)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", header)
        + inner
        + chunk(b"IDAT", zlib.compress(rows))
        + chunk(b"IEND", b"")
    )


def gamma_chunk(gamma: float) -> tuple[bytes, bytes]:
    return b"gAMA", struct.pack(">I", round(gamma * 100_000))


def place_chunk(*places: float) -> tuple[bytes, bytes]:
    return b"cHRM", struct.pack(">8I", *(round(place * 100_000) for place in places))


ADOBE = place_chunk(0.3127, 0.3290, 0.64, 0.33, 0.21, 0.71, 0.15, 0.06)


def shown(picture: Picture) -> SampleArray:
    """What a colour-managed viewer shows of a picture as it is stored."""
    return to_srgb(picture.array, picture.metadata.icc)


@pytest.mark.parametrize("stored", ["JPEG", "JPEG without marker", "TIFF"])
def test_inks_become_what_a_viewer_shows_through_their_profile(stored: str) -> None:
    inks, profile = Image.fromarray(ramp(40, 60)).convert("CMYK"), press_profile()
    options = {"quality": 100, "subsampling": 0} if "JPEG" in stored else {}
    data = saved(inks, stored.split()[0], icc_profile=profile, **options)
    picture = read(without_marker(data) if "marker" in stored else data)
    reference, plain = managed(inks, profile), np.asarray(inks.convert("RGB"))
    assert psnr(picture.array, reference) > 40 > psnr(plain, reference)
    assert picture.metadata.icc == b""
    assert picture.notes == ()


@pytest.mark.parametrize("profile", [b"", WIDE, press_profile()[:300]])
def test_inks_without_a_profile_of_their_own_are_converted_plainly_and_told(profile: bytes) -> None:
    inks = Image.fromarray(ramp(40, 60)).convert("CMYK")
    picture = read(saved(inks, "TIFF", icc_profile=profile))
    assert np.abs(picture.array.astype(int) - np.asarray(inks.convert("RGB"))).max() <= 1
    assert picture.metadata.icc == b""
    assert "plain formula" in picture.notes[-1]
    assert (len(picture.notes) == 2) == bool(profile)


def test_inks_stored_the_other_way_round_without_a_marker_give_no_negative() -> None:
    inks = Image.fromarray(ramp(40, 60)).convert("CMYK")
    turned = Image.merge("CMYK", [band.point(lambda level: 255 - level) for band in inks.split()])
    data = without_marker(saved(turned, "JPEG", quality=100, subsampling=0))
    picture = read(data)
    assert psnr(picture.array, np.asarray(inks.convert("RGB"))) > 40
    assert "amounts of ink" in picture.notes[0]


def test_lab_is_what_a_viewer_shows() -> None:
    from PIL import ImageCms

    rgb = Image.fromarray(ramp(40, 60))
    lab = ImageCms.profileToProfile(
        rgb, ImageCms.createProfile("sRGB"), ImageCms.createProfile("LAB"), outputMode="LAB"
    )
    assert lab is not None
    picture = read(saved(lab, "TIFF", icc_profile=WIDE))
    assert psnr(picture.array, np.asarray(rgb)) > 35
    assert picture.metadata.icc == b""


@pytest.mark.parametrize(
    ("mode", "profile", "format_name"),
    [("RGB", WIDE, name) for name in ("PNG", "JPEG", "WEBP", "TIFF")]
    + [("L", grey_profile(), name) for name in ("PNG", "JPEG", "TIFF")],
)
def test_a_profile_that_fits_is_kept_with_its_numbers(
    mode: str, profile: bytes, format_name: str
) -> None:
    image = Image.fromarray(ramp(20, 20)).convert(mode)
    picture = read(saved(image, format_name, icc_profile=profile))
    assert picture.metadata.icc == profile
    assert picture.notes == ()
    if format_name in ("PNG", "TIFF"):
        assert np.array_equal(picture.array, np.asarray(image))


@pytest.mark.parametrize(
    ("mode", "profile", "reason"),
    [
        ("RGB", grey_profile(), "for grey, not for RGB"),
        ("RGB", press_profile(), "'Press' is for CMYK, not for RGB"),
        ("L", press_profile(), "for CMYK, not for grey"),
        ("RGB", WIDE[:250], "damaged"),
        ("L", grey_profile()[:150], "damaged"),
        ("RGBA", b"no profile at all", "damaged"),
        ("RGB", noise(1, 600, 1).tobytes(), "damaged"),
    ],
)
def test_a_profile_that_does_not_fit_is_left_out_and_told(
    mode: str, profile: bytes, reason: str
) -> None:
    image = Image.fromarray(ramp(20, 20)).convert(mode)
    picture = read(saved(image, icc_profile=profile))
    assert np.array_equal(picture.array, np.asarray(image))
    assert picture.metadata.icc == b""
    (note,) = picture.notes
    assert reason in note
    assert note.endswith("left out")


@pytest.mark.parametrize("mode", ["L", "LA", "I;16"])
def test_grey_with_a_profile_for_colours_gets_its_tones(mode: str) -> None:
    tones, profile = grey_ramp(3, 256), wide_profile(1.0)
    image = Image.fromarray(tones)
    if mode == "I;16":
        image = Image.fromarray(tones.astype(np.uint16) * 257)
    elif mode == "LA":
        image.putalpha(200)
    picture = read(saved(image, icc_profile=profile))
    if mode == "LA":
        # It is RGBA from now on, which the profile fits.
        assert picture.metadata.icc == profile
        return
    largest = np.iinfo(picture.array.dtype).max
    expected = managed(Image.fromarray(tones).convert("RGB"), profile)[:, :, 1]
    assert picture.metadata.icc == b""
    assert "not for grey" in picture.notes[0]
    assert np.abs(picture.array / largest * 255 - expected).max() <= 1


def test_grey_with_alpha_gets_the_tones_of_its_grey_profile() -> None:
    tones, profile = grey_ramp(3, 256), grey_profile()
    image = Image.fromarray(tones)
    image.putalpha(Image.fromarray(tones[:, ::-1].copy()))
    picture = read(saved(image, icc_profile=profile))
    expected = managed(Image.fromarray(tones).convert("L"), profile)
    assert np.abs(picture.array[:, :, :3].astype(int) - expected).max() <= 1
    assert np.array_equal(picture.array[:, :, 3], tones[:, ::-1])
    assert picture.metadata.icc == b""


def test_srgb_for_grey_changes_nothing_but_is_told() -> None:
    picture = read(saved(Image.fromarray(grey_ramp(3, 256)), icc_profile=srgb_profile()))
    assert np.array_equal(picture.array, grey_ramp(3, 256))
    assert "changes no colour" in picture.notes[0]


@pytest.mark.parametrize(
    "chunks",
    [
        (gamma_chunk(1 / 2.2),),
        (gamma_chunk(0.45),),
        (gamma_chunk(1 / 2.2), place_chunk(0.3127, 0.329, 0.64, 0.33, 0.3, 0.6, 0.15, 0.06)),
        (gamma_chunk(1.0), (b"sRGB", b"\0")),
        (ADOBE,),
        (gamma_chunk(0),),
        (gamma_chunk(21_000),),
        (gamma_chunk(1.0), place_chunk(*8 * [0])),
    ],
)
def test_png_numbers_that_say_srgb_or_nothing_change_nothing(
    chunks: tuple[tuple[bytes, bytes], ...],
) -> None:
    picture = read(png(ramp(20, 20), *chunks))
    assert picture.metadata == vmesh.Metadata()
    assert np.array_equal(picture.array, ramp(20, 20))


@pytest.mark.parametrize("gamma", [0.35, 0.55, 0.7, 1.0, 2.5])
def test_png_gamma_is_applied_as_a_power(gamma: float) -> None:
    tones = grey_ramp(3, 256)
    linear = (tones / 255) ** (1 / gamma)
    expected = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    grey = read(png(tones, gamma_chunk(gamma)))
    rgb = read(png(np.repeat(tones[:, :, None], 3, axis=2), gamma_chunk(gamma)))
    assert np.abs(grey.array - 255 * expected).max() <= 1
    assert np.array_equal(rgb.array[:, :, 2], grey.array)
    assert grey.metadata == rgb.metadata == vmesh.Metadata()


def test_png_primaries_become_a_profile() -> None:
    picture = read(png(ramp(20, 20), gamma_chunk(1 / 2.2), ADOBE))
    assert np.array_equal(picture.array, ramp(20, 20))
    reference = managed(Image.fromarray(ramp(20, 20)), picture.metadata.icc)
    assert np.abs(shown(picture).astype(int) - reference).max() <= 1
    assert psnr(shown(picture), ramp(20, 20)) < 35


def test_a_camera_that_says_adobe_rgb_gets_its_profile() -> None:
    exif = Image.Exif()
    exif.get_ifd(0x8769)[0xA005] = {1: "R03"}
    image = Image.fromarray(ramp(20, 20))
    picture = read(saved(image, "JPEG", exif=exif))
    assert "Adobe RGB" in picture.notes[0]
    assert psnr(shown(picture), picture.array) < 35
    own = read(saved(image, "JPEG", exif=exif, icc_profile=WIDE))
    assert own.metadata.icc == WIDE
    assert read(saved(image.convert("L"), "JPEG", exif=exif)).metadata.icc == b""


@pytest.fixture(scope="module")
def browser_pixel() -> Iterator[Any]:
    """The colour that a browser shows of a file's middle, as numbers of sRGB."""
    from tests.formats.browser import running

    script = """async ([file, x, y]) => {
        const image = new Image();
        image.src = file;
        await image.decode();
        const canvas = document.createElement("canvas");
        const context = canvas.getContext("2d", { colorSpace: "srgb" });
        context.drawImage(image, 0, 0);
        return [...context.getImageData(x, y, 1, 1).data].slice(0, 3);
    }"""
    with running() as browser:
        page = browser.new_page()

        def pixel(data: bytes, kind: str) -> Any:
            file = f"data:image/{kind};base64,{base64.b64encode(data).decode()}"
            return page.evaluate(script, [file, 8, 8])

        yield pixel


COLOR, GREY = constant(16, 16, 180, 90, 40), constant(16, 16, 100)
FILES = {
    "RGB, wide": (saved(Image.fromarray(COLOR), icc_profile=WIDE), "png"),
    "RGB, linear": (saved(Image.fromarray(COLOR), icc_profile=wide_profile(1.0)), "png"),
    "RGB, for grey": (saved(Image.fromarray(COLOR), icc_profile=grey_profile()), "png"),
    "RGB, damaged": (saved(Image.fromarray(COLOR), icc_profile=WIDE[:200]), "png"),
    "grey, linear RGB": (saved(Image.fromarray(GREY), icc_profile=wide_profile(1.0)), "png"),
    "grey, grey": (saved(Image.fromarray(GREY), icc_profile=grey_profile()), "png"),
    "grey JPEG, linear": (
        saved(Image.fromarray(GREY), "JPEG", icc_profile=wide_profile(1.0)),
        "jpeg",
    ),
    "inks": (saved(Image.fromarray(COLOR).convert("CMYK"), "JPEG", quality=100), "jpeg"),
    "inks, bare": (
        without_marker(saved(Image.fromarray(COLOR).convert("CMYK"), "JPEG", quality=100)),
        "jpeg",
    ),
    "gamma 0.35": (png(COLOR, gamma_chunk(0.35)), "png"),
    "gamma 0.45": (png(COLOR, gamma_chunk(0.45)), "png"),
    "gamma 1": (png(COLOR, gamma_chunk(1.0)), "png"),
    "gamma 2.5, grey": (png(GREY, gamma_chunk(2.5)), "png"),
    "Adobe's primaries": (png(COLOR, gamma_chunk(0.55), ADOBE), "png"),
    "primaries alone": (png(COLOR, ADOBE), "png"),
    "sRGB beats gamma": (png(COLOR, (b"sRGB", b"\0"), gamma_chunk(1.0)), "png"),
}


@pytest.mark.parametrize("case", FILES)
def test_colors_are_those_that_a_browser_shows(case: str, browser_pixel: Any) -> None:
    data, kind = FILES[case]
    own = np.broadcast_to(shown(read(data))[8, 8], 3).astype(int)
    assert np.abs(own - browser_pixel(data, kind)).max() <= 1


@pytest.mark.parametrize("n_components", [1, 3, 4])
@pytest.mark.parametrize("depth", [8, 11, 16])
def test_conversion_keeps_shape_depth_and_alpha(n_components: int, depth: int) -> None:
    plain = noise(20, 30, n_components)
    largest = (1 << depth) - 1
    picture = (plain * np.int64(largest) // 255).astype(np.uint8 if depth == 8 else np.uint16)
    if n_components == 1:
        plain, picture = plain[:, :, 0], picture[:, :, 0]
    profile = grey_profile() if n_components == 1 else WIDE
    converted = to_srgb(picture, profile, depth)
    assert (converted.shape, converted.dtype) == (picture.shape, picture.dtype)
    mode = "L" if n_components == 1 else "RGB"
    reference = managed(
        Image.fromarray(plain[..., :3] if n_components > 1 else plain, mode), profile
    )
    got = converted / largest * 255
    want = reference[:, :, 1] if n_components == 1 else reference
    colors = got if n_components == 1 else got[:, :, :3]
    assert np.abs(colors - want).max() <= (1 if depth == 8 else 1.6)
    if n_components == 4:
        assert np.array_equal(converted[:, :, 3], picture[:, :, 3])


def test_srgb_is_not_converted_to_itself() -> None:
    picture = noise(20, 30)
    assert to_srgb(picture, srgb_profile()) is picture
    assert to_srgb(picture, b"") is picture
    assert to_srgb(picture, b"damaged") is picture


def test_photographs_are_brought_to_srgb_on_request() -> None:
    image = Image.fromarray(ramp(30, 40))
    picture = read(saved(image, icc_profile=WIDE), to_srgb=True)
    assert np.abs(picture.array.astype(int) - managed(image, WIDE)).max() <= 1
    assert picture.metadata.icc == b""


@pytest.fixture(scope="module")
def wide() -> vmesh.Mesh:
    return vmesh.encode(ramp(60, 80), quality=90, effort=1, metadata=vmesh.Metadata(icc=WIDE))


def in_srgb(mesh: vmesh.Mesh) -> UInt8Array:
    """The picture of a mesh as a colour-managed viewer shows it."""
    return managed(Image.fromarray(vmesh.render(mesh)), mesh.metadata.icc)


@pytest.mark.parametrize(
    "options",
    [{}, {"mode": "exact"}, {"mode": "flat"}, {"fit": ramp(60, 80)}],
    ids=["gradient", "exact", "flat", "fitted"],
)
def test_a_drawing_of_a_wide_mesh_shows_its_colors(
    wide: vmesh.Mesh, options: dict[str, Any], tmp_path: Path
) -> None:
    path = tmp_path / "wide.svg"
    vmesh.export(wide, path, **options)
    drawn = SVG_RENDERERS["resvg"](path, 1)
    numbers = vmesh.render(wide)
    assert psnr(drawn, in_srgb(wide)) > psnr(drawn, numbers) + 4


def test_a_model_of_a_wide_mesh_has_its_colors(wide: vmesh.Mesh, tmp_path: Path) -> None:
    for name in ("wide.ply", "wide.obj", "wide.glb"):
        vmesh.export(wide, tmp_path / name)
        back = vmesh.import_mesh(tmp_path / name)
        assert psnr(vmesh.render(back), in_srgb(wide)) > 35


def test_pixels_of_a_wide_mesh_are_in_srgb_where_there_is_no_profile(
    wide: vmesh.Mesh, tmp_path: Path
) -> None:
    vmesh.export(wide, tmp_path / "wide.pam")
    vmesh.export(wide, tmp_path / "wide.png")
    raw = (tmp_path / "wide.pam").read_bytes().partition(b"ENDHDR\n")[2]
    pixels = np.frombuffer(raw, np.uint8).reshape(60, 80, 3)
    assert np.abs(pixels.astype(int) - in_srgb(wide)).max() <= 1
    with Image.open(tmp_path / "wide.png") as image:
        assert image.info["icc_profile"] == WIDE
        assert np.array_equal(np.asarray(image), vmesh.render(wide))


def test_a_page_of_a_wide_mesh_holds_it_in_srgb(wide: vmesh.Mesh, tmp_path: Path) -> None:
    vmesh.export(wide, tmp_path / "wide.html")
    (embedded,) = embedded_meshes((tmp_path / "wide.html").read_text("utf-8"))
    assert embedded.metadata.icc == b""
    assert psnr(vmesh.render(embedded), in_srgb(wide)) > 35


def test_the_text_of_a_wide_mesh_keeps_its_levels(wide: vmesh.Mesh, tmp_path: Path) -> None:
    vmesh.export(wide, tmp_path / "wide.txt")
    assert np.array_equal(vmesh.import_mesh(tmp_path / "wide.txt").levels, wide.canonical().levels)


@pytest.mark.parametrize("depth", [8, 12, 16])
@pytest.mark.parametrize("n_components", [1, 3, 4])
def test_a_mesh_in_srgb_has_the_same_triangles_and_converted_colors(
    n_components: int, depth: int
) -> None:
    profile = grey_profile() if n_components == 1 else WIDE
    colors = np.random.default_rng(1).integers(0, 1 << depth, (4, n_components))
    square, triangles = [(0, 0), (9, 0), (9, 9), (0, 9)], [(0, 1, 2), (0, 2, 3)]
    mesh = vmesh.Mesh.from_colors(
        9, 9, square, triangles, colors, depth=depth, metadata=vmesh.Metadata(icc=profile, xmp=b"x")
    )
    converted = mesh_in_srgb(mesh)
    assert np.array_equal(converted.triangles, mesh.triangles)
    assert converted.metadata == vmesh.Metadata(xmp=b"x")
    expected = to_srgb(mesh.colors[None], profile, depth)[0]
    if n_components == 1:
        expected = to_srgb(mesh.colors, profile, depth)
    assert np.array_equal(converted.colors, expected)
    plain = mesh.replaced(metadata=vmesh.Metadata())
    assert mesh_in_srgb(plain) is plain


def test_an_unfitting_profile_of_a_mesh_changes_no_color(wide: vmesh.Mesh) -> None:
    for profile in (grey_profile(), b"damaged", WIDE[:200]):
        converted = mesh_in_srgb(wide.replaced(metadata=vmesh.Metadata(icc=profile)))
        assert np.array_equal(converted.colors, wide.colors)
        assert converted.metadata == vmesh.Metadata()


def test_profiles_are_known_by_their_names() -> None:
    assert profile_name(press_profile("Coated paper")) == "Coated paper"
    assert profile_name(srgb_profile()) == "sRGB built-in"
    assert profile_name(press_profile("two\nlines\x1b[31m")) == "twolines[31m"
    assert len(profile_name(press_profile(1000 * "long"))) <= 80


@given(st.binary(max_size=300), st.integers(0, 400), st.binary(max_size=40))
def test_the_name_of_a_damaged_profile_is_a_line_or_nothing(
    junk: bytes, place: int, patch: bytes
) -> None:
    good = srgb_profile()
    for profile in (junk, good[:place], good[:place] + patch + good[place + len(patch) :]):
        assert profile_name(profile).isprintable()
