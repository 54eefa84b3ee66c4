"""Build the conformance files: ``python -m tests.spec.build_conformance``.

To be run when the format changes or a case is added. The tests hold decoders against the files that
are stored, not against what this would write.
"""

from __future__ import annotations

import hashlib
import io
import json
import re
import shutil
import zlib
from pathlib import Path
from typing import Any, Final

import numpy as np

import vmesh
from tests.codec.damage import file_of, split, with_header
from tests.spec.recipes import (
    DAMAGED,
    MESHES,
    VALID,
    count_bomb,
    flipped,
    largest_canvas,
    mesh_of,
    slivers,
)
from vmesh.codec.layout import VERSION
from vmesh.codec.text import mesh_text
from vmesh.formats.raster.pam import write_pam
from vmesh.formats.raster.rendering import render
from vmesh.mesh import Mesh

FOLDER: Final = Path(__file__).parents[2] / "spec" / "conformance"


def large() -> Mesh:
    """A mesh of many vertices with colours that follow their places, some edges flipped."""
    mesh = mesh_of(200, 150, 3, n_vertices=2000, subdivision=1, step=4)
    x, y = mesh.vertices.T / 2
    planes = [128 + 100 * np.sin(x / 20), 128 + 90 * np.cos((x + y) / 30), y]
    colors = np.clip(np.stack(planes, axis=1), 0, 255).astype(np.uint8)
    smooth = Mesh.from_colors(
        200, 150, mesh.vertices, mesh.triangles, colors, step=4, subdivision=1
    )
    return flipped(smooth, 100)


def row_of_pixels() -> Mesh:
    """The longest row of pixels that the format allows."""
    return mesh_of(65_535, 1, 1, n_vertices=12)


def metadata_bomb() -> bytes:
    """A small file with a profile of 64 MiB."""
    header, chunks = split(VALID)
    bomb = zlib.compress(bytes(1 << 26), 9)
    return file_of(header, [(b"i", bomb), chunks[-1]])


def bombs() -> dict[str, tuple[Mesh, bytes, bool]]:
    """Small files that ask for a lot: mesh, file, and whether its picture takes no limits to draw.

    A reader may refuse them by its limits. That a file asks for the same area to be drawn over and
    over is not among them: it cannot be expressed by a valid one.
    """
    count, fans, canvas = count_bomb(), slivers(), largest_canvas()
    return {
        "a profile of 64 MiB": (vmesh.loads(VALID), metadata_bomb(), True),
        "a count bomb": (count, vmesh.dumps(count), True),
        "slivers": (fans, vmesh.dumps(fans), False),
        "the largest canvas": (canvas, vmesh.dumps(canvas), False),
    }


def sha256(data: bytes) -> str:
    """The SHA-256 of some bytes, in hexadecimal digits."""
    return hashlib.sha256(data).hexdigest()


def pam_bytes(mesh: Mesh) -> bytes:
    """A PAM file of the pixels of a mesh."""
    stream = io.BytesIO()
    write_pam(render(mesh), stream, depth=mesh.depth)
    return stream.getvalue()


def expected(mesh: Mesh, *, drawn: bool = True) -> dict[str, Any]:
    """What a decoder is to make of the file of a mesh, and of its picture if it is to be drawn."""
    figures = {
        "width": mesh.width,
        "height": mesh.height,
        "components": mesh.n_components,
        "vertices": mesh.n_vertices,
        "triangles": mesh.n_triangles,
        "mesh_sha256": sha256(mesh_text(mesh).encode("ascii")),
    }
    if drawn:
        figures["picture_sha256"] = sha256(pam_bytes(mesh))
    return figures


def build() -> dict[str, tuple[bytes, dict[str, Any]]]:
    """Bytes and manifest entry of each file, by its name."""
    files: dict[str, tuple[bytes, dict[str, Any]]] = {}

    def add(folder: str, about: str, data: bytes, **entry: Any) -> None:
        name = f"{folder}/{re.sub('[^a-z0-9]+', '-', about.lower())}.vmesh"
        files[name] = data, {"file": name, "about": about, "sha256": sha256(data), **entry}

    valid = {**MESHES, "two thousand vertices": large, "the longest row": row_of_pixels}
    for about, recipe in valid.items():
        data = vmesh.dumps(recipe())
        add("valid", about, data, **expected(vmesh.loads(data)))
    later = with_header(VALID, version=0x1F)
    add("valid", "version 1.15", later, **expected(vmesh.loads(later)))
    for about, (mesh, data, drawn) in bombs().items():
        add("valid", about, data, or_limit=True, **expected(mesh.canonical(), drawn=drawn))
    for about, (code, data) in DAMAGED.items():
        add("invalid", about, data, error=code)
    return files


def main() -> None:
    """Write all files and the manifest."""
    for folder in ("valid", "invalid"):
        shutil.rmtree(FOLDER / folder, ignore_errors=True)
        (FOLDER / folder).mkdir(parents=True)
    files = build()
    for name, (data, _) in files.items():
        (FOLDER / name).write_bytes(data)
    manifest = {
        "version": ".".join(map(str, VERSION)),
        "files": [entry for _, entry in files.values()],
    }
    text = json.dumps(manifest, indent=1) + "\n"
    (FOLDER / "manifest.json").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
