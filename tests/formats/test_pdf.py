"""PDF output, drawn and read by programs that others wrote."""

from __future__ import annotations

import io
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pikepdf
import pytest
from PIL import Image, ImageCms

import vmesh
from tests.formats.drawings import compare
from tests.formats.renderers import PDF_RENDERERS
from vmesh.arrays import UInt8Array
from vmesh.formats.pdf.document import write_album, write_pdf
from vmesh.formats.pdf.page_size import Layout
from vmesh.kernels.delaunay import delaunay
from vmesh.mesh import Mesh, Metadata

CORNERS = [(0, 0), (1, 0), (0, 1), (1, 1)]
COLORS = [(250, 30, 30), (20, 220, 40), (10, 40, 240), (240, 240, 40)]


def pair_of_triangles(width: int, height: int, n_components: int = 3) -> Mesh:
    vertices = np.array(CORNERS) * (width, height)
    triangles = [(0, 1, 3), (0, 3, 2)]
    colors = np.column_stack([COLORS, [255, 128, 0, 200]])[:, :n_components]
    return Mesh.from_colors(width, height, vertices, triangles, colors)


def slivers() -> Mesh:
    """Triangles a few hundredths of a pixel high, one above the other."""
    inner = [(256 * x + 128, 4 * x + 17) for x in range(1, 39)]
    vertices = np.array([*((256 * 40 * x, 256 * 12 * y) for x, y in CORNERS), *inner])
    vertices = vertices[np.lexsort((vertices[:, 0], vertices[:, 1]))].astype(np.int32)
    colors = np.random.default_rng(1).integers(0, 256, (len(vertices), 3))
    return Mesh.from_colors(40, 12, vertices, delaunay(vertices), colors, subdivision=8)


def with_fade(photograph: UInt8Array) -> UInt8Array:
    fade = np.linspace(0, 255, photograph.shape[1]).astype(np.uint8)
    return np.dstack([photograph, np.broadcast_to(fade, photograph.shape[:2])])


@pytest.fixture(scope="module")
def meshes(coffee: UInt8Array) -> dict[str, Mesh]:
    part = coffee[150:250, 200:320]
    detailed = vmesh.encode(part, method="blue-noise", vertices=250)
    return {
        "photograph": detailed,
        "adaptive": vmesh.encode(part, vertices=120),
        "grey": vmesh.encode(part[:, :, 1], method="blue-noise", vertices=200),
        "alpha": vmesh.encode(with_fade(part), method="blue-noise", vertices=200),
        "pair": pair_of_triangles(40, 30),
        "one pixel": pair_of_triangles(1, 1),
        "slivers": slivers(),
        "tilted": detailed.transform((0.8, 0.6, -0.6, 0.8, 0, 0)),
    }


NAMES = ["photograph", "adaptive", "grey", "alpha", "pair", "one pixel", "slivers", "tilted"]


def written(mesh: Mesh, **options: Any) -> bytes:
    stream = io.BytesIO()
    write_pdf(mesh, stream, **options)
    return stream.getvalue()


def opened(data: bytes) -> pikepdf.Pdf:
    return pikepdf.open(io.BytesIO(data))


@pytest.mark.parametrize("name", NAMES)
def test_qpdf_finds_nothing_wrong(meshes: dict[str, Mesh], name: str) -> None:
    with opened(written(meshes[name])) as document:
        assert document.check_pdf_syntax() == []


# Levels that colours inside of triangles may be off. poppler fills pieces with one colour, up to
# 3 levels from that of the next; pdfium looks up to a pixel beside the pixel that it draws.
INSIDE = {"mupdf": 1, "ghostscript": 1, "pdfium": 7, "poppler": 5}


