"""Inputs and outputs of commands: many at once, named after inputs, replaced or left alone."""

from __future__ import annotations

import json
import os
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import vmesh
from tests.cli.program import Program
from tests.codec import samples
from tests.pictures import ramp

FAST = ("-e", "1", "--vertices", "9")


@pytest.fixture
def mesh(tmp_path: Path) -> Path:
    """A small mesh in a folder of its own."""
    path = tmp_path / "in" / "a.vmesh"
    path.parent.mkdir()
    vmesh.dump(samples.color(), path)
    return path


@pytest.fixture
def meshes(mesh: Path) -> Path:
    """A folder of two meshes, and one in a folder below it."""
    folder = mesh.parent
    for name in ("b.vmesh", "deep/a.vmesh"):
        path = folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(mesh.read_bytes())
    return folder


@pytest.fixture
def photo(tmp_path: Path) -> Path:
    """A small picture in a folder of its own."""
    path = tmp_path / "photos" / "p.png"
    path.parent.mkdir()
    Image.fromarray(ramp(12, 16)).save(path)
    return path


def files_in(folder: Path) -> set[str]:
    return {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}


# Many inputs.


@pytest.mark.parametrize(
    ("command", "suffix"),
    [("decode", "png"), ("to-svg", "svg"), ("to-pdf", "pdf"), ("to-html", "html")],
)
def test_folders_and_files_become_outputs_in_a_folder(
    command: str, suffix: str, meshes: Path, tmp_path: Path, program: Program
) -> None:
    out = tmp_path / "new" / "out"
    assert program.succeed(command, meshes, "-o", out) == ""
    assert files_in(out) == {f"a.{suffix}", f"b.{suffix}", f"deep/a.{suffix}"}
    program.succeed(command, meshes / "a.vmesh", tmp_path / f"one.{suffix}")
    assert (out / f"b.{suffix}").read_bytes() == (tmp_path / f"one.{suffix}").read_bytes()
    program.succeed(command, meshes / "b.vmesh", "-o", tmp_path / "other")
    assert files_in(tmp_path / "other") == {f"b.{suffix}"}


def test_photographs_of_a_folder_are_encoded(photo: Path, tmp_path: Path, program: Program) -> None:
    out = tmp_path / "out"
    lines = program.succeed("encode", photo.parent, "-o", out, "--json", *FAST).splitlines()
    assert [json.loads(line)["source"] for line in lines] == [str(photo)]
    assert vmesh.load(out / "p.vmesh").width == 16


def test_meshes_of_other_programs_are_imported_together(
    mesh: Path, tmp_path: Path, program: Program
) -> None:
    for name in ("a.txt", "b.txt"):
        program.succeed("export", mesh, tmp_path / name)
    program.succeed("import", tmp_path / "a.txt", tmp_path / "b.txt", "-o", tmp_path / "out")
    assert files_in(tmp_path / "out") == {"a.vmesh", "b.vmesh"}


def test_a_mesh_beside_its_photograph_is_passed_over_in_a_folder(
    photo: Path, tmp_path: Path, program: Program
) -> None:
    program.succeed("encode", photo, *FAST)
    vmesh.dump(samples.color(), photo.with_name("q.vmesh"))
    program.succeed("to-svg", photo.parent, "-o", tmp_path / "out", *FAST)
    assert files_in(tmp_path / "out") == {"p.svg", "q.svg"}


def test_one_that_fails_is_told_and_the_others_are_done(
    meshes: Path, tmp_path: Path, program: Program
) -> None:
    bad = meshes / "bad.vmesh"
    bad.write_bytes(b"nothing of the kind")
    missing = meshes / "missing.vmesh"
    told = program.fail(1, "decode", meshes, missing, "-o", tmp_path / "out")
    first, second = told.splitlines()
    assert first.startswith(f"vmesh: {bad}: ")
    assert second == f"vmesh: {missing}: No such file or directory"
    assert files_in(tmp_path / "out") == {"a.png", "b.png", "deep/a.png"}


