"""Formats by content: plug-ins that read some, and words about files that are none of them."""

from __future__ import annotations

import io
import sys

import numpy as np
import pytest
from PIL import Image

import vmesh
from tests.formats.files import read, saved, scene, tiff
from vmesh.formats.color.profiles import srgb_profile
from vmesh.formats.picture.options import PictureOptions
from vmesh.formats.picture.picture import read_picture


@pytest.fixture
def heif() -> object:
    module = pytest.importorskip("pillow_heif")
    module.register_heif_opener()
    return module


@pytest.fixture
def jxl() -> object:
    return pytest.importorskip("pillow_jxl")


def without(monkeypatch: pytest.MonkeyPatch, opener: str, module: str) -> None:
    """As if a plug-in were neither registered nor installed."""
    Image.init()
    monkeypatch.delitem(Image.OPEN, opener, raising=False)
    monkeypatch.setitem(sys.modules, module, None)


def near(array: np.ndarray, other: np.ndarray) -> bool:
    return array.shape == other.shape and bool(np.abs(array.astype(int) - other).mean() < 12)


def test_a_photograph_of_a_phone_is_read_upright_with_its_metadata(heif: object) -> None:
    exif = Image.Exif()
    exif[271], exif[274] = "Phone", 6
    thumbnail_and_all = saved(
        scene(96, 128), "HEIF", quality=95, exif=exif, icc_profile=srgb_profile(), thumbnails=[32]
    )
    picture = read(thumbnail_and_all)
    with Image.open(io.BytesIO(thumbnail_and_all)) as image:
        assert np.array_equal(picture.array, np.asarray(image))
    assert picture.metadata.icc == srgb_profile()
    kept = Image.Exif()
    kept.load(picture.metadata.exif)
    assert (kept[271], kept.get(274, 1)) == ("Phone", 1)
    assert picture.notes == ()


def test_the_main_picture_of_several_is_read(heif: object) -> None:
    more = [Image.fromarray(scene(96, 64))]
    data = saved(
        scene(32, 48), "HEIF", quality=95, save_all=True, append_images=more, primary_index=1
    )
    picture = read(data)
    assert near(picture.array, scene(96, 64))
    assert "page 2, the main one" in picture.notes[0]
    assert near(read(data, page=1).array, scene(32, 48))


def test_samples_of_ten_bits_are_rounded_and_that_is_told(heif: object) -> None:
    deep = (scene(64, 64).astype(np.uint16) * 257).tobytes()
    stream = io.BytesIO()
    heif.from_bytes("RGB;16", (64, 64), deep).save(stream, quality=95)  # type: ignore[attr-defined]
    picture = read(stream.getvalue())
    assert near(picture.array, scene(64, 64))
    assert picture.notes == ("its samples of 10 bits were rounded to 8",)


@pytest.mark.parametrize("quality", [{"lossless": True}, {"quality": 95}])
def test_jpeg_xl_is_read(jxl: object, quality: dict[str, object]) -> None:
    data = saved(scene(), "JXL", icc_profile=srgb_profile(), **quality)
    picture = read(data)
    assert near(picture.array, scene())
    assert picture.notes == ()


@pytest.mark.parametrize("keeps_the_jpeg", [True, False])
def test_jpeg_xl_of_a_turned_jpeg_is_turned_once(jxl: object, keeps_the_jpeg: bool) -> None:
    import imagecodecs

    exif = Image.Exif()
    exif[274] = 6
    jpeg = saved(scene(), "JPEG", quality=95, exif=exif)
    data = imagecodecs.jpegxl_encode_jpeg(jpeg)
    if not keeps_the_jpeg:
        at = data.index(b"jbrd") - 4
        data = data[:at] + data[at + int.from_bytes(data[at : at + 4], "big") :]
    picture = read(data)
    assert near(picture.array, np.rot90(scene(), -1))
    kept = Image.Exif()
    kept.load(picture.metadata.exif)
    assert kept.get(274, 1) == 1


def test_jpeg_xl_is_measured_before_it_is_decoded(jxl: object) -> None:
    for size in ((64, 64), (300, 200), (64, 48), (16, 9)):
        data = saved(scene(size[1], size[0]), "JXL")
        with pytest.raises(vmesh.LimitError, match=f"{size[0]} x {size[1]} "):
            read(data, vmesh.Limits(max_pixels=10))


