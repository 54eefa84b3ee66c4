"""Meshes painted by cairo, on its own pages and on those of other applications."""

from __future__ import annotations

import builtins
from pathlib import Path

import numpy as np
import pytest

import vmesh
from tests.formats.drawings import compare
from tests.formats.renderers import PDF_RENDERERS
from vmesh.arrays import UInt8Array
from vmesh.formats.pdf.cairo_patterns import import_cairo
from vmesh.mesh import Mesh


@pytest.fixture(scope="module")
def mesh(coffee: UInt8Array) -> Mesh:
    return vmesh.encode(coffee[150:250, 200:320], method="blue-noise", vertices=250)


@pytest.mark.parametrize("renderer", PDF_RENDERERS)
def test_the_page_that_cairo_writes_is_drawn_closely(
    mesh: Mesh, renderer: str, tmp_path: Path
) -> None:
    vmesh.export(mesh, tmp_path / "page.pdf", backend="cairo")
    assert compare(PDF_RENDERERS[renderer](tmp_path / "page.pdf", 4), mesh, 4).mean <= 2.5


def test_a_mesh_is_painted_on_any_cairo_context(mesh: Mesh) -> None:
    cairocffi = import_cairo()
    surface = cairocffi.ImageSurface(cairocffi.FORMAT_RGB24, mesh.width * 2, mesh.height * 2)
    context = cairocffi.Context(surface)
    context.scale(2, 2)
    vmesh.paint_mesh(mesh, context)
    surface.flush()
    pixels = np.frombuffer(surface.get_data(), np.uint8).reshape(mesh.height * 2, -1, 4)
    found = compare(pixels[:, :, 2::-1], mesh, 2)
    assert found.inside <= 1.0
    assert found.mean <= 2.5


@pytest.mark.parametrize(
    ("error", "wanted"), [(OSError, "libcairo2"), (ImportError, "pip install cairocffi")]
)
def test_what_is_missing_for_cairo_is_told_where_cairo_is_asked_for(
    mesh: Mesh,
    error: type[Exception],
    wanted: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    original = builtins.__import__

    def fail(name: str, *rest: object) -> object:
        if name == "cairocffi":
            raise error("no library called cairo was found")
        return original(name, *rest)  # type: ignore[arg-type]

    monkeypatch.setattr(builtins, "__import__", fail)
    vmesh.export(mesh, tmp_path / "native.pdf")
    with pytest.raises(vmesh.VmeshError, match=wanted):
        vmesh.export(mesh, tmp_path / "cairo.pdf", backend="cairo")
    assert not (tmp_path / "cairo.pdf").exists()