def test_info_has_a_heading_for_each_of_several_files(meshes: Path, program: Program) -> None:
    alone = program.succeed("info", meshes / "a.vmesh")
    assert program.succeed("info", meshes) == "\n".join(
        f"{meshes / name}:\n{alone}" for name in ("a.vmesh", "b.vmesh", "deep/a.vmesh")
    )
    assert program.succeed("dump", meshes).count(".vmesh:\n") == 3


def test_json_of_several_files_is_a_line_each_with_its_source(
    meshes: Path, program: Program
) -> None:
    names = [str(meshes / name) for name in ("a.vmesh", "b.vmesh")]
    for command in ("info", "validate"):
        alone = json.loads(program.succeed(command, names[0], "--json"))
        lines = program.succeed(command, *names, "--json").splitlines()
        assert [json.loads(line) for line in lines] == [{"source": n, **alone} for n in names]


def test_validate_goes_through_all_and_fails_if_one_does(meshes: Path, program: Program) -> None:
    data = (meshes / "a.vmesh").read_bytes()
    (meshes / "a.vmesh").write_bytes(data + b"more")
    (meshes / "b.vmesh").unlink()
    status, output, told = program.run("validate", meshes, meshes / "b.vmesh")
    assert status == 1
    assert f"{meshes / 'a.vmesh'}: error trailing" in output
    assert f"{meshes / 'deep/a.vmesh'}: valid" in output
    assert told == f"vmesh: {meshes / 'b.vmesh'}: No such file or directory\n"


def test_two_inputs_for_one_output_are_refused_before_any_work(
    meshes: Path, tmp_path: Path, program: Program
) -> None:
    pair = (meshes / "a.vmesh", meshes / "deep" / "a.vmesh")
    told = program.fail(1, "decode", *pair, "-o", tmp_path / "out")
    assert "would both be written to" in told
    assert not (tmp_path / "out").exists()


def test_several_inputs_need_a_folder(meshes: Path, tmp_path: Path, program: Program) -> None:
    three = [meshes / name for name in ("a.vmesh", "b.vmesh", "deep/a.vmesh")]
    assert "-o DIR" in program.fail(2, "decode", *three)
    assert "-o DIR" in program.fail(2, "decode", *three[:2])
    assert "-o DIR" in program.fail(2, "decode", meshes)
    assert "-o DIR" in program.fail(2, "decode", *three, "-o", tmp_path / "out.png")
    assert "this is a file" in program.fail(2, "decode", *three, "-o", three[0])
    assert "standard input" in program.fail(2, "info", three[0], "-")
    assert "standard input" in program.fail(2, "decode", "-")


# Outputs that are named after their inputs.


def test_an_output_without_a_name_is_named_after_its_input_and_stands_beside_it(
    mesh: Path, photo: Path, program: Program
) -> None:
    for command, suffix in (("decode", "png"), ("to-svg", "svg"), ("to-html", "html")):
        program.succeed(command, mesh)
        assert mesh.with_suffix(f".{suffix}").exists()
    program.succeed("encode", photo, *FAST)
    assert files_in(photo.parent) == {"p.png", "p.vmesh"}


def test_one_output_may_be_named_by_the_option_too(
    mesh: Path, tmp_path: Path, program: Program
) -> None:
    program.succeed("decode", mesh, "-o", tmp_path / "x.jpg")
    assert (tmp_path / "x.jpg").read_bytes().startswith(b"\xff\xd8")
    program.succeed("decode", mesh, "-o", tmp_path / "x.jpg")


def test_a_photograph_is_never_replaced_by_what_its_mesh_is_decoded_to(
    photo: Path, program: Program
) -> None:
    original = photo.read_bytes()
    program.succeed("encode", photo, *FAST)
    told = program.fail(1, "decode", photo.with_suffix(".vmesh"))
    assert f"{photo}: is there already and was left as it is; --overwrite replaces it" in told
    assert photo.read_bytes() == original
    assert program.fail(1, "decode", photo.parent / "p.vmesh", "-o", photo.parent).count("\n") == 1
    assert photo.read_bytes() == original
    program.succeed("decode", photo.with_suffix(".vmesh"), "--overwrite")
    assert photo.read_bytes() != original