@pytest.mark.parametrize(
    ("start", "opener", "module", "words"),
    [
        (b"\0\0\0\x18ftypheic\0\0\0\0mif1heic", "HEIF", "pillow_heif", "HEIC.*vmesh.heif."),
        (b"\0\0\0\x18ftypmif1\0\0\0\0mif1heic", "HEIF", "pillow_heif", "HEIC.*vmesh.heif."),
        (b"\xff\x0a\x7f\x00", "JXL", "pillow_jxl", "JPEG XL.*vmesh.jxl."),
        (b"\0\0\0\x0cJXL \r\n\x87\n", "JXL", "pillow_jxl", "JPEG XL.*vmesh.jxl."),
    ],
)
def test_a_missing_plug_in_is_named(
    monkeypatch: pytest.MonkeyPatch, start: bytes, opener: str, module: str, words: str
) -> None:
    without(monkeypatch, opener, module)
    with pytest.raises(vmesh.ImageError, match=words):
        read(start + bytes(40))


def test_a_plug_in_is_imported_when_its_format_comes(
    monkeypatch: pytest.MonkeyPatch, heif: object
) -> None:
    data = saved(scene(64, 64), "HEIF", quality=95)
    Image.init()
    monkeypatch.delitem(Image.OPEN, "HEIF")
    assert near(read(data).array, scene(64, 64))


def test_an_opener_that_the_application_registered_is_used(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from PIL import ImageFile

    class Plain(ImageFile.ImageFile):
        format = "PLAIN"

        def _open(self) -> None:
            self._mode, self._size = "L", (2, 2)
            self.tile = [ImageFile._Tile("raw", (0, 0, 2, 2), 4, "L")]

    Image.init()
    monkeypatch.setitem(Image.OPEN, "PLAIN", (Plain, lambda start: start.startswith(b"PLN!")))
    assert read(b"PLN!\1\2\3\4").array.tolist() == [[1, 2], [3, 4]]


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"%PDF-1.7\n", "PDF"),
        (b"%!PS-Adobe-3.0\n", "PostScript"),
        (b"8BPS\0\1", "Photoshop"),
        (b'<?xml version="1.0"?>\n<svg xmlns="http://www.w3.org/2000/svg"/>', "SVG"),
        (b"<!DOCTYPE html><html></html>", "web page"),
        (b"\0\0\0\x20ftypisom\0\0\2\0isomiso2avc1mp41", "video"),
        (b"\0\0\0\x18ftypcrx \0\0\0\1crx isom", "raw file"),
        (b"FUJIFILMCCD-RAW 0201", "raw file"),
        (b"II*\0\x10\0\0\0CR\2\0" + bytes(40), "raw file|damaged"),
        (b"\x1aE\xdf\xa3\1\0\0", "video"),
        (b"RIFF\x24\0\0\0AVI LIST", "video"),
        (b"PK\3\4\x14\0", "archive"),
        (b"version https://git-lfs.github.com/spec/v1\noid sha256:0\n", "Git LFS"),
        (b"\x76\x2f\x31\x01\2\0\0\0", "OpenEXR"),
        (b"GIF89a", "damaged.*GIF"),
    ],
)
def test_what_a_file_is_instead_is_said_in_a_sentence(data: bytes, words: str) -> None:
    with pytest.raises(vmesh.ImageError, match=words):
        read(data + bytes(20))


def test_a_raw_file_that_looks_like_a_tiff_is_told_apart() -> None:
    data = tiff(scene(), photometric="rgb", extratags=[(50706, 1, 4, (1, 4, 0, 0), True)])
    with pytest.raises(vmesh.ImageError, match="raw file of a camera"):
        read(data)


@pytest.mark.parametrize("format_name", ["PNG", "JPEG", "TIFF", "WEBP", "GIF", "BMP", "AVIF"])
def test_the_content_decides_and_not_a_name(format_name: str) -> None:
    stream = io.BytesIO(saved(scene(), format_name))
    stream.name = "photograph.txt"
    picture = read_picture(stream, options=PictureOptions())
    assert picture.array.shape[:2] == scene().shape[:2]


def test_deep_readers_are_not_imported_for_plain_pictures() -> None:
    import subprocess

    script = (
        "import io, sys\n"
        "from PIL import Image\n"
        "from vmesh.formats.picture.picture import read_picture\n"
        "for name in ('PNG', 'JPEG', 'WEBP'):\n"
        "    stream = io.BytesIO(); Image.new('RGB', (9, 9)).save(stream, name)\n"
        "    read_picture(stream if not stream.seek(0) else stream)\n"
        "print(sorted({'tifffile', 'imagecodecs', 'pillow_heif', 'pillow_jxl'} & set(sys.modules)))"
    )
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "[]"
