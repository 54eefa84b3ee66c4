"""The conformance files: decoders agree on them, and their runner tells who does not."""

from __future__ import annotations

import io
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest

import vmesh
from tests.spec.build_conformance import build, expected, sha256
from tests.spec.test_spec import SPEC
from vmesh.codec.layout import VERSION
from vmesh.codec.validation import validate
from vmesh.formats.raster.pam import write_pam

_ROOT: Final = Path(__file__).parents[2]
_FOLDER: Final = _ROOT / "spec" / "conformance"
_MANIFEST: Final[dict[str, Any]] = json.loads((_FOLDER / "manifest.json").read_text("utf-8"))
_ENTRIES: Final[dict[str, dict[str, Any]]] = {entry["file"]: entry for entry in _MANIFEST["files"]}
_VALID: Final = [name for name, entry in _ENTRIES.items() if "error" not in entry]
_GENEROUS: Final = vmesh.Limits(
    max_metadata=1 << 28, max_pixels=1 << 32, max_vertices_per_byte=5_700
)
_INVALID: Final = [name for name, entry in _ENTRIES.items() if "error" in entry]


def read(name: str) -> bytes:
    return (_FOLDER / name).read_bytes()


def test_the_manifest_lists_the_files_of_the_folder_and_of_the_builder() -> None:
    found = {path.relative_to(_FOLDER).as_posix() for path in _FOLDER.rglob("*.vmesh")}
    assert found == _ENTRIES.keys() == build().keys()
    assert all(sha256(read(name)) == entry["sha256"] for name, entry in _ENTRIES.items())
    assert _MANIFEST["version"] == ".".join(map(str, VERSION))


@pytest.mark.parametrize("name", _VALID)
def test_the_library_decodes_a_valid_file_as_the_manifest_says(name: str) -> None:
    entry = _ENTRIES[name]
    try:
        mesh = vmesh.loads(read(name))
    except vmesh.LimitError:
        assert entry["or_limit"]
        mesh = vmesh.loads(read(name), limits=_GENEROUS)
    assert expected(mesh, drawn="picture_sha256" in entry).items() <= entry.items()


@pytest.mark.parametrize("name", _INVALID)
def test_the_library_refuses_an_invalid_file_with_the_code_of_the_manifest(name: str) -> None:
    with pytest.raises(vmesh.FormatError) as caught:
        vmesh.loads(read(name))
    assert caught.value.code == _ENTRIES[name]["error"]
    assert _ENTRIES[name]["error"] in {finding.code for finding in validate(read(name))}


@pytest.mark.parametrize(
    "name", [name for name in _VALID if _ENTRIES[name]["vertices"] <= 100]
)  # The decoder of the specification takes its time.
def test_the_specification_decodes_a_valid_file_as_the_manifest_says(name: str) -> None:
    entry = _ENTRIES[name]
    decoded = SPEC["decode"](read(name))
    lines = [
        "vmesh 1.0",
        f"canvas {decoded['width']} {decoded['height']}",
        f"subdivision {decoded['subdivision']}",
        f"depth {decoded['depth']}",
        "steps " + " ".join(map(str, decoded["steps"])),
        f"vertices {len(decoded['vertices'])}",
    ]
    pairs = zip(decoded["vertices"], decoded["levels"], strict=True)
    lines += [" ".join(map(str, [*vertex, *levels])) for vertex, levels in pairs]
    lines.append(f"triangles {len(decoded['triangles'])}")
    lines += [" ".join(map(str, triangle)) for triangle in decoded["triangles"]]
    assert sha256("".join(f"{line}\n" for line in lines).encode("ascii")) == entry["mesh_sha256"]
    if decoded["width"] * decoded["height"] * len(decoded["triangles"]) <= 100_000:
        dtype = np.uint8 if decoded["depth"] == 8 else np.uint16
        stream = io.BytesIO()
        pixels = np.array(SPEC["render"](decoded), dtype=dtype)
        write_pam(pixels, stream, depth=decoded["depth"])
        assert sha256(stream.getvalue()) == entry["picture_sha256"]