def test_an_input_is_never_the_output(mesh: Path, tmp_path: Path, program: Program) -> None:
    original = mesh.read_bytes()
    hard, link, photo = mesh.with_name("hard.vmesh"), tmp_path / "link.vmesh", tmp_path / "p.vmesh"
    os.link(mesh, hard)
    link.symlink_to(mesh)
    Image.fromarray(ramp(12, 16)).save(photo, format="png")
    picture = photo.read_bytes()
    for source, target in ((mesh, mesh), (link, mesh), (mesh, link), (hard, mesh), (mesh, hard)):
        for options in ((), ("--overwrite",)):
            told = program.fail(1, "encode", source, target, *options)
            assert "would replace" in told
    assert "would replace" in program.fail(1, "encode", photo, "--overwrite", *FAST)
    assert "would replace" in program.fail(1, "encode", photo, photo, *FAST)
    assert "would replace" in program.fail(1, "encode", tmp_path / ".." / tmp_path.name / "p.vmesh")
    assert (mesh.read_bytes(), photo.read_bytes()) == (original, picture)


def test_an_output_is_not_another_input_either(photo: Path, program: Program) -> None:
    other = photo.with_suffix(".vmesh")
    Image.fromarray(ramp(8, 8)).save(other, format="png")
    told = program.fail(1, "encode", photo, other, "-o", photo.parent, "--overwrite", *FAST)
    assert "would" in told
    assert other.read_bytes().startswith(b"\x89PNG")


# What is there already.


def test_a_named_output_is_replaced_unless_it_may_not_be(
    mesh: Path, tmp_path: Path, program: Program
) -> None:
    target = tmp_path / "out.png"
    target.write_bytes(b"an earlier picture")
    told = program.fail(1, "decode", mesh, target, "--no-overwrite")
    assert told == f"vmesh: {target}: is there already and was left as it is\n"
    assert target.read_bytes() == b"an earlier picture"
    program.succeed("decode", mesh, target)
    assert target.read_bytes().startswith(b"\x89PNG")
    program.succeed("decode", mesh, tmp_path / "new.png", "--no-overwrite")
    assert (tmp_path / "new.png").read_bytes() == target.read_bytes()


def test_what_is_there_is_told_before_the_input_is_even_read(
    tmp_path: Path, program: Program
) -> None:
    target = tmp_path / "out.vmesh"
    target.touch()
    told = program.fail(1, "encode", tmp_path / "missing.png", target, "--no-overwrite")
    assert "left as it is" in told
    told = program.fail(1, "encode", tmp_path / "missing.png", tmp_path / "none" / "out.vmesh")
    assert str(tmp_path / "none") in told


def test_a_write_protected_output_is_left_alone_whoever_runs_the_program(
    mesh: Path, tmp_path: Path, program: Program
) -> None:
    target = tmp_path / "out.png"
    target.write_bytes(b"precious")
    target.chmod(0o444)
    told = program.fail(1, "decode", mesh, target)
    assert told.startswith(f"vmesh: {target}: is write-protected")
    assert target.read_bytes() == b"precious"
    program.succeed("decode", mesh, target, "--overwrite")
    assert target.read_bytes().startswith(b"\x89PNG")
    assert target.stat().st_mode & 0o777 == 0o444


def test_those_that_are_there_are_left_and_the_others_are_made(
    meshes: Path, tmp_path: Path, program: Program
) -> None:
    out = tmp_path / "out"
    program.succeed("decode", meshes / "a.vmesh", "-o", out)
    (out / "a.png").write_bytes(b"mine")
    told = program.fail(1, "decode", meshes, "-o", out)
    assert told.count("\n") == 1
    assert "a.png: is there already" in told
    assert files_in(out) == {"a.png", "b.png", "deep/a.png"}
    assert (out / "a.png").read_bytes() == b"mine"
    program.succeed("decode", meshes, "-o", out, "--overwrite")
    assert (out / "a.png").read_bytes() != b"mine"


