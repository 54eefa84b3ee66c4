"""The description of the container in Kaitai Struct, against the reader of the library."""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path
from typing import Any, Final

import pytest
import yaml

from tests.programs import need_program
from tests.spec.kaitai import Reader, parse
from vmesh.codec import layout
from vmesh.codec.container import read_file
from vmesh.codec.policy import Strict

_ROOT: Final = Path(__file__).parents[2]
_SPEC: Final = _ROOT / "spec"
_NODE_MODULES: Final = _ROOT / "tests" / "web" / "node_modules"
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


def compiled(ksy: dict[str, Any]) -> str:
    """What the compiler of Kaitai Struct makes of a description: a module in Python."""
    node = need_program("node", "nodejs")
    if not (_NODE_MODULES / "kaitai-struct-compiler").is_dir():
        pytest.skip("the compiler of Kaitai Struct is missing (npm ci --prefix tests/web)")
    done = subprocess.run(
        [node, "-e", _COMPILE],
        input=json.dumps(ksy),
        env={**os.environ, "NODE_PATH": str(_NODE_MODULES)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


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


def test_the_compiled_description_tells_the_same() -> None:
    module: dict[str, Any] = {}
    exec(compiled(_KSY), module)
    for path in _FILES:
        data = path.read_bytes()
        assert figures_of(module["Vmesh"].from_bytes(data)) == expected(data)
