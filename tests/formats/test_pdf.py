"""PDF output, drawn by programs that others wrote."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import vmesh
from tests.formats.renderers import PDF_RENDERERS
from vmesh.formats import cairo_mesh
from vmesh.formats.picture import flatten
from vmesh.metrics import psnr


@pytest.fixture(scope="module")
def detailed(coffee: np.ndarray) -> vmesh.Mesh:
    return vmesh.encode(coffee, method="blue-noise", vertices=20_000)


@pytest.fixture(scope="module")
def page(detailed: vmesh.Mesh, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("pdf") / "page.pdf"
    vmesh.export(detailed, path)
    return path


# At 1x what is left is how each program treats partly covered pixels: poppler gives every pixel
# that a patch touches to the patch, which moves the picture up by a third of a pixel.
@pytest.mark.parametrize(
    ("renderer", "scale", "least"),
    [
        ("poppler", 1, 31.0),
        ("poppler", 4, 41.5),
        ("mupdf", 1, 30.5),
        ("mupdf", 4, 42.5),
        ("pdfium", 1, 32.5),
        ("pdfium", 4, 42.0),
    ],
)
def test_a_photograph_of_20000_vertices_is_drawn_closely(
    page: Path, detailed: vmesh.Mesh, renderer: str, scale: int, least: float
) -> None:
    drawn = PDF_RENDERERS[renderer](page, scale)
    assert psnr(drawn, vmesh.render(detailed, scale=scale)) >= least


@pytest.mark.parametrize("renderer", PDF_RENDERERS)
@pytest.mark.parametrize("components", [1, 4])
def test_grey_and_alpha_are_drawn(
    chelsea: np.ndarray, renderer: str, components: int, tmp_path: Path
) -> None:
    picture = chelsea[:, :, 1]
    if components == 4:
        fade = np.linspace(0, 255, chelsea.shape[1]).astype(np.uint8)
        picture = np.dstack([chelsea, np.broadcast_to(fade, chelsea.shape[:2])])
    mesh = vmesh.encode(picture, vertices=1000)
    path = tmp_path / "picture.pdf"
    vmesh.export(mesh, path)
    drawn = PDF_RENDERERS[renderer](path, 2)
    assert psnr(drawn, flatten(vmesh.render(mesh, scale=2))) >= 35.0


@pytest.mark.parametrize("renderer", PDF_RENDERERS)
def test_no_seams_show_between_triangles(renderer: str, tmp_path: Path) -> None:
    constant = np.full((60, 80, 3), (10, 20, 30), dtype=np.uint8)
    mesh = vmesh.encode(constant, vertices=300)
    vmesh.export(mesh, tmp_path / "constant.pdf")
    drawn = PDF_RENDERERS[renderer](tmp_path / "constant.pdf", 3)
    assert np.abs(drawn.astype(int) - mesh.colors[0]).max() <= 1


def test_the_page_has_the_size_of_the_canvas(page: Path, detailed: vmesh.Mesh) -> None:
    drawn = PDF_RENDERERS["poppler"](page, 1)
    assert drawn.shape == (detailed.height, detailed.width, 3)


def test_a_missing_cairo_library_is_told_in_one_sentence(
    coffee: np.ndarray, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(name: str, *rest: object) -> object:
        if name == "cairocffi":
            raise OSError("no library called cairo was found")
        return original(name, *rest)  # type: ignore[arg-type]

    import builtins

    original = builtins.__import__
    monkeypatch.setattr(builtins, "__import__", fail)
    with pytest.raises(vmesh.VmeshError, match="libcairo2"):
        cairo_mesh.import_cairo()


def test_a_mesh_is_painted_on_any_cairo_context(coffee: np.ndarray) -> None:
    cairocffi = cairo_mesh.import_cairo()
    from vmesh.formats.pdf import paint_mesh

    mesh = vmesh.encode(coffee, method="blue-noise", vertices=2000)
    surface = cairocffi.ImageSurface(cairocffi.FORMAT_RGB24, mesh.width * 2, mesh.height * 2)
    context = cairocffi.Context(surface)
    context.scale(2, 2)
    paint_mesh(mesh, context)
    surface.flush()
    pixels = np.frombuffer(surface.get_data(), np.uint8).reshape(mesh.height * 2, -1, 4)
    assert psnr(pixels[:, :, 2::-1], vmesh.render(mesh, scale=2)) >= 40.0