# What is left on edges is whose pixels those are: poppler gives each to the last triangle that
# touches it, mupdf and pdfium to the one at its top left corner.
@pytest.mark.parametrize("renderer", PDF_RENDERERS)
@pytest.mark.parametrize("name", ["photograph", "adaptive", "grey", "pair"])
def test_colors_are_exact_inside_of_triangles_and_close_on_edges(
    meshes: dict[str, Mesh], name: str, renderer: str, tmp_path: Path
) -> None:
    path = tmp_path / "page.pdf"
    vmesh.export(meshes[name], path, mode="exact")
    for scale, mean, seams in ((1, 5.5, 6.0), (4, 2.0, 2.0)):
        found = compare(PDF_RENDERERS[renderer](path, scale), meshes[name], scale)
        assert found.inside <= INSIDE[renderer]
        assert found.mean <= mean
        assert found.seams <= seams


@pytest.mark.parametrize("renderer", PDF_RENDERERS)
@pytest.mark.parametrize("name", ["alpha", "tilted"])
def test_the_page_shows_through_where_the_picture_lets_it(
    meshes: dict[str, Mesh], name: str, renderer: str, tmp_path: Path
) -> None:
    vmesh.export(meshes[name], tmp_path / "page.pdf")
    found = compare(PDF_RENDERERS[renderer](tmp_path / "page.pdf", 4), meshes[name], 4)
    assert found.mean <= 2.0
    assert found.inside <= 6


# Of slivers nothing is seen but what lies on edges.
@pytest.mark.parametrize("renderer", PDF_RENDERERS)
@pytest.mark.parametrize(("name", "scale", "mean"), [("one pixel", 64, 4.0), ("slivers", 4, 16.0)])
def test_tiny_and_thin_triangles_are_drawn(
    meshes: dict[str, Mesh], name: str, scale: int, mean: float, renderer: str, tmp_path: Path
) -> None:
    vmesh.export(meshes[name], tmp_path / "page.pdf")
    found = compare(PDF_RENDERERS[renderer](tmp_path / "page.pdf", scale), meshes[name], scale)
    assert found.mean <= mean


@pytest.mark.parametrize("renderer", PDF_RENDERERS)
def test_no_seams_show_between_triangles(renderer: str, tmp_path: Path) -> None:
    constant = np.full((60, 80, 3), (10, 20, 30), dtype=np.uint8)
    mesh = vmesh.encode(constant, method="blue-noise", vertices=300)
    vmesh.export(mesh, tmp_path / "constant.pdf")
    for scale in (1, 2, 3):
        drawn = PDF_RENDERERS[renderer](tmp_path / "constant.pdf", scale)
        assert np.abs(drawn.astype(int) - mesh.colors[0]).max() <= 1


@pytest.mark.parametrize("renderer", ["mupdf", "pdfium"])
@pytest.mark.parametrize("subdivision", [0, 3])
def test_the_widest_canvas_is_drawn(renderer: str, subdivision: int, tmp_path: Path) -> None:
    """With eight units to a pixel it takes more than 16 bits, and several shadings."""
    x = np.linspace(0, 65_535, 16).astype(np.int32)
    vertices = np.array([(a, y) for y in (0, 64) for a in x], dtype=np.int32) << subdivision
    ramp = np.rint(np.linspace(0, 255, 16)).astype(np.uint8)
    colors = np.repeat(np.tile(ramp, 2)[:, None], 3, axis=1)
    triangles = delaunay(vertices)
    mesh = Mesh.from_colors(65_535, 64, vertices, triangles, colors, subdivision=subdivision)
    data = written(mesh)
    with opened(data) as document:
        page: Any = document.pages[0].obj
        unit = float(page.UserUnit)
        assert document.Root.Version == "/1.6"
        assert max(map(float, page.MediaBox)) <= 14_400
        assert [unit * float(end) for end in page.MediaBox[2:]] == pytest.approx([65_535, 64])
        assert (len(page.Resources.Shading) > 1) == (subdivision == 3)
    (tmp_path / "wide.pdf").write_bytes(written(mesh, page_width="6000pt"))
    drawn = PDF_RENDERERS[renderer](tmp_path / "wide.pdf", 1)
    assert drawn.shape[1] == 6000
    wanted = np.linspace(0, 255, 6000)
    # The outermost pixels show the page behind the mesh in part.
    assert np.abs(drawn[3, :, 0] - wanted)[1:-1].max() <= 2


