"""Sheets of encodings, as pixels, SVG and PDF; the latter drawn by programs that others wrote."""

from __future__ import annotations

import io
from itertools import combinations
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pikepdf
import pytest
from lxml import etree
from PIL import Image

import vmesh
from tests.formats.renderers import PDF_RENDERERS, SVG_RENDERERS
from tests.pictures import PICTURES, psnr, share_apart
from vmesh.arrays import UInt8Array
from vmesh.encoder.settings import Settings
from vmesh.errors import LimitError
from vmesh.formats.picture.conversion import flatten
from vmesh.inspection.heat import heat_colors
from vmesh.inspection.region import Region
from vmesh.inspection.sheet.files import write_sheet
from vmesh.inspection.sheet.items import Frame, Label, MeshPart, Pixels, Sheet, Strokes
from vmesh.inspection.sheet.raster import draw_sheet
from vmesh.inspection.sheets import stages_sheet, view_sheet
from vmesh.inspection.stages import Inspection, inspect_encoding
from vmesh.inspection.views import DRAWINGS
from vmesh.limits import Limits

REGION = Region(60, 40, 50, 40)
# They draw no line thinner than a pixel, or smooth none.
DARK_STROKES = ("pdfium", "ghostscript")
SCREENING = [name for name in SVG_RENDERERS if name != "cairosvg"]  # what knows mix-blend-mode
SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture(scope="module")
def found(coffee: UInt8Array) -> Inspection:
    settings = Settings(method="blue-noise", vertices=300)
    return inspect_encoding(coffee[100:260, 180:400], settings)


@pytest.fixture(scope="module")
def sheets(found: Inspection) -> dict[str, Sheet]:
    return {
        "stages": stages_sheet(found, "coffee.png", scale=1),
        "zoom": stages_sheet(found, "coffee.png", REGION, 4),
    }


def written(sheet: Sheet, path: Path) -> Path:
    with path.open("wb") as stream:
        write_sheet(sheet, stream, path.suffix)
    return path


def place_of(item: Pixels | MeshPart | Strokes) -> tuple[slice, slice]:
    """Rows and columns of a sheet that a picture, mesh or strokes fill."""
    if isinstance(item, Pixels):
        height, width = item.array.shape[:2]
        return slice(item.y, item.y + height), slice(item.x, item.x + width)
    view = item.view
    return slice(view.y, view.y + view.height), slice(view.x, view.x + view.width)