@pytest.mark.skipif(not Path(os.devnull).is_char_device(), reason="no null device")
def test_a_device_has_nothing_to_lose(mesh: Path, program: Program) -> None:
    link = mesh.with_name("null.png")
    link.symlink_to(os.devnull)
    program.succeed("decode", mesh, link, "--no-overwrite")
    assert Path(os.devnull).is_char_device()


@pytest.mark.parametrize("command", ["inspect", "report", "to-html"])
def test_every_other_output_is_protected_too(
    command: str, photo: Path, tmp_path: Path, program: Program
) -> None:
    target = tmp_path / f"out.{ {'inspect': 'png', 'report': 'html', 'to-html': 'js'}[command] }"
    target.touch(mode=0o444)
    arguments = {
        "inspect": (photo, target),
        "report": (photo, "-o", target),
        "to-html": ("--element", target),
    }[command]
    assert "write-protected" in program.fail(1, command, *arguments)
    assert "left as it is" in program.fail(1, command, *arguments, "--no-overwrite")
    assert target.read_bytes() == b""


# Times.


def test_outputs_keep_the_times_of_their_inputs_if_asked_to(
    photo: Path, tmp_path: Path, program: Program
) -> None:
    os.utime(photo, ns=(1_000_000_000_000_000_001, 900_000_000_000_000_002))
    times = photo.stat().st_atime_ns, photo.stat().st_mtime_ns
    mesh = photo.with_suffix(".vmesh")
    program.succeed("encode", photo, "--preserve", *FAST)
    assert (mesh.stat().st_atime_ns, mesh.stat().st_mtime_ns) == times
    program.succeed("to-svg", photo.parent, "-o", tmp_path / "out", "--preserve", *FAST)
    assert (tmp_path / "out" / "p.svg").stat().st_mtime_ns == times[1]
    program.succeed("to-svg", mesh)
    assert mesh.with_suffix(".svg").stat().st_mtime_ns > times[1]
    assert "--preserve" in program.fail(2, "to-svg", mesh, "-", "--preserve")


@pytest.mark.parametrize("target", ["out.vmesh", "out.svg", "out.pdf", "out.html", "out.ply"])
def test_what_a_mask_shows_white_is_closer_to_the_photograph(
    program: Program, tmp_path: Path, target: str
) -> None:
    pixels = np.random.default_rng(7).integers(0, 256, (24, 32, 3), dtype=np.uint8)
    Image.fromarray(pixels).save(tmp_path / "photo.png")
    mask = np.zeros((6, 4), dtype=np.uint8)
    mask[:, 2:] = 255
    Image.fromarray(mask).save(tmp_path / "mask.png")
    command = {".svg": "to-svg", ".pdf": "to-pdf", ".html": "to-html", ".ply": "export"}
    outputs = []
    for options in ((), ("--mask", tmp_path / "mask.png")):
        arguments = (tmp_path / "photo.png", tmp_path / target, "--vertices", "200", "-e", "2")
        program.succeed(command.get(Path(target).suffix, "encode"), *arguments, *options)
        outputs.append((tmp_path / target).read_bytes())
    assert outputs[0] != outputs[1]
    if target == "out.vmesh":
        errors = [
            np.square(vmesh.render(vmesh.loads(data))[:, 16:].astype(float) - pixels[:, 16:]).mean()
            for data in outputs
        ]
        assert errors[1] < 0.8 * errors[0]


def test_a_mask_that_cannot_be_used_is_told_by_its_name(program: Program, tmp_path: Path) -> None:
    Image.new("RGB", (8, 8), "red").save(tmp_path / "photo.png")
    Image.new("L", (8, 8)).save(tmp_path / "black.png")
    (tmp_path / "text.png").write_text("no picture")
    for mask, words in (("black.png", "black all over"), ("text.png", "not an image")):
        told = program.fail(1, "encode", tmp_path / "photo.png", "--mask", tmp_path / mask)
        assert mask in told
        assert words in told
    assert not (tmp_path / "photo.vmesh").exists()