@pytest.mark.parametrize("name", _INVALID)
def test_the_specification_refuses_an_invalid_file_with_the_code_of_the_manifest(name: str) -> None:
    with pytest.raises(SPEC["Invalid"]) as caught:
        SPEC["decode"](read(name))
    assert caught.value.code == _ENTRIES[name]["error"]


# --- the runner ---------------------------------------------------------------------------------


def run(decoder: str, *options: str) -> tuple[int, str]:
    """Status and output of the runner."""
    runner = str(_ROOT / "tools" / "conformance.py")
    command = [sys.executable, runner, "--decoder", decoder, *options]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=_ROOT)
    return done.returncode, done.stdout + done.stderr


def script(folder: Path, body: str) -> str:
    """A decoder that is a few lines of Python, with `source` and `target`."""
    path = folder / "decoder.py"
    path.write_text(f"import sys\nsource, target = sys.argv[1:]\n{body}\n", encoding="utf-8")
    return f"{sys.executable} {path} {{in}} {{out}}"


def test_the_runner_passes_the_library() -> None:
    decoder = f"{sys.executable} -m tools.library_decoder {{in}} {{out}}"
    status, output = run(decoder, "--match", "flips")
    n_files = sum("flips" in name for name in _ENTRIES)
    assert (status, output) == (0, f"{n_files} of {n_files} files as expected\n")


@pytest.mark.parametrize(
    ("body", "complaint"),
    [
        ("", "no mesh was written"),
        ("open(target + '.mesh', 'w').write('vmesh 1.0')", "another mesh was decoded"),
        ("sys.exit('nothing works')", "expected status 0, got 1 and 'nothing works'"),
        ("import time; time.sleep(60)", "no answer within 2 s"),
    ],
)
def test_the_runner_tells_what_is_wrong_with_a_valid_file(
    tmp_path: Path, body: str, complaint: str
) -> None:
    decoder = script(tmp_path, body)
    status, output = run(decoder, "--match", "valid/four-corners", "--timeout", "2")
    assert status == 1
    assert f"FAILED valid/four-corners.vmesh: {complaint}\n0 of 1 files as expected\n" in output


@pytest.mark.parametrize(
    ("body", "complaint"),
    [
        ("", "expected status 1 and the code truncated, got status 0"),
        ("print('header'); sys.exit(1)", "expected the code truncated, got 'header'"),
        ("print('limit'); sys.exit(1)", "expected the code truncated, got 'limit'"),
        (
            "open(target + '.pam', 'w'); print('truncated'); sys.exit(1)",
            "files were left: out.pam",
        ),
    ],
)
def test_the_runner_tells_what_is_wrong_with_an_invalid_file(
    tmp_path: Path, body: str, complaint: str
) -> None:
    status, output = run(script(tmp_path, body), "--match", "invalid/nothing")
    assert status == 1
    assert f"FAILED invalid/nothing.vmesh: {complaint}\n" in output


def test_the_runner_refuses_what_it_cannot_run() -> None:
    assert run("decoder {in}")[0] == 2
    assert run("decoder {in} {out}", "--match", "no such file")[0] == 2


# --- the decoder in JavaScript ------------------------------------------------------------------


@pytest.mark.skipif(shutil.which("node") is None, reason="there is no Node on this machine")
def test_the_decoder_in_javascript_passes_all_files() -> None:
    decoder = f"node {_ROOT / 'vmesh' / 'web' / 'decoder' / 'decode.js'} {{in}} {{out}}"
    status, output = run(decoder)
    assert status == 0, output
    assert os.linesep.join(output.splitlines()) == (
        f"{len(_ENTRIES)} of {len(_ENTRIES)} files as expected"
    )