def blurred(pixels: UInt8Array) -> UInt8Array:
    """Means of blocks of 10 x 10: how dark strokes are, whatever smooths them."""
    height, width = (side // 10 * 10 for side in pixels.shape[:2])
    blocks = pixels[:height, :width].reshape(height // 10, 10, width // 10, 10, 3)
    means: UInt8Array = blocks.mean(axis=(1, 3)).astype(np.uint8)
    return means


def error_of(drawn: UInt8Array, shown: npt.ArrayLike) -> float:
    """Mean squared error of a drawing, in squared levels."""
    return float(np.square(np.subtract(drawn, shown, dtype=np.float64)).mean())


def check_drawing(sheet: Sheet, drawn: UInt8Array, renderer: str) -> None:
    """Hold a drawing of a sheet against its raster, panel by panel."""
    ours = draw_sheet(sheet)
    assert drawn.shape == ours.shape
    overdrawn = [place_of(item) for item in sheet.items if isinstance(item, Strokes)]
    n_exact = 0
    for item in sheet.items:
        if isinstance(item, Frame | Label):
            continue
        if isinstance(item, Pixels) and place_of(item) in overdrawn:
            continue
        first, second = drawn[place_of(item)][2:-2, 2:-2], ours[place_of(item)][2:-2, 2:-2]
        if isinstance(item, Strokes):
            darker = np.abs(blurred(first).astype(int) - blurred(second)).mean()
            assert darker < (35 if renderer in DARK_STROKES else 12)
        else:
            # Far closer to ours than a panel that is all in the mean colour of ours.
            plain = np.broadcast_to(second.mean(axis=(0, 1)), second.shape)
            is_wider = renderer == "poppler" and isinstance(item, Pixels)  # by a pixel
            share = 1 / 2 if is_wider else 1 / 10
            assert error_of(first, second) < share * error_of(second, plain)
            n_exact += isinstance(item, Pixels) and np.array_equal(first, second)
    assert n_exact >= 4 or renderer == "poppler"
    # Letters are smoothed in as many ways as there are programs.
    assert error_of(drawn, ours) < error_of(np.full_like(ours, 255), ours) / 10


@pytest.mark.parametrize("name", ["stages", "zoom"])
@pytest.mark.parametrize("renderer", SCREENING)
def test_the_svg_sheet_looks_like_the_raster(
    sheets: dict[str, Sheet], name: str, renderer: str, tmp_path: Path
) -> None:
    path = written(sheets[name], tmp_path / "sheet.svg")
    check_drawing(sheets[name], SVG_RENDERERS[renderer](path, 1), renderer)


@pytest.mark.parametrize("name", ["stages", "zoom"])
@pytest.mark.parametrize("renderer", PDF_RENDERERS)
def test_the_pdf_sheet_looks_like_the_raster(
    sheets: dict[str, Sheet], name: str, renderer: str, tmp_path: Path
) -> None:
    path = written(sheets[name], tmp_path / "sheet.pdf")
    check_drawing(sheets[name], PDF_RENDERERS[renderer](path, 1), renderer)


@pytest.mark.parametrize("picture", PICTURES)
@pytest.mark.parametrize("region", [None, Region(0, 0, 1, 1)])
def test_all_kinds_of_pictures_have_sheets(
    picture: str, region: Region | None, tmp_path: Path
) -> None:
    found = inspect_encoding(PICTURES[picture], Settings(effort=1, vertices=10))
    sheet = stages_sheet(found, picture, region)
    ours = draw_sheet(sheet)
    svg = SVG_RENDERERS["librsvg"](written(sheet, tmp_path / "sheet.svg"), 1)
    pdf = PDF_RENDERERS["mupdf"](written(sheet, tmp_path / "sheet.pdf"), 1)
    for drawn in (svg, pdf):
        assert drawn.shape == ours.shape
        pixels = [place_of(item) for item in sheet.items if isinstance(item, Pixels)]
        n_same = sum(share_apart(drawn[place], ours[place]) == 0 for place in pixels)
        assert n_same >= 4  # Letters or the mesh lie over the others.
        assert error_of(drawn, ours) < error_of(np.full_like(ours, 255), ours) / 3


def test_letters_keep_clear_of_each_other_and_of_the_rim(found: Inspection) -> None:
    for region, scale in ((None, 0.1), (None, 1), (None, 5), (REGION, 2), (REGION, 30)):
        sheet = stages_sheet(found, "a name that goes on and on " * 20, region, scale)
        labels = [item for item in sheet.items if isinstance(item, Label)]
        boxes = [
            (label.left, label.y - label.size, label.left + label.width, label.y + label.size / 4)
            for label in labels
        ]
        for left, top, right, bottom in boxes:
            assert left >= 0
            assert top >= 0
            assert right <= sheet.width
            assert bottom <= sheet.height
        for a, b in combinations(boxes, 2):
            assert a[2] <= b[0] or b[2] <= a[0] or a[3] <= b[1] or b[3] <= a[1], (a, b)


def test_captions_tell_the_figures(found: Inspection) -> None:
    mesh = found.mesh
    texts = [item.text for item in stages_sheet(found, "x").items if isinstance(item, Label)]
    error = psnr(found.original, flatten(vmesh.render(mesh)))
    assert texts[:2] == [
        "x",
        f"220 x 160 pixels, {mesh.n_vertices:,} vertices, {mesh.n_triangles:,} triangles, "
        f"{len(vmesh.dumps(mesh)):,} bytes, {8 * len(vmesh.dumps(mesh)) / 220 / 160:.3f} bits per "
        f"pixel, PSNR {error:.2f} dB",
    ]
    names = ["Original", "Salience", "Points", "Mesh", "Render", "Error"]
    assert [text for text in texts if text in names] == names


def test_a_mesh_without_error_has_no_decibels() -> None:
    white = np.full((3, 3, 3), 255, np.uint8)
    found = inspect_encoding(white, Settings(effort=1, vertices=4, color_step=1))
    texts = [item.text for item in stages_sheet(found, "x").items if isinstance(item, Label)]
    assert texts[1].endswith("no error")


def test_the_error_is_drawn_in_the_colours_of_its_bar(found: Inspection) -> None:
    sheet = stages_sheet(found, "x", scale=1)
    *_, error, bar = (item for item in sheet.items if isinstance(item, Pixels))
    last = [item.text for item in sheet.items if isinstance(item, Label)][-1]
    assert last.endswith("+")
    top = int(last.removesuffix("+"))
    rendered = flatten(vmesh.render(found.mesh)).astype(float)
    levels = np.sqrt(((found.original - rendered) ** 2).mean(axis=2))
    assert np.array_equal(error.array, heat_colors(levels / top))
    assert np.array_equal(bar.array[0], heat_colors(np.linspace(0, 1, bar.array.shape[1])))


def test_a_zoom_sets_the_mesh_beside_enlarged_pixels(found: Inspection) -> None:
    sheet = stages_sheet(found, "x", REGION, 4)
    original = found.original[40:80, 60:110]
    _, squares, bicubic, *_ = (item.array for item in sheet.items if isinstance(item, Pixels))
    assert np.array_equal(squares, original.repeat(4, axis=0).repeat(4, axis=1))
    bilinear = np.asarray(Image.fromarray(original).resize((200, 160), Image.Resampling.BILINEAR))
    reduced = [
        enlarged.reshape(40, 4, 50, 4, 3).mean(axis=(1, 3)).round().astype(np.uint8)
        for enlarged in (bicubic, bilinear)
    ]
    assert error_of(reduced[0], original) < error_of(reduced[1], original)
    (part,) = (item for item in sheet.items if isinstance(item, MeshPart))
    whole = flatten(vmesh.render(found.mesh, scale=4))
    assert np.array_equal(part.pixels, whole[160:320, 240:440])


@pytest.mark.parametrize("show", DRAWINGS)
def test_one_view_fills_its_sheet(found: Inspection, show: str) -> None:
    assert draw_sheet(view_sheet(found, show)).shape == (160, 220, 3)
    assert draw_sheet(view_sheet(found, show, scale=0.5)).shape == (80, 110, 3)
    assert draw_sheet(view_sheet(found, show, REGION, 3)).shape == (120, 150, 3)
    assert draw_sheet(view_sheet(found, show, REGION)).shape == (320, 400, 3)


def test_the_render_and_the_original_are_shown_as_they_are(found: Inspection) -> None:
    assert np.array_equal(draw_sheet(view_sheet(found, "original")), found.original)
    rendered = flatten(vmesh.render(found.mesh))
    assert np.array_equal(draw_sheet(view_sheet(found, "render")), rendered)


def test_every_edge_is_drawn_once(found: Inspection) -> None:
    (strokes,) = view_sheet(found, "mesh").items
    assert isinstance(strokes, Strokes)
    points = found.mesh.points
    expected = {
        frozenset((tuple(points[a]), tuple(points[b])))
        for triangle in found.mesh.triangles
        for a, b in combinations(triangle, 2)
    }
    drawn = [frozenset((tuple(a), tuple(b))) for a, b in strokes.ends]
    assert len(drawn) == len(expected)
    assert set(drawn) == expected


def test_points_have_the_colours_of_the_planes_that_they_were_sampled_from(
    found: Inspection,
) -> None:
    items = view_sheet(found, "points").items
    colors = np.array([item.color for item in items if isinstance(item, Strokes)])
    # Red, green and blue, each alone.
    alone = colors[np.count_nonzero(colors, axis=1) == 1]
    assert sorted(np.argmax(alone, axis=1).tolist()) == [0, 1, 2]
    n_points = sum(len(item.ends) for item in items if isinstance(item, Strokes))
    assert n_points == found.mesh.n_vertices
    adaptive = inspect_encoding(found.photograph, Settings(effort=2, vertices=100))
    (strokes,) = view_sheet(adaptive, "points").items
    assert isinstance(strokes, Strokes)
    assert len(set(strokes.color)) == 1  # one ink for all, a grey


def test_vector_sheets_hold_the_mesh_as_paths_and_the_words_as_text(
    found: Inspection, tmp_path: Path
) -> None:
    sheet = stages_sheet(found, "coffee <&> \x07", REGION, 4)
    root = etree.parse(written(sheet, tmp_path / "sheet.svg")).getroot()
    texts = [element.text for element in root.iter(f"{SVG}text")]
    assert texts[0] == "coffee <&> ?: 50 x 40 pixels, 4 times as large"
    assert len(list(root.iter(f"{SVG}image"))) == 6
    n_near = sum(1 for _ in root.iter(f"{SVG}path"))
    (part,) = (item for item in sheet.items if isinstance(item, MeshPart))
    assert part.visible.n_triangles <= n_near < found.mesh.n_triangles
    with pikepdf.open(written(sheet, tmp_path / "sheet.pdf")) as document:
        resources = document.pages[0]["/Resources"]["/XObject"]
        kinds = [str(item["/Subtype"]) for item in resources.values()]
        assert sorted(kinds) == ["/Form", *["/Image"] * 6]
        assert str(document.docinfo["/Title"]).startswith("coffee <&> ?: 50 x 40")
    assert not pikepdf.open(tmp_path / "sheet.pdf").check_pdf_syntax()


def test_the_same_encoding_gives_the_same_bytes(found: Inspection) -> None:
    for suffix in (".svg", ".svgz", ".pdf", ".png"):
        files = []
        for _ in range(2):
            stream = io.BytesIO()
            write_sheet(stages_sheet(found, "x"), stream, suffix)
            files.append(stream.getvalue())
        assert files[0] == files[1], suffix


def test_a_region_beyond_the_picture_and_a_sheet_beyond_the_limit_are_refused(
    found: Inspection, coffee: UInt8Array
) -> None:
    with pytest.raises(ValueError, match="beyond the picture of 220 x 160"):
        stages_sheet(found, "x", Region(200, 0, 21, 10))
    limited = inspect_encoding(
        coffee[:40, :40], Settings(effort=1, vertices=4), limits=Limits(max_pixels=10_000)
    )
    with pytest.raises(LimitError, match="limit is 10000 pixels"):
        stages_sheet(limited, "x", scale=1000)
    with pytest.raises(LimitError, match="limit is 10000 pixels"):
        view_sheet(limited, "mesh", scale=1000)


def test_a_sheet_is_written_in_every_format(found: Inspection, tmp_path: Path) -> None:
    sheet = view_sheet(found, "error")
    for suffix in (".png", ".tif", ".webp", ".jpg"):
        with Image.open(written(sheet, tmp_path / f"sheet{suffix}")) as image:
            assert image.size == (220, 160)
    assert written(sheet, tmp_path / "sheet.pam").read_bytes().startswith(b"P7\n")
    assert written(sheet, tmp_path / "sheet.svgz").read_bytes().startswith(b"\x1f\x8b")