def test_the_page_is_as_wide_as_asked_for_or_as_the_resolution_says() -> None:
    exif = Image.Exif()
    exif[282], exif[283], exif[296] = 300.0, 150.0, 2
    metadata = Metadata(exif=exif.tobytes().removeprefix(b"Exif\0\0"))
    plain = pair_of_triangles(600, 300)
    dense = plain.replaced(metadata=metadata)
    for mesh, width, size in (
        (plain, None, (600, 300)),
        (dense, None, (144, 144)),
        (plain, "210mm", (210 / 25.4 * 72, 105 / 25.4 * 72)),
        (dense, "2in", (144, 144)),
        (plain, "30 cm", (30 / 2.54 * 72, 15 / 2.54 * 72)),
    ):
        with opened(written(mesh, page_width=width)) as document:
            box = [float(end) for end in document.pages[0].obj.MediaBox]
        assert box == pytest.approx([0, 0, *size], abs=1e-4)


@pytest.mark.parametrize("backend", ["native", "cairo"])
@pytest.mark.parametrize("name", ["photograph", "grey", "alpha", "tilted"])
def test_a_page_is_of_version_1_4(meshes: dict[str, Mesh], name: str, backend: str) -> None:
    data = written(meshes[name], backend=backend)
    assert data.startswith(b"%PDF-1.4\n")
    with opened(data) as document:
        assert document.check_pdf_syntax() == []
        assert "/Version" not in document.Root
        assert not any("/ObjStm" in repr(item) for item in document.objects)


@pytest.mark.parametrize("backend", ["native", "cairo"])
@pytest.mark.parametrize(
    ("options", "page", "box"),
    [
        ({"page_size": "A4"}, (297, 210), (0, 30.75, 297, 148.5)),
        ({"page_size": "a4", "margin": "10mm"}, (297, 210), (10, 35.75, 277, 138.5)),
        ({"page_size": "A4", "orientation": "portrait"}, (210, 297), (0, 96, 210, 105)),
        ({"page_size": " 210 x 297 mm"}, (210, 297), (0, 96, 210, 105)),
        ({"page_size": "100mmx50mm", "margin": "5mm"}, (100, 50), (10, 5, 80, 40)),
        ({"page_size": "20cm\u00d710cm", "orientation": "portrait"}, (100, 200), (0, 75, 100, 50)),
        ({"page_size": "B5"}, (250, 176), (0, 25.5, 250, 125)),
        ({"page_size": "letter"}, (279.4, 215.9), (0, 38.1, 279.4, 139.7)),
        ({"page_width": "100mm", "margin": "1cm"}, (100, 60), (10, 10, 80, 40)),
        ({"margin": "10pt"}, (620 / 72 * 25.4, 320 / 72 * 25.4), None),
    ],
)
def test_a_picture_is_in_the_middle_of_its_paper_as_large_as_it_fits(
    options: dict[str, Any],
    page: tuple[float, float],
    box: tuple[float, ...] | None,
    backend: Any,
    tmp_path: Path,
) -> None:
    mesh = pair_of_triangles(600, 300)
    path = tmp_path / "page.pdf"
    vmesh.export(mesh, path, backend=backend, **options)
    with pikepdf.open(path) as document:
        ends = [float(end) / 72 * 25.4 for end in document.pages[0].obj.MediaBox]
    assert ends == pytest.approx([0, 0, *page], abs=1e-3)
    drawn = PDF_RENDERERS["mupdf"](path, 1)
    rows, columns = np.nonzero((drawn < 255).any(axis=2))
    left, top, width, height = (10, 10, 600, 300) if box is None else np.array(box) / 25.4 * 72
    assert columns.min() == pytest.approx(left, abs=1.5)
    assert rows.min() == pytest.approx(top, abs=1.5)
    assert columns.max() + 1 == pytest.approx(left + width, abs=1.5)
    assert rows.max() + 1 == pytest.approx(top + height, abs=1.5)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"page_size": "A11"}, "expected a page size such as A4"),
        ({"page_size": "wide"}, "expected a page size such as A4"),
        ({"page_size": "10mm"}, "expected a page size such as A4"),
        ({"page_size": "0x10mm"}, "expected a page size such as A4"),
        ({"page_size": "1e9x10mm"}, "expected a page size such as A4"),
        ({"page_size": "A4", "page_width": "10mm"}, "a size or a width"),
        ({"orientation": "portrait"}, "an orientation is that of a page size"),
        ({"page_size": "A4", "orientation": "upright"}, "expected orientation to be one of"),
        ({"page_size": "A4", "margin": "105mm"}, "leave no room"),
        ({"page_width": "20mm", "margin": "10mm"}, "leave no room"),
        ({"margin": "-1mm"}, "expected a length"),
        ({"margin": "0 parsec"}, "expected a length"),
    ],
)
def test_pages_without_sense_are_refused(
    options: dict[str, Any], message: str, tmp_path: Path
) -> None:
    with pytest.raises(ValueError, match=message):
        vmesh.export(pair_of_triangles(2, 2), tmp_path / "a.pdf", **options)
    assert not list(tmp_path.iterdir())


