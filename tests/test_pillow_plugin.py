from __future__ import annotations

import io
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, UnidentifiedImageError

import vmesh
from tests.pictures import PICTURES, psnr
from vmesh.arrays import UInt8Array
from vmesh.formats.color.profiles import srgb_profile
from vmesh.mesh import Metadata
from vmesh.pillow_plugin import VmeshImageFile


@pytest.fixture(autouse=True, scope="module")
def registered() -> None:
    vmesh.register()


@pytest.fixture(scope="module")
def mesh(coffee: UInt8Array) -> vmesh.Mesh:
    return vmesh.encode(coffee, vertices=1000, effort=1)


@pytest.fixture(scope="module")
def file(mesh: vmesh.Mesh, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("pillow") / "coffee.vmesh"
    vmesh.dump(mesh, path)
    return path


def saved(image: Image.Image, **options: object) -> bytes:
    """The file that Pillow makes of an image."""
    stream = io.BytesIO()
    image.save(stream, "VMESH", **options)
    return stream.getvalue()


def test_pillow_draws_what_vmesh_draws(file: Path, mesh: vmesh.Mesh) -> None:
    with Image.open(file) as image:
        assert (image.format, image.mode, image.size) == ("VMESH", "RGB", (600, 400))
        assert image.get_format_mimetype() == "image/vnd.vmesh"
        assert np.array_equal(np.asarray(image), vmesh.render(mesh))


def test_a_file_is_told_by_its_signature_and_not_by_its_name(file: Path, tmp_path: Path) -> None:
    other = tmp_path / "coffee.jpg"
    other.write_bytes(file.read_bytes())
    with Image.open(other) as image:
        assert image.format == "VMESH"


@pytest.mark.parametrize("name", ["one grey pixel", "grey ramp", "ramp", "disc", "one column"])
def test_pictures_of_all_kinds_come_back(name: str) -> None:
    picture = PICTURES[name]
    data = saved(Image.fromarray(picture), quality=100, color_step=1)
    with Image.open(io.BytesIO(data)) as image:
        n_components = 1 if picture.ndim == 2 else picture.shape[2]
        assert image.mode == {1: "L", 3: "RGB", 4: "RGBA"}[n_components]
        assert np.array_equal(np.asarray(image), vmesh.render(vmesh.loads(data)))


def test_deep_grey_is_an_image_of_16_bits() -> None:
    deep = (PICTURES["grey ramp"].astype(np.uint16) * 257)[:, ::-1].copy()
    data = saved(Image.fromarray(deep), quality=100)
    with Image.open(io.BytesIO(data)) as image:
        assert image.mode == "I;16"
        assert np.array_equal(np.asarray(image), vmesh.render(vmesh.loads(data)))


def test_deep_colors_are_rounded_to_8_bits() -> None:
    deep = PICTURES["ramp"].astype(np.uint16) * 257
    mesh = vmesh.encode(deep, vertices=4)
    with Image.open(io.BytesIO(vmesh.dumps(mesh))) as image:
        assert image.mode == "RGB"
        assert np.array_equal(np.asarray(image), np.rint(vmesh.render(mesh) / 257))


def test_other_files_are_not_claimed(tmp_path: Path) -> None:
    other = tmp_path / "other.vmesh"
    other.write_bytes(b"no mesh at all")
    with pytest.raises(UnidentifiedImageError):
        Image.open(other)


def test_a_damaged_header_is_no_image(file: Path) -> None:
    data = bytearray(file.read_bytes())
    data[7] ^= 1
    with pytest.raises(UnidentifiedImageError):
        Image.open(io.BytesIO(data))


@pytest.mark.parametrize("cut", [1, 1000])
def test_damage_behind_the_header_shows_when_pixels_are_asked_for(file: Path, cut: int) -> None:
    with Image.open(io.BytesIO(file.read_bytes()[:-cut])) as image:
        assert image.size == (600, 400)
        with pytest.raises(OSError, match="truncated"):
            image.load()


class Counted(io.BytesIO):
    """A file that knows how many bytes were read of it."""

    n_read = 0

    def read(self, size: int | None = -1, /) -> bytes:
        data = super().read(size)
        self.n_read += len(data)
        return data


def test_opening_reads_the_start_of_a_file_only(coffee: UInt8Array) -> None:
    mesh = vmesh.encode(coffee, vertices=8000, effort=1)
    stream = Counted(vmesh.dumps(mesh))
    # Not by Image.open, which lets other plug-ins have a look at the file too.
    with VmeshImageFile(stream) as image:
        assert image.size == (600, 400)
        assert stream.n_read < len(stream.getvalue()) / 2
        assert np.array_equal(np.asarray(image), vmesh.render(mesh))


def test_metadata_that_are_longer_than_the_start_are_read(mesh: vmesh.Mesh) -> None:
    noise = np.random.default_rng(1).integers(0, 256, 20_000, dtype=np.uint8).tobytes()
    data = vmesh.dumps(mesh.replaced(metadata=Metadata(xmp=noise)))
    with Image.open(io.BytesIO(data)) as image:
        assert image.info["xmp"] == noise


def test_a_huge_canvas_is_stopped_before_it_is_drawn() -> None:
    huge = vmesh.encode(PICTURES["ramp"], vertices=4).transform((900, 0, 0, 900, 0, 0))
    with pytest.raises(Image.DecompressionBombError):
        Image.open(io.BytesIO(vmesh.dumps(huge)))


def test_a_thumbnail_is_drawn_small(mesh: vmesh.Mesh) -> None:
    large = mesh.transform((10, 0, 0, 10, 0, 0))
    stream = io.BytesIO(vmesh.dumps(large))
    tracemalloc.start()
    try:
        with Image.open(stream) as image:
            image.thumbnail((60, 60))
            assert image.size == (60, 40)
        most = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert most < large.width * large.height / 10


def test_a_thumbnail_looks_like_that_of_the_whole_picture(file: Path, mesh: vmesh.Mesh) -> None:
    whole = Image.fromarray(np.asarray(vmesh.render(mesh)))
    whole.thumbnail((60, 60))
    with Image.open(file) as image:
        image.thumbnail((60, 60))
        small = np.asarray(image)
    plain = np.asarray(vmesh.render(mesh, width=60, height=40))
    assert psnr(small, np.asarray(whole)) > psnr(plain, np.asarray(whole))


def test_an_image_is_loaded_at_any_scale(file: Path, mesh: vmesh.Mesh) -> None:
    with Image.open(file) as image:
        assert isinstance(image, VmeshImageFile)
        image.load(scale=2.5)
        assert np.array_equal(np.asarray(image), vmesh.render(mesh, scale=2.5))
        image.load(scale=1)
        assert np.array_equal(np.asarray(image), vmesh.render(mesh))
        with pytest.raises(ValueError, match="above 0"):
            image.load(scale=0)


def test_a_draft_does_not_enlarge(file: Path) -> None:
    with Image.open(file) as image:
        assert image.draft(None, (2000, 2000)) is None
        assert image.draft("RGB", (150, 100)) == ("RGB", (0, 0, 150, 100))
        assert image.size == (150, 100)


def test_saving_takes_the_settings_of_the_encoder(coffee: UInt8Array) -> None:
    image = Image.fromarray(coffee).resize((150, 100))
    pixels = np.asarray(image)
    assert saved(image, quality=20, effort=2) == vmesh.dumps(
        vmesh.encode(pixels, quality=20, effort=2)
    )
    assert 0 < len(saved(image, target_size=900, effort=2)) <= 900
    with pytest.raises(ValueError, match="quality of 0 to 100"):
        saved(image, quality=101)


def test_a_path_chooses_the_format_by_its_ending(tmp_path: Path) -> None:
    path = tmp_path / "ramp.vmesh"
    Image.fromarray(PICTURES["ramp"]).save(path, vertices=10)
    assert vmesh.load(path).width == 32


def test_metadata_travel_both_ways() -> None:
    exif = Image.Exif()
    exif[0x010E] = "a ramp"
    metadata = {"icc_profile": srgb_profile(), "exif": exif.tobytes(), "xmp": b"<x/>"}
    image = Image.fromarray(PICTURES["ramp"])
    with Image.open(io.BytesIO(saved(image, vertices=4, **metadata))) as opened:
        assert opened.getexif()[0x010E] == "a ramp"
        assert opened.info["icc_profile"] == srgb_profile()
        assert opened.info["xmp"] == b"<x/>"
        again = saved(opened, vertices=4)
        bare = saved(opened, vertices=4, icc_profile=None, exif=None, xmp=None)
    kept = vmesh.loads(again).metadata
    assert (kept.icc, kept.xmp) == (srgb_profile(), b"<x/>")
    assert vmesh.loads(bare).metadata == Metadata()


def test_a_misspelt_setting_is_refused_and_options_of_other_formats_are_passed_over() -> None:
    image = Image.fromarray(PICTURES["ramp"])
    with pytest.raises(TypeError, match="no option 'vertice': did you mean 'vertices'"):
        saved(image, vertice=4)
    assert saved(image, vertices=4, optimize=True, speed=6, dpi=(72, 72)) == saved(
        image, vertices=4
    )


def test_the_orientation_is_applied_when_an_image_is_saved() -> None:
    exif = Image.Exif()
    exif[0x0112] = 6
    mesh = vmesh.loads(saved(Image.fromarray(PICTURES["ramp"]), vertices=4, exif=exif))
    assert (mesh.width, mesh.height) == (24, 32)


def test_imageio_reads_and_writes_through_pillow(file: Path, tmp_path: Path) -> None:
    imageio = pytest.importorskip("imageio.v3", reason="imageio is not installed")
    pixels = imageio.imread(file)
    assert np.array_equal(pixels, vmesh.render(vmesh.load(file)))
    imageio.imwrite(tmp_path / "again.vmesh", pixels, plugin="pillow", vertices=100, effort=2)
    assert vmesh.load(tmp_path / "again.vmesh").n_vertices == 100


def test_matplotlib_reads_through_pillow(file: Path) -> None:
    matplotlib = pytest.importorskip("matplotlib.image", reason="matplotlib is not installed")
    pixels = matplotlib.imread(file)
    assert np.array_equal(pixels, vmesh.render(vmesh.load(file)))
