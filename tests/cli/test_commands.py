"""The command line, run as a program."""

from __future__ import annotations

import json
import os
import re
import stat
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import vmesh
from tests.cli.program import fail, run, succeed
from tests.pictures import ramp
from tests.tiled import tiled
from vmesh.codec import layout
from vmesh.metrics import psnr

COFFEE = Path(__file__).parents[1] / "images" / "coffee.png"
CHELSEA = Path(__file__).parents[1] / "images" / "chelsea.png"


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("cli") / "coffee.vmesh"
    succeed("encode", COFFEE, path, "--vertices", "2000")
    return path


def test_encode_writes_what_the_library_writes(file: Path) -> None:
    mesh = vmesh.encode(np.asarray(Image.open(COFFEE).convert("RGB")), vertices=2000)
    assert file.read_bytes() == vmesh.dumps(mesh)


def test_encode_meets_the_density_and_reports_as_json(tmp_path: Path) -> None:
    target = tmp_path / "out.vmesh"
    figures = json.loads(succeed("encode", CHELSEA, target, "--density", "0.01", "--json"))
    assert figures["vertices"] == pytest.approx(0.01 * 451 * 300, rel=0.02)
    assert figures["bytes"] == target.stat().st_size
    assert figures["bits_per_vertex"] == pytest.approx(
        8 * figures["bytes"] / figures["vertices"], abs=1e-3
    )


def test_every_option_of_the_paper_is_heard(tmp_path: Path) -> None:
    names = (
        "--method blue-noise --gamma 0.7 --sampler channels --diffusion ostromoukhov "
        "--colors sampled"
    )
    options = [*names.split(), "--color-step", "4", "--seed", "3", "--density", "0.005"]
    target = tmp_path / "out.vmesh"
    succeed("encode", CHELSEA, target, *options)
    mesh = vmesh.encode(
        np.asarray(Image.open(CHELSEA).convert("RGB")),
        method="blue-noise",
        gamma=0.7,
        sampler="channels",
        diffusion="ostromoukhov",
        colors="sampled",
        color_step=4,
        seed=3,
        density=0.005,
    )
    loaded = vmesh.load(target)
    assert loaded == mesh.canonical().replaced(metadata=loaded.metadata)


@pytest.mark.parametrize(
    ("options", "settings"),
    [
        (["-q", "30", "-e", "2"], {"quality": 30, "effort": 2}),
        (["--target-size", "900", "--effort", "1"], {"target_size": 900, "effort": 1}),
        (["--target-psnr", "21", "-e", "1"], {"target_psnr": 21.0, "effort": 1}),
        (["--vertices", "300", "-e", "3"], {"vertices": 300, "effort": 3}),
    ],
)
def test_every_goal_and_effort_is_heard(
    tmp_path: Path, options: list[str], settings: dict[str, Any]
) -> None:
    photograph = np.asarray(Image.open(CHELSEA).convert("RGB"))[:96, :128]
    Image.fromarray(photograph).save(tmp_path / "in.png")
    succeed("encode", tmp_path / "in.png", tmp_path / "out.vmesh", *options)
    loaded = vmesh.load(tmp_path / "out.vmesh")
    assert loaded == vmesh.encode(photograph, **settings)


def test_two_goals_at_once_are_a_usage_error(tmp_path: Path) -> None:
    text = fail(2, "encode", CHELSEA, tmp_path / "out.vmesh", "-q", "50", "--vertices", "100")
    assert "quality and vertices" in text


def test_a_size_that_no_mesh_fits_in_is_told_in_one_sentence(tmp_path: Path) -> None:
    target = tmp_path / "out.vmesh"
    text = fail(1, "encode", CHELSEA, target, "--target-size", "20", "-e", "1")
    assert "smallest file" in text
    assert not target.exists()