def titles_of(document: pikepdf.Pdf) -> list[str]:
    return [str(item.title) for item in document.open_outline().root]


@pytest.mark.parametrize("backend", ["native", "cairo"])
def test_an_album_has_a_page_for_each_mesh_with_its_title(
    meshes: dict[str, Mesh], backend: Any, tmp_path: Path
) -> None:
    names = ["photograph", "grey", "alpha", "pair"]
    titles = ["cup (1)", "Kaffee \u2615", "back\\slash", "4"]
    path = tmp_path / "album.pdf"
    vmesh.export_album(
        (meshes[name] for name in names), path, titles=titles, backend=backend, margin="3pt"
    )
    with pikepdf.open(path) as document:
        assert document.check_pdf_syntax() == []
        assert titles_of(document) == titles
        for item, page in zip(document.open_outline().root, document.pages, strict=True):
            assert item.destination[0].objgen == page.obj.objgen  # type: ignore[index]
        for i, name in enumerate(names):
            single = pikepdf.new()
            single.pages.append(document.pages[i])
            single.save(tmp_path / "single.pdf")
            drawn = PDF_RENDERERS["ghostscript"](tmp_path / "single.pdf", 1)[3:-3, 3:-3]
            assert compare(drawn, meshes[name], 1).mean <= 6


def test_titles_of_an_album_are_those_of_the_pictures_or_numbers(tmp_path: Path) -> None:
    exif = Image.Exif()
    exif[270] = "saucer"
    titled = pair_of_triangles(9, 9).replaced(
        metadata=Metadata(exif=exif.tobytes().removeprefix(b"Exif\0\0"))
    )
    path = tmp_path / "album.pdf"
    vmesh.export_album([pair_of_triangles(9, 9), titled], path, strip="none")
    with pikepdf.open(path) as document:
        assert titles_of(document) == ["1", "saucer"]


def test_equal_profiles_of_an_album_are_stored_once(tmp_path: Path) -> None:
    own = ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes() + b"\0" * 4
    mesh = pair_of_triangles(9, 9)
    path = tmp_path / "album.pdf"
    vmesh.export_album([mesh, mesh.replaced(metadata=Metadata(icc=own))] * 10, path)
    with pikepdf.open(path) as document:
        spaces = [page.obj.Resources.Shading.S0.ColorSpace[1].objgen for page in document.pages]
    assert spaces == spaces[:2] * 10
    assert spaces[0] != spaces[1]


def test_pages_of_an_album_are_written_as_they_come(meshes: dict[str, Mesh]) -> None:
    stream = io.BytesIO()
    sizes = []

    def pages() -> Iterator[tuple[str, Mesh]]:
        for name in ("photograph", "adaptive", "grey"):
            sizes.append(len(stream.getvalue()))
            yield name, meshes[name]

    write_album(pages(), stream, layout=Layout())
    assert sizes[0] < 100
    assert sizes[1] > 1000
    assert sizes[2] > sizes[1] + 500


