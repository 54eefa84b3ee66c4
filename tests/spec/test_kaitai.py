"""The description of the container in Kaitai Struct, against the reader of the library."""

from __future__ import annotations

import json
import shutil
import subprocess
from functools import cache
from pathlib import Path
from typing import Any, Final

import pytest
import yaml

from tests.spec.kaitai import Reader, parse
from vmesh.codec import layout
from vmesh.codec.container import read_file
from vmesh.codec.policy import Strict

_SPEC: Final = Path(__file__).parents[2] / "spec"
_KSY: Final = yaml.safe_load((_SPEC / "vmesh.ksy").read_text(encoding="utf-8"))
_FILES: Final = sorted((_SPEC / "conformance" / "valid").glob("*.vmesh"))
_COMPILE: Final = """
const compiler = require("kaitai-struct-compiler");
const ksy = JSON.parse(require("fs").readFileSync(0, "utf8"));
compiler.compile("python", ksy, null, false).then(
  (files) => process.stdout.write(files["vmesh.py"]),
  (error) => { console.error(String(error)); process.exit(1); },
);
"""


def node(script: str, given: str = "") -> subprocess.CompletedProcess[str]:
    """What Node makes of a script."""
    return subprocess.run(
        ["node", "-e", script], input=given, capture_output=True, text=True, check=False
    )


@cache
def has_compiler() -> bool:
    """Whether Node finds the compiler of Kaitai Struct, as NODE_PATH may say."""
    if shutil.which("node") is None:
        return False
    return node("require.resolve('kaitai-struct-compiler')").returncode == 0


def content_of(chunk: Any) -> Any:
    """The bytes of the content of a chunk."""
    return getattr(chunk, "_raw_content", chunk.content)


def figures_of(file: Any) -> dict[str, Any]:
    """What a file says by its description; the connectivity by its name."""
    header = file.header
    connectivity = header.connectivity
    return {
        "version": (header.version_major, header.version_minor),
        "width": header.width.value,
        "height": header.height.value,
        "subdivision": header.subdivision,
        "connectivity": getattr(connectivity, "name", connectivity),
        "n_vertices": header.n_vertices.value,
        "depth": 8 + (header.deep.depth_less_8 if header.kind == 1 else 0),
        "steps": [step.value for step in header.steps],
        "chunks": [(chunk.tag, chunk.length.value, content_of(chunk)) for chunk in file.chunks],
        "sides": [chunk.content.side.value for chunk in file.chunks if chunk.tag == "G"],
        "tiles": [
            (chunk.content.n_vertices.value, chunk.content.coded)
            for chunk in file.chunks
            if chunk.tag == "T"
        ],
        "checksums": [header.crc, *(chunk.crc for chunk in file.chunks)],
    }


def expected(data: bytes) -> dict[str, Any]:
    """The same by the reader of the library."""
    container = read_file(data, Strict())
    header, at = layout.read_header(data, Strict())
    ends, chunks = [at - 4], []
    while at < len(data):
        chunk = layout.read_chunk(data, at)
        chunks.append(chunk)
        ends.append(chunk.content_end)
        at = chunk.end
    return {
        "version": (data[5] >> 4, data[5] & 15),
        "width": header.width,
        "height": header.height,
        "subdivision": header.subdivision,
        "connectivity": layout.CONNECTIVITY_NAMES[header.connectivity],
        "n_vertices": header.n_vertices,
        "depth": header.depth,
        "steps": list(header.steps),
        "chunks": [(chunk.tag.decode(), chunk.length, chunk.content) for chunk in chunks],
        "sides": [container.grid.side] if container.grid else [],
        "tiles": [(own.n_vertices, chunk.content) for own, chunk in container.found]
        if container.grid
        else [],
        "checksums": [int.from_bytes(data[end : end + 4], "little") for end in ends],
    }


@pytest.mark.parametrize("path", _FILES, ids=lambda path: path.stem)
def test_the_description_tells_the_fields_of_a_file(path: Path) -> None:
    data = path.read_bytes()
    reader = Reader(data)
    assert figures_of(parse(_KSY, reader)) == expected(data)
    assert reader.at == 8 * len(data)


@pytest.mark.skipif(
    not has_compiler(), reason="Node finds no kaitai-struct-compiler (npm install, NODE_PATH)"
)
def test_the_compiled_description_tells_the_same() -> None:
    done = node(_COMPILE, json.dumps(_KSY))
    assert done.returncode == 0, done.stderr
    module: dict[str, Any] = {}
    exec(done.stdout, module)
    for path in _FILES:
        data = path.read_bytes()
        assert figures_of(module["Vmesh"].from_bytes(data)) == expected(data)