def test_a_size_that_metadata_alone_exceed_is_told_with_their_share(tmp_path: Path) -> None:
    photograph = Image.fromarray(np.asarray(Image.open(CHELSEA).convert("RGB"))[:64, :96])
    exif = Image.Exif()
    random = np.random.default_rng(1)
    exif[0x010E] = "".join(map(chr, random.integers(33, 123, 3000)))
    photograph.save(tmp_path / "in.jpg", exif=exif)
    sizes = "--target-size", "800", "-e", "1"
    text = fail(1, "encode", tmp_path / "in.jpg", tmp_path / "out.vmesh", *sizes)
    found = re.search(r"takes (\d+) bytes, (\d+) of them metadata \(--strip leaves", text)
    assert found is not None
    assert 800 < int(found[2]) < int(found[1])
    succeed("encode", tmp_path / "in.jpg", tmp_path / "out.vmesh", *sizes, "--strip", "all")
    assert 784 <= (tmp_path / "out.vmesh").stat().st_size <= 800


def test_a_number_of_vertices_that_no_mesh_has_is_told(tmp_path: Path) -> None:
    Image.fromarray(ramp(5, 6)).save(tmp_path / "in.png")
    target = tmp_path / "out.vmesh"
    done = run("encode", tmp_path / "in.png", target, "--vertices", "90")
    assert done.returncode == 0
    assert b"at most 34 vertices, not 90" in done.stderr
    assert vmesh.load(target).n_vertices == 34
    succeed("encode", tmp_path / "in.png", target, "--overwrite", "--vertices", "30")


@pytest.mark.parametrize("suffix", ["png", "jpg", "webp", "tif"])
def test_decode_writes_images_of_any_size(file: Path, tmp_path: Path, suffix: str) -> None:
    target = tmp_path / f"out.{suffix}"
    succeed("decode", file, target, "--width", "300")
    with Image.open(target) as image:
        assert image.size == (300, 200)