def test_an_album_without_sense_leaves_no_file(tmp_path: Path) -> None:
    path, mesh = tmp_path / "album.pdf", pair_of_triangles(4, 4)
    for meshes, titles in (([], None), ([mesh], []), ([mesh], ["a", "b"])):
        with pytest.raises(ValueError, match="expected a"):
            vmesh.export_album(meshes, path, titles=titles)
    with pytest.raises(vmesh.LimitError):
        vmesh.export_album([mesh], path, limits=vmesh.Limits(max_vertices=3))
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("width", ["", "wide", "-3mm", "0pt", "5 parsec", "1e9pt", "99999999pt"])
def test_a_width_that_is_no_length_is_refused(width: str) -> None:
    with pytest.raises(ValueError, match="expected a length such as 210mm"):
        written(pair_of_triangles(2, 2), page_width=width)


@pytest.mark.parametrize("option", [{"mode": "flat"}, {"backend": "skia"}])
def test_unknown_options_are_refused(option: dict[str, str]) -> None:
    with pytest.raises(ValueError, match=f"expected {next(iter(option))} to be"):
        written(pair_of_triangles(2, 2), **option)


def test_what_exif_says_of_the_picture_is_in_the_document() -> None:
    exif = Image.Exif()
    exif[270], exif[315], exif[306] = "Kaffee <& \u2615>", "A. Photographer", "2024:05:06 07:08:09"
    metadata = Metadata(exif=exif.tobytes().removeprefix(b"Exif\0\0"), xmp=b"<x:xmpmeta/>")
    with opened(written(pair_of_triangles(4, 4).replaced(metadata=metadata))) as document:
        assert document.docinfo.Author == "A. Photographer"
        assert document.docinfo.CreationDate == "D:20240506070809"
        with document.open_metadata() as xmp:
            assert xmp["dc:title"] == str(document.docinfo.Title)
            assert xmp["dc:creator"] == ["A. Photographer"]
            assert xmp["xmp:CreateDate"].startswith("2024-05-06T07:08:09")
            assert xmp["pdf:Producer"] == "vmesh"
        assert document.pages[0].obj.Metadata.read_bytes() == metadata.xmp


def test_damaged_exif_is_passed_over() -> None:
    mesh = pair_of_triangles(4, 4)
    damaged = mesh.replaced(metadata=Metadata(exif=b"II*\0 nonsense"))
    assert written(damaged) == written(mesh)


def color_space(mesh: Mesh) -> Any:
    with opened(written(mesh)) as document:
        space: Any = document.pages[0].obj.Resources.Shading.S0.ColorSpace
        return str(space) if space == "/DeviceGray" else space[1].read_bytes()


def test_colors_are_in_the_profile_of_the_picture_or_in_srgb() -> None:
    own = ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes() + b"\0" * 4
    mesh = pair_of_triangles(4, 4)
    assert color_space(mesh.replaced(metadata=Metadata(icc=own))) == own
    assert ImageCms.ImageCmsProfile(io.BytesIO(color_space(mesh))).profile.xcolor_space == "RGB "
    grey = pair_of_triangles(4, 4, 1)
    assert color_space(grey) == "/DeviceGray"
    assert color_space(grey.replaced(metadata=Metadata(icc=own))) == "/DeviceGray"


@pytest.mark.parametrize("backend", ["native", "cairo"])
def test_the_same_mesh_gives_the_same_bytes(meshes: dict[str, Mesh], backend: str) -> None:
    mesh = meshes["photograph"]
    assert written(mesh, backend=backend) == written(mesh, backend=backend)


def test_pages_are_small(coffee: UInt8Array) -> None:
    mesh = vmesh.encode(coffee, method="blue-noise", vertices=3000)
    page = written(mesh)
    assert len(page) <= 4.6 * len(vmesh.dumps(mesh))
    assert 25 * len(page) <= len(written(mesh, backend="cairo"))


def test_more_vertices_than_the_limit_are_refused() -> None:
    with pytest.raises(vmesh.LimitError):
        written(pair_of_triangles(2, 2), limits=vmesh.Limits(max_vertices=3))