def test_the_longest_side_is_the_width_or_the_height(tmp_path: Path) -> None:
    for width, height in ((60, 40), (40, 60)):
        path = tmp_path / "mesh.vmesh"
        vmesh.dump(vmesh.encode(ramp(height, width), vertices=9, effort=1), path)
        succeed("decode", path, tmp_path / "out.png", "--longest-side", "90")
        with Image.open(tmp_path / "out.png") as image:
            assert image.size == (width * 3 // 2, height * 3 // 2)


def test_decode_gives_the_native_raster(file: Path, tmp_path: Path) -> None:
    succeed("decode", file, tmp_path / "out.png")
    assert np.array_equal(
        np.asarray(Image.open(tmp_path / "out.png")), vmesh.render(vmesh.load(file))
    )


def test_decode_transforms(file: Path, tmp_path: Path) -> None:
    succeed("decode", file, tmp_path / "out.png", "--transform", "0,1,-1,0,0,0", "--scale", "0.5")
    with Image.open(tmp_path / "out.png") as image:
        assert image.size == (200, 300)


@pytest.mark.parametrize(
    ("command", "suffix", "start"),
    [
        ("to-svg", "svg", b"<svg"),
        ("to-svg", "svgz", b"\x1f\x8b"),
        ("to-pdf", "pdf", b"%PDF"),
        ("to-html", "html", b"<!doctype html>"),
    ],
)
def test_vector_commands_take_meshes_and_photographs(
    file: Path, tmp_path: Path, command: str, suffix: str, start: bytes
) -> None:
    from_mesh, from_photograph = tmp_path / f"a.{suffix}", tmp_path / f"b.{suffix}"
    succeed(command, file, from_mesh)
    succeed(command, COFFEE, from_photograph, "--vertices", "2000")
    assert from_mesh.read_bytes().startswith(start)
    assert from_mesh.read_bytes() == from_photograph.read_bytes()


def test_a_drawing_has_the_width_that_is_asked_for(file: Path, tmp_path: Path) -> None:
    drawing = tmp_path / "drawing.svg"
    succeed("to-svg", file, drawing, "--width", "210mm")
    assert b'width="210mm" height="140mm"' in drawing.read_bytes()
    assert "100%" in fail(2, "to-svg", file, drawing, "--height", "tall")


def test_a_drawing_is_fitted_to_a_photograph_of_its_size(file: Path, tmp_path: Path) -> None:
    plain, fitted = tmp_path / "plain.svg", tmp_path / "fitted.svg"
    succeed("to-svg", file, plain)
    succeed("to-svg", file, fitted, "--fit", COFFEE)
    assert fitted.read_bytes() != plain.read_bytes()
    with Image.open(COFFEE) as image:
        image.resize((300, 200)).save(tmp_path / "half.png")
    message = fail(1, "to-svg", file, fitted, "--fit", tmp_path / "half.png")
    assert "600 x 400 pixels, got 300 x 200" in message


def test_edges_of_a_drawing_are_crisp_or_trapped(file: Path, tmp_path: Path) -> None:
    drawing = tmp_path / "drawing.svg"
    for seams, is_crisp in (("crisp", True), ("trapping", False)):
        succeed("to-svg", file, drawing, "--seams", seams)
        assert (b"crispEdges" in drawing.read_bytes()) == is_crisp
    message = fail(2, "to-svg", file, drawing, "--seams", "trapping", "--mode", "auto")
    assert "crisp edges" in message


def test_the_script_of_the_element_is_written_alone_or_beside_a_page(
    file: Path, tmp_path: Path
) -> None:
    script = tmp_path / "vmesh-image.js"
    succeed("to-html", "--element", script)
    assert b'customElements.define("vmesh-image"' in script.read_bytes()
    script.unlink()
    succeed("to-html", file, tmp_path / "page.html", "--element", script)
    assert "vmesh-image" in script.read_text("utf-8")
    assert "<!doctype html>" in (tmp_path / "page.html").read_text("utf-8")
    assert "OUTPUT.html" in fail(2, "to-html")


def test_a_page_has_the_width_and_the_backend_that_are_asked_for(
    file: Path, tmp_path: Path
) -> None:
    page = tmp_path / "page.pdf"
    succeed("to-pdf", file, page)
    native = page.stat().st_size
    succeed("to-pdf", file, page, "--page-width", "2in", "--backend", "cairo", "--mode", "exact")
    assert page.stat().st_size > 10 * native
    assert b"[ 0 0 144 96 ]" in page.read_bytes()
    assert "210mm" in fail(2, "to-pdf", file, page, "--page-width", "wide")


def test_a_dash_is_standard_input_and_output() -> None:
    data = succeed("encode", "-", "-", "--vertices", "500", given=COFFEE.read_bytes())
    assert vmesh.loads(data).width == 600
    assert succeed("decode", "-", "-", given=data).startswith(b"\x89PNG")
    assert succeed("to-svg", "-", "-", given=data).startswith(b"<svg")
    assert succeed("to-pdf", "-", "-", given=data).startswith(b"%PDF")
    assert b"600 x 400" in succeed("info", "-", given=data)


def test_info_lists_the_parts_of_a_file(file: Path) -> None:
    figures = json.loads(succeed("info", file, "--json"))
    mesh = vmesh.load(file)
    assert (figures["width"], figures["height"]) == (600, 400)
    assert figures["vertices"] == mesh.n_vertices
    assert figures["color_steps"] == list(mesh.lattice.steps)
    parts = {part["part"]: part["bytes"] for part in figures["parts"]}
    assert parts == {"frame": 27, "mesh": file.stat().st_size - 27}
    text = succeed("info", file).decode()
    assert "bits per vertex" in text
    assert str(mesh.n_vertices) in text


def test_info_tells_how_the_triangles_are_coded(file: Path, tmp_path: Path) -> None:
    assert json.loads(succeed("info", file, "--json"))["connectivity"] == "flipped"
    implied = tmp_path / "implied.vmesh"
    succeed("encode", CHELSEA, implied, "--method", "blue-noise", "--vertices", "200")
    assert json.loads(succeed("info", implied, "--json"))["connectivity"] == "implied"


def test_info_tells_the_tiles_of_a_mesh(file: Path, tmp_path: Path) -> None:
    assert json.loads(succeed("info", file, "--json"))["tiles"] is None
    tiles = tmp_path / "tiles.vmesh"
    vmesh.dump(tiled(40, 30, 16, 3, n_vertices=50), tiles)
    figures = json.loads(succeed("info", tiles, "--json", "--parts"))
    assert figures["tiles"] == {"side": 16, "columns": 3, "rows": 2}
    assert sum(part["bytes"] for part in figures["parts"]) == tiles.stat().st_size
    assert b"3 x 2 tiles of 16 pixels" in succeed("info", tiles)
    assert b"tiles of 16 pixels" in succeed("dump", tiles)


def test_info_decodes_the_mesh_if_asked_to(file: Path) -> None:
    figures = json.loads(succeed("info", file, "--parts", "--json"))
    mesh = vmesh.load(file)
    assert figures["triangles"] == mesh.n_triangles
    parts = {part["part"]: part["bytes"] for part in figures["parts"]}
    assert list(parts) == ["frame", "positions", "colors", "triangles"]
    assert sum(parts.values()) == figures["bytes"] == file.stat().st_size
    assert f"{mesh.n_triangles} triangles" in succeed("info", file, "--parts").decode()


def test_validate_says_that_a_file_is_sound(file: Path) -> None:
    assert succeed("validate", file).decode() == f"{file}: valid\n"
    assert json.loads(succeed("validate", file, "--json")) == {"valid": True, "findings": []}


def test_validate_finds_all_that_is_wrong(file: Path, tmp_path: Path) -> None:
    data = bytearray(file.read_bytes() + b"more")
    data[7] ^= 1  # the width
    damaged = tmp_path / "damaged.vmesh"
    damaged.write_bytes(data)
    done = run("validate", damaged)
    assert done.returncode == 1
    assert done.stderr == b""
    lines = done.stdout.decode().splitlines()
    assert all(line.startswith(f"{damaged}: error ") for line in lines)
    codes = [line.removeprefix(f"{damaged}: error ").split()[0] for line in lines]
    assert codes[:2] == ["checksum", "trailing"]
    done = run("validate", damaged, "--json")
    assert done.returncode == 1
    report = json.loads(done.stdout)
    assert not report["valid"]
    assert [finding["code"] for finding in report["findings"]] == codes


def test_dump_prints_every_field(file: Path) -> None:
    lines = succeed("dump", file, "--bytes", "20").decode().splitlines()
    data = file.read_bytes()
    assert lines[0].startswith("00000000  8b 56 4d 0d 0a")
    assert any("# width 600" in line for line in lines)
    content = len(data) - 27
    assert f"... {content - 20} more bytes" in lines[-2]
    assert lines[-1].startswith(f"{len(data) - 4:08x}  {data[-4:].hex(' ')}")
    everything = succeed("dump", file, "--bytes", "100000").decode().splitlines()
    shown = "".join(line[10:58] for line in everything)
    assert bytes.fromhex(shown) == data


def test_dump_prints_the_mesh(file: Path) -> None:
    mesh = vmesh.load(file)
    lines = succeed("dump", file, "--mesh").decode().splitlines()
    assert lines[1] == "canvas 600 400"
    vertex = [*mesh.vertices[-1].tolist(), *mesh.levels[-1].tolist()]
    assert lines[5 + mesh.n_vertices] == " ".join(map(str, vertex))
    assert lines[-1] == " ".join(map(str, mesh.triangles[-1].tolist()))


def test_decode_draws_a_file_that_was_cut_off_if_asked_to(file: Path, tmp_path: Path) -> None:
    start, target = tmp_path / "start.vmesh", tmp_path / "out.png"
    start.write_bytes(file.read_bytes()[: file.stat().st_size * 3 // 4])
    assert "the file ends within chunk M" in fail(1, "decode", start, target)
    assert not target.exists()
    done = run("decode", start, target, "--allow-partial")
    assert done.returncode == 0
    expected = f"vmesh: {start}: the file ends within chunk M: what is missing is predicted\n"
    assert done.stderr.decode() == expected
    with Image.open(target) as image:
        assert image.size == (600, 400)
    whole, partial = vmesh.render(vmesh.load(file)), np.asarray(Image.open(target))
    assert 18 < psnr(whole, partial) < 45


def test_info_names_metadata(file: Path, tmp_path: Path) -> None:
    metadata = vmesh.Metadata(exif=b"II*\0", xmp=b"<x/>", unknown=((b"n", b"text"),))
    described = tmp_path / "described.vmesh"
    vmesh.dump(vmesh.load(file).replaced(metadata=metadata), described)
    parts = json.loads(succeed("info", described, "--json"))["parts"]
    assert [part["part"] for part in parts] == ["frame", "exif", "xmp", "n", "mesh"]
    assert parts[3]["bytes"] == 4


@pytest.mark.parametrize(
    "show", ["original", "salience", "points", "mesh", "render", "error", "sheet"]
)
def test_inspect_draws_every_stage(tmp_path: Path, show: str) -> None:
    target = tmp_path / "out.png"
    succeed("inspect", CHELSEA, target, "--show", show, "--density", "0.01")
    with Image.open(target) as image:
        pixels = np.asarray(image)
    if show == "sheet":
        assert pixels.shape[0] > 2 * 300
        assert pixels.shape[1] > 3 * 451
    else:
        assert pixels.shape == (300, 451, 3)
    assert pixels.std() > 5


def test_inspect_enlarges_a_region_in_any_format(tmp_path: Path) -> None:
    options = ("--zoom", "130,80,80,60", "--scale", "3", "--density", "0.01", "-e", "1")
    for suffix, start in ((".png", b"\x89PNG"), (".svg", b"<svg"), (".pdf", b"%PDF")):
        target = tmp_path / f"sheet{suffix}"
        succeed("inspect", CHELSEA, target, *options)
        assert target.read_bytes().startswith(start)
    with Image.open(tmp_path / "sheet.png") as image:
        assert image.width > 3 * 240
    succeed("inspect", CHELSEA, tmp_path / "render.png", "--show", "render", *options)
    with Image.open(tmp_path / "render.png") as image:
        assert image.size == (240, 180)


def test_inspect_reads_and_writes_streams() -> None:
    data = succeed("inspect", "-", "-", "-e", "1", "--vertices", "50", given=CHELSEA.read_bytes())
    assert data.startswith(b"\x89PNG")


def test_inspect_tells_of_a_region_that_it_cannot_show(tmp_path: Path) -> None:
    target = tmp_path / "sheet.png"
    text = fail(1, "inspect", CHELSEA, target, "--zoom", "400,200,100,50")
    assert text == (
        "vmesh: the region of 100 x 50 pixels at 400,200 reaches beyond the picture of 451 x 300\n"
    )
    assert "four whole numbers" in fail(2, "inspect", CHELSEA, target, "--zoom", "1,2,3")
    assert "at least one pixel" in fail(2, "inspect", CHELSEA, target, "--zoom", "1,2,3,0")
    assert ".svgz" in fail(2, "inspect", CHELSEA, tmp_path / "sheet.xyz")
    text = fail(1, "inspect", CHELSEA, target, "--scale", "500", "-e", "1", "--vertices", "9")
    assert "limit" in text
    assert not list(tmp_path.iterdir())


def test_compare_measures_pictures_and_meshes_at_the_size_of_the_first(
    file: Path, tmp_path: Path
) -> None:
    same = json.loads(succeed("compare", COFFEE, COFFEE, "--json"))
    assert same == {"psnr_rgb": None, "psnr_y": None, "ssim": 1.0}
    figures = json.loads(succeed("compare", COFFEE, file, "--json"))
    rendered = vmesh.render(vmesh.load(file)).astype(float)
    error = ((np.asarray(Image.open(COFFEE).convert("RGB")) - rendered) ** 2).mean()
    assert figures["psnr_rgb"] == pytest.approx(10 * np.log10(255**2 / error))
    succeed("decode", file, tmp_path / "large.png", "--scale", "2")
    other_size = json.loads(succeed("compare", tmp_path / "large.png", file, "--json"))
    assert other_size["psnr_rgb"] is None
    assert "dB" in succeed("compare", COFFEE, file).decode()


# Bad input: one clear line, status 1, and nothing lost.


@pytest.fixture
def garbage(tmp_path: Path) -> Path:
    path = tmp_path / "garbage.png"
    path.write_bytes(b"this is not an image")
    return path


def test_what_is_not_an_image_is_told(garbage: Path, tmp_path: Path) -> None:
    text = fail(1, "encode", garbage, tmp_path / "out.vmesh")
    assert "garbage.png" in text
    assert "not an image" in text
    assert not (tmp_path / "out.vmesh").exists()


def test_a_truncated_image_is_told(tmp_path: Path) -> None:
    path = tmp_path / "half.png"
    path.write_bytes(COFFEE.read_bytes()[:100_000])
    assert "cut off" in fail(1, "encode", path, tmp_path / "out.vmesh")


def test_an_empty_file_is_told(tmp_path: Path) -> None:
    path = tmp_path / "empty.png"
    path.touch()
    assert "empty" in fail(1, "encode", path, tmp_path / "out.vmesh")
    fail(1, "decode", path, tmp_path / "out.png")


def test_a_missing_file_and_a_folder_are_told(tmp_path: Path) -> None:
    assert "No such file" in fail(1, "encode", tmp_path / "none.png", tmp_path / "out.vmesh")
    assert "directory" in fail(1, "encode", tmp_path, tmp_path / "out.vmesh").lower()
    assert "no .vmesh files were found" in fail(1, "info", tmp_path)
    assert "-o DIR" in fail(2, "encode", tmp_path)


def test_an_image_with_too_many_pixels_is_told(tmp_path: Path) -> None:
    text = fail(1, "encode", COFFEE, tmp_path / "out.vmesh", "--max-pixels", "1000")
    assert "limit" in text


@pytest.mark.parametrize("command", [["info", "--parts"], ["validate"]])
def test_more_vertices_for_a_byte_are_read_if_that_is_allowed(command: list[str]) -> None:
    bomb = Path(__file__).parents[2] / "spec" / "conformance" / "valid" / "a-count-bomb.vmesh"
    failed = run(*command, bomb)
    assert failed.returncode == 1
    assert b"vertices per byte" in failed.stdout + failed.stderr
    succeed(*command, bomb, "--max-vertices-per-byte", "5000")


def test_an_unwritable_output_is_told(tmp_path: Path) -> None:
    text = fail(1, "encode", CHELSEA, tmp_path / "none" / "out.vmesh", "--vertices", "100")
    assert "No such file" in text
    folder = tmp_path / "folder.vmesh"
    folder.mkdir()
    fail(1, "encode", CHELSEA, folder, "--vertices", "100")
    assert list(tmp_path.iterdir()) == [folder]


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_protected_folder_is_told(tmp_path: Path) -> None:
    tmp_path.chmod(stat.S_IRUSR | stat.S_IXUSR)
    assert "denied" in fail(1, "encode", CHELSEA, tmp_path / "out.vmesh", "--vertices", "100")


def test_an_unknown_ending_is_wrong_usage(file: Path, tmp_path: Path) -> None:
    assert ".png" in fail(2, "decode", file, tmp_path / "out.xyz")
    assert ".vmesh" in fail(2, "encode", COFFEE, tmp_path / "out.xyz")
    assert ".svgz" in fail(2, "to-svg", file, tmp_path / "out.pdf")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    "arguments",
    [
        ("encode", COFFEE, "out.vmesh", "--vertices", "100", "--density", "0.1"),
        ("encode", COFFEE, "out.vmesh", "--gamma", "0"),
        ("encode", COFFEE, "out.vmesh", "--density", "2"),
        ("encode", COFFEE, "out.vmesh", "--method", "magic"),
        ("encode", COFFEE, "-", "--json"),
        ("encode", "-"),
        ("encode", COFFEE, CHELSEA, "out.vmesh"),
        ("export", COFFEE),
        ("decode", COFFEE, "out.png", "--scale", "2", "--width", "10"),
        ("decode", COFFEE, "out.png", "--longest-side", "9", "--height", "10"),
        ("decode", COFFEE, "out.png", "--transform", "1,2,3"),
        ("paint", COFFEE),
        ("--wrong",),
    ],
)
def test_wrong_usage_has_status_two(arguments: tuple[str | Path, ...]) -> None:
    assert "Usage" in fail(2, *arguments)


def test_a_newer_version_is_told(file: Path, tmp_path: Path) -> None:
    data = bytearray(file.read_bytes())
    data[len(layout.SIGNATURE)] = 0x70
    newer = tmp_path / "newer.vmesh"
    newer.write_bytes(data)
    for command in ("decode", "to-svg"):
        suffix = {"decode": "png", "to-svg": "svg"}[command]
        assert "version 7.0" in fail(1, command, newer, tmp_path / f"out.{suffix}")
    assert "version 7.0" in fail(1, "info", newer)


def test_a_damaged_file_is_told_and_harms_no_earlier_output(file: Path, tmp_path: Path) -> None:
    damaged = tmp_path / "damaged.vmesh"
    data = bytearray(file.read_bytes())
    data[len(data) // 2] ^= 1
    damaged.write_bytes(data)
    target = tmp_path / "out.png"
    target.write_bytes(b"an earlier picture")
    assert "code checksum" in fail(1, "decode", damaged, target)
    assert target.read_bytes() == b"an earlier picture"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["damaged.vmesh", "out.png"]


def test_a_photograph_is_not_decoded_as_a_mesh(tmp_path: Path) -> None:
    assert "signature" in fail(1, "decode", COFFEE, tmp_path / "out.png")
    renamed = tmp_path / "photo.vmesh"
    renamed.write_bytes(COFFEE.read_bytes())
    assert "signature" in fail(1, "to-svg", renamed, tmp_path / "out.svg")


def test_a_mesh_is_not_encoded_again(file: Path, tmp_path: Path) -> None:
    assert "photograph" in fail(1, "encode", file, tmp_path / "out.vmesh")


def test_a_rotated_photograph_is_encoded_upright(tmp_path: Path) -> None:
    exif = Image.Exif()
    exif[0x0112] = 6
    source = tmp_path / "rotated.jpg"
    Image.open(CHELSEA).convert("RGB").save(source, exif=exif)
    succeed("encode", source, tmp_path / "out.vmesh", "--vertices", "500")
    mesh = vmesh.load(tmp_path / "out.vmesh")
    assert (mesh.width, mesh.height) == (300, 451)


def test_help_names_every_command_and_loads_neither_numba_nor_pillow(file: Path) -> None:
    script = (
        "import sys\n"
        "from vmesh.cli.main import main\n"
        "try:\n    main()\n"
        "finally:\n"
        "    loaded = {'numba', 'PIL', 'scipy', 'rich'} & set(sys.modules)\n"
        "    assert not loaded, loaded\n"
    )
    for arguments in (["--help"], ["info", str(file)]):
        done = subprocess.run(
            [sys.executable, "-c", script, *arguments], capture_output=True, check=False
        )
        assert done.returncode == 0, done.stderr.decode()
        if arguments == ["--help"]:
            commands = [
                "encode", "decode", "to-svg", "to-pdf", "info", "validate", "dump", "inspect",
                "compare",
            ]  # fmt: skip
            assert all(command in done.stdout.decode() for command in commands)


def test_the_versions_that_matter_are_told() -> None:
    lines = succeed("--version").decode().splitlines()
    assert lines[:2] == [f"vmesh {vmesh.__version__}", "format 1.1"]
    assert f"numpy {np.__version__}" in lines
    assert [line.split()[0] for line in lines[2:]] == [
        "Python", "numpy", "numba", "scipy", "Pillow",
    ]  # fmt: skip
