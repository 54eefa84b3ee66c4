"""SVG output, drawn by programs that others wrote."""

from __future__ import annotations

import gzip
from pathlib import Path
from typing import Any, get_args

import numpy as np
import numpy.typing as npt
import pytest
import scipy.ndimage
from lxml import etree
from PIL import Image

import vmesh
from tests.formats.drawings import compare
from tests.formats.renderers import PDF_RENDERERS, SVG_RENDERERS
from vmesh.formats.picture.conversion import flatten
from vmesh.formats.raster.rendering import scaled_positions
from vmesh.formats.svg.style import Mode, Style
from vmesh.kernels.scanline import label

SVG = "{http://www.w3.org/2000/svg}"


BLENDING = [name for name in SVG_RENDERERS if name != "cairosvg"]  # what knows mix-blend-mode


@pytest.fixture(scope="module")
def photograph(coffee: np.ndarray) -> np.ndarray:
    """The middle of a photograph: some programs take a second to draw all of it."""
    return np.ascontiguousarray(coffee[100:300, 150:450])


@pytest.fixture(scope="module")
def detailed(photograph: np.ndarray) -> vmesh.Mesh:
    return vmesh.encode(photograph, method="blue-noise", vertices=1_250)


@pytest.fixture(scope="module")
def small(coffee: np.ndarray) -> vmesh.Mesh:
    return vmesh.encode(coffee, method="blue-noise", vertices=500)


@pytest.fixture(scope="module")
def drawings(detailed: vmesh.Mesh, tmp_path_factory: pytest.TempPathFactory) -> dict[Mode, Path]:
    folder = tmp_path_factory.mktemp("svg")
    paths: dict[Mode, Path] = {mode: folder / f"{mode}.svg" for mode in get_args(Mode)}
    for mode, path in paths.items():
        vmesh.export(detailed, path, mode=mode)
    return paths


def error_of(drawn: npt.ArrayLike, shown: npt.ArrayLike) -> float:
    """Mean squared error of a drawing, in squared levels."""
    return float(np.square(np.subtract(drawn, shown, dtype=np.float64)).mean())


@pytest.mark.parametrize("renderer", SVG_RENDERERS)
@pytest.mark.parametrize("scale", [1, 4])
def test_gradients_leave_less_than_a_tenth_of_the_error_of_flat_colors(
    drawings: dict[Mode, Path], detailed: vmesh.Mesh, renderer: str, scale: int
) -> None:
    shown = vmesh.render(detailed, scale=scale)
    drawn = SVG_RENDERERS[renderer](drawings["gradient"], scale)
    assert error_of(drawn, shown) < error_of(mean_of_pixels(detailed, shown), shown) / 10


@pytest.mark.parametrize("renderer", SVG_RENDERERS)
def test_flat_triangles_own_the_pixels_that_our_raster_gives_them(
    drawings: dict[Mode, Path], detailed: vmesh.Mesh, renderer: str
) -> None:
    shown = vmesh.render(detailed)
    drawn = SVG_RENDERERS[renderer](drawings["flat"], 1)
    assert error_of(drawn, shown) < 1.02 * error_of(mean_of_pixels(detailed, shown), shown)


def mean_of_pixels(mesh: vmesh.Mesh, shown: np.ndarray) -> np.ndarray:
    """A raster with each triangle's pixels in their mean: the closest that flat colours come."""
    owners = np.full(shown.shape[:2], -1, dtype=np.int32)
    label(scaled_positions(mesh, (shown.shape[1], shown.shape[0])), mesh.triangles, owners)
    ids, places = np.unique(owners, return_inverse=True)
    means = [scipy.ndimage.mean(shown[:, :, z], owners, ids) for z in range(3)]
    raster: np.ndarray = np.rint(np.stack(means, axis=1))[places.reshape(owners.shape)]
    return raster


@pytest.mark.parametrize("renderer", BLENDING)
@pytest.mark.parametrize("scale", [1, 4])
def test_exact_drawings_are_within_a_level_inside_of_triangles(
    drawings: dict[Mode, Path], detailed: vmesh.Mesh, renderer: str, scale: int
) -> None:
    found = compare(SVG_RENDERERS[renderer](drawings["exact"], scale), detailed, scale)
    assert found.inside <= 1.0
    assert found.seams < 0.6


@pytest.mark.parametrize("renderer", BLENDING)
def test_mode_auto_keeps_within_its_tolerance(
    drawings: dict[Mode, Path], detailed: vmesh.Mesh, renderer: str
) -> None:
    found = compare(SVG_RENDERERS[renderer](drawings["auto"], 4), detailed, 4)
    assert found.inside <= 4.0 + 0.5  # and the rounding of our raster


def unblended(path: Path) -> Path:
    """The same drawing as a program shows it that knows no blend modes."""
    copy = path.with_suffix(".plain.svg")
    copy.write_bytes(path.read_bytes().replace(b' style="mix-blend-mode:lighten"', b""))
    assert copy.read_bytes() != path.read_bytes()
    return copy


@pytest.mark.parametrize("mode", ["exact", "auto"])
def test_layers_are_about_the_picture_in_programs_without_blend_modes(
    drawings: dict[Mode, Path], detailed: vmesh.Mesh, mode: Mode
) -> None:
    shown = vmesh.render(detailed)
    flat = error_of(mean_of_pixels(detailed, shown), shown)
    for drawn in (
        SVG_RENDERERS["cairosvg"](drawings[mode], 1),
        SVG_RENDERERS["resvg"](unblended(drawings[mode]), 1),
    ):
        assert error_of(drawn, shown) < flat / 3


@pytest.mark.parametrize("colors", ["any", "dark", "bright", "one channel"])
def test_the_last_layer_is_nowhere_lighter_than_the_picture(
    colors: str, detailed: vmesh.Mesh, tmp_path: Path
) -> None:
    drawn_colors = np.random.default_rng(3).integers(0, 256, (detailed.n_vertices, 3))
    if colors == "dark":
        drawn_colors //= 20
    elif colors == "bright":
        drawn_colors = 255 - drawn_colors // 20
    elif colors == "one channel":
        drawn_colors[:, 1:] = 0
    mesh = vmesh.Mesh.from_colors(
        detailed.width,
        detailed.height,
        detailed.vertices,
        detailed.triangles,
        drawn_colors.astype(np.uint8),
        subdivision=detailed.subdivision,
    )
    path = tmp_path / "exact.svg"
    vmesh.export(mesh, path, mode="exact")
    shown = vmesh.render(mesh).astype(int)
    assert np.abs(SVG_RENDERERS["resvg"](path, 1) - shown).max() <= 2
    assert (SVG_RENDERERS["resvg"](unblended(path), 1) - shown).max() <= 2


@pytest.mark.parametrize("renderer", SVG_RENDERERS)
def test_merged_regions_take_fewer_bytes_and_stay_far_closer_than_flat_colors(
    drawings: dict[Mode, Path], detailed: vmesh.Mesh, renderer: str, tmp_path: Path
) -> None:
    path = tmp_path / "merged.svg"
    vmesh.export(detailed, path, merge=300.0)
    assert path.stat().st_size < 0.8 * drawings["gradient"].stat().st_size
    shown = vmesh.render(detailed)
    drawn = SVG_RENDERERS[renderer](path, 1)
    assert error_of(drawn, shown) < error_of(mean_of_pixels(detailed, shown), shown) / 10


def test_what_is_merged_is_drawn_as_one_region_with_its_holes(tmp_path: Path) -> None:
    # A white square in a black frame: two regions, one of them with a hole.
    steps = np.arange(4)
    places = np.array([(x, y) for y in steps for x in steps])
    corners = [
        (y * 4 + x, y * 4 + x + 1, y * 4 + x + 5, y * 4 + x + 4) for y in range(3) for x in range(3)
    ]
    places = np.concatenate(
        [places * 10, places[[5, 6, 10, 9]] * 10 + [(1, 1), (-1, 1), (-1, -1), (1, -1)]]
    )
    inner = [(16, 17, 18, 19)]
    ring = [(5, 6, 17, 16), (6, 10, 18, 17), (10, 9, 19, 18), (9, 5, 16, 19)]
    quads = [quad for i, quad in enumerate(corners) if i != 4] + ring + inner
    triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    colors = np.zeros((20, 3), dtype=np.uint8)
    colors[16:] = 255
    mesh = vmesh.Mesh.from_colors(30, 30, places, triangles, colors)
    path = tmp_path / "frame.svg"
    vmesh.export(mesh, path, merge=1.0)
    outlines = [element.get("d", "") for element in etree.parse(path).iter(f"{SVG}path")]
    assert len(outlines) < mesh.n_triangles - 10
    assert any(outline.count("m") == 2 for outline in outlines)
    drawn = SVG_RENDERERS["librsvg"](path, 1)
    assert np.abs(drawn.astype(int) - vmesh.render(mesh)).max() <= 1


@pytest.mark.parametrize(
    "option",
    [
        {"tolerance": 0},
        {"merge": -1},
        {"merge": 1, "mode": "exact"},
        {"seams": "none"},
        {"seams": "trapping", "mode": "auto"},
    ],
)
def test_options_without_sense_are_refused(
    detailed: vmesh.Mesh, option: dict[str, Any], tmp_path: Path
) -> None:
    with pytest.raises(ValueError, match=r"expected|merged|trapping"):
        vmesh.export(detailed, tmp_path / "a.svg", **option)
    assert not list(tmp_path.iterdir())


def test_the_title_of_a_photograph_is_told_and_escaped(tmp_path: Path) -> None:
    exif = Image.Exif()
    exif[270] = "cup <& saucer>"
    exif[315] = "A. Painter"
    metadata = vmesh.Metadata(exif=exif.tobytes().removeprefix(b"Exif\0\0"), icc=b"profile")
    square = np.array([(0, 0), (9, 0), (9, 9), (0, 9)])
    colors = np.zeros((4, 1), dtype=np.uint8)
    triangles = [(0, 1, 2), (0, 2, 3)]
    mesh = vmesh.Mesh.from_colors(9, 9, square, triangles, colors, metadata=metadata)
    path = tmp_path / "titled.svg"
    vmesh.export(mesh, path)
    root = etree.parse(path).getroot()
    assert root.findtext(f"{SVG}title") == "cup <& saucer>"
    assert root.findtext(f"{SVG}desc") == "A. Painter"
    assert b"profile" not in path.read_bytes()


@pytest.mark.parametrize(
    ("asked", "told"),
    [
        ({}, ("600", "400")),
        ({"width": 900}, ("900", "600")),
        ({"height": "100.5"}, ("150.75", "100.5")),
        ({"width": " 210MM "}, ("210mm", "140mm")),
        ({"width": "100%"}, ("100%", None)),
        ({"width": "20em", "height": "50%"}, ("20em", "50%")),
    ],
)
def test_a_drawing_shows_at_the_size_that_is_asked_for(
    small: vmesh.Mesh, asked: dict[str, Any], told: tuple[str | None, ...], tmp_path: Path
) -> None:
    path = tmp_path / "sized.svg"
    vmesh.export(small, path, **asked)
    root = etree.parse(path).getroot()
    assert (root.get("width"), root.get("height")) == told
    assert root.get("viewBox") == "0 0 600 400"


@pytest.mark.parametrize("renderer", ["librsvg", "resvg", "cairosvg"])
def test_a_drawing_of_another_size_is_scaled(
    small: vmesh.Mesh, renderer: str, tmp_path: Path
) -> None:
    path = tmp_path / "half.svg"
    vmesh.export(small, path, width=300)
    shown = vmesh.render(small, scale=0.5)
    drawn = SVG_RENDERERS[renderer](path, 1)
    assert error_of(drawn, shown) < error_of(mean_of_pixels(small, shown), shown) / 10


@pytest.mark.parametrize("length", ["wide", "0", "-3", "5 mm", "5q", "1e9", "2000000", "nan", ""])
def test_what_is_no_length_is_refused(small: vmesh.Mesh, length: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="expected a length such as 800, 210mm or 100%, got"):
        vmesh.export(small, tmp_path / "a.svg", height=length)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("renderer", SVG_RENDERERS)
def test_no_seams_show_between_triangles(renderer: str, tmp_path: Path) -> None:
    constant = np.full((60, 80, 3), (10, 20, 30), dtype=np.uint8)
    mesh = vmesh.encode(constant, vertices=300)
    path = tmp_path / "constant.svg"
    vmesh.export(mesh, path)
    # No backdrop: whatever shines through would be white.
    tree = etree.parse(path)
    for backdrop in tree.findall(f".//{SVG}rect"):
        parent = backdrop.getparent()
        assert parent is not None
        parent.remove(backdrop)
    tree.write(path)
    for scale in (1, 3):
        drawn = SVG_RENDERERS[renderer](path, scale)
        assert np.abs(drawn.astype(int) - mesh.colors[0]).max() <= 1


def smoothed(path: Path) -> Path:
    """The same drawing as a program shows it that smooths all edges, whatever it is told."""
    copy = path.with_suffix(".smooth.svg")
    copy.write_bytes(path.read_bytes().replace(b' shape-rendering="crispEdges"', b""))
    return copy


@pytest.mark.parametrize("renderer", SVG_RENDERERS)
def test_trapping_hides_the_seams_of_smooth_edges(
    drawings: dict[Mode, Path], detailed: vmesh.Mesh, renderer: str, tmp_path: Path
) -> None:
    draw = SVG_RENDERERS[renderer]
    path = tmp_path / "trapping.svg"
    vmesh.export(detailed, path, seams="trapping")
    assert b"shape-rendering" not in path.read_bytes()
    for scale in (1, 3):
        crisp = compare(draw(smoothed(drawings["gradient"]), scale), detailed, scale)
        found = compare(draw(path, scale), detailed, scale)
        assert found.seams < 0.4 * crisp.seams


@pytest.mark.parametrize("renderer", BLENDING)
def test_exact_drawings_are_trapped_too(
    drawings: dict[Mode, Path], detailed: vmesh.Mesh, renderer: str, tmp_path: Path
) -> None:
    draw = SVG_RENDERERS[renderer]
    path = tmp_path / "trapping.svg"
    vmesh.export(detailed, path, mode="exact", seams="trapping")
    crisp = compare(draw(smoothed(drawings["exact"]), 2), detailed, 2)
    found = compare(draw(path, 2), detailed, 2)
    assert found.inside <= 1.0
    assert found.seams < 0.4 * crisp.seams


@pytest.mark.parametrize("mode", ["gradient", "exact", "auto", "flat"])
def test_gradients_fitted_to_the_photograph_are_closer_to_it(
    photograph: np.ndarray,
    drawings: dict[Mode, Path],
    detailed: vmesh.Mesh,
    mode: Mode,
    tmp_path: Path,
) -> None:
    path = tmp_path / "fitted.svg"
    vmesh.export(detailed, path, mode=mode, fit=photograph)
    fitted, own = (SVG_RENDERERS["librsvg"](each, 1) for each in (path, drawings[mode]))
    assert error_of(fitted, photograph) < error_of(own, photograph)


def test_a_photograph_that_the_mesh_draws_is_fitted_as_the_mesh_is(
    small: vmesh.Mesh, tmp_path: Path
) -> None:
    vmesh.export(small, tmp_path / "own.svg", mode="exact")
    vmesh.export(small, tmp_path / "fitted.svg", mode="exact", fit=vmesh.render(small))
    draw = SVG_RENDERERS["librsvg"]
    own, fitted = (draw(tmp_path / f"{name}.svg", 1).astype(int) for name in ("own", "fitted"))
    assert np.abs(own - fitted).mean() < 0.2


@pytest.mark.parametrize("n_pixels", [1, 3])
def test_triangles_without_pixels_keep_the_colors_of_the_mesh(
    n_pixels: int, tmp_path: Path
) -> None:
    # Each pixel in 128 triangles, hardly any of which holds its centre.
    steps = np.arange(0, n_pixels * 8 + 1)
    places = [(x, y) for y in steps for x in steps]
    side = len(steps)
    corners = [i for i in range(side * side - side) if i % side < side - 1]
    quads = [(i, i + 1, i + side + 1, i + side) for i in corners]
    triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    colors = np.full((len(places), 3), 200, dtype=np.uint8)
    mesh = vmesh.Mesh.from_colors(n_pixels, n_pixels, places, triangles, colors, subdivision=3)
    path = tmp_path / "small.svg"
    vmesh.export(mesh, path, fit=np.zeros((n_pixels, n_pixels, 3), dtype=np.uint8))
    drawn = SVG_RENDERERS["librsvg"](path, 8)
    assert (drawn == 200).mean() > 0.8
    assert (drawn < 190).any()


def test_pixels_that_do_not_show_are_not_fitted_to(photograph: np.ndarray, tmp_path: Path) -> None:
    alpha = np.zeros(photograph.shape[:2], dtype=np.uint8)
    alpha[:, :150] = 255
    hidden = np.where(alpha[:, :, None] > 0, photograph, 255 - photograph)
    mesh = vmesh.encode(np.dstack([photograph, alpha]), vertices=500)
    for name, colors in (("plain", photograph), ("inverse", hidden)):
        vmesh.export(mesh, tmp_path / f"{name}.svg", fit=np.dstack([colors, alpha]))
    assert (tmp_path / "plain.svg").read_bytes() == (tmp_path / "inverse.svg").read_bytes()
    vmesh.export(mesh, tmp_path / "own.svg")
    visible = flatten(np.dstack([photograph, alpha]))
    fitted, own = (
        SVG_RENDERERS["librsvg"](tmp_path / f"{name}.svg", 1) for name in ("plain", "own")
    )
    assert error_of(fitted, visible) < error_of(own, visible)


@pytest.mark.parametrize(
    "photograph",
    [
        np.zeros((300, 600, 3), dtype=np.uint8),
        np.zeros((400, 600, 2), dtype=np.uint8),
        np.zeros((400, 600, 3)),
    ],
)
def test_what_is_no_photograph_of_the_mesh_is_not_fitted_to(
    small: vmesh.Mesh, photograph: np.ndarray, tmp_path: Path
) -> None:
    with pytest.raises(ValueError, match="expected a photograph of"):
        vmesh.export(small, tmp_path / "a.svg", fit=photograph)
    assert not list(tmp_path.iterdir())


@pytest.fixture(scope="module")
def grey_and_alpha(photograph: np.ndarray) -> dict[str, vmesh.Mesh]:
    fade = np.linspace(0, 255, photograph.shape[1]).astype(np.uint8)
    alpha = np.broadcast_to(fade, photograph.shape[:2])
    pictures = {"grey": photograph[:, :, 1], "alpha": np.dstack([photograph, alpha])}
    return {name: vmesh.encode(picture, vertices=800) for name, picture in pictures.items()}


@pytest.mark.parametrize("renderer", BLENDING)  # CairoSVG draws no such mask
@pytest.mark.parametrize("name", ["grey", "alpha"])
def test_grey_and_alpha_are_drawn(
    grey_and_alpha: dict[str, vmesh.Mesh], renderer: str, name: str, tmp_path: Path
) -> None:
    mesh = grey_and_alpha[name]
    path = tmp_path / "picture.svg"
    vmesh.export(mesh, path)
    shown = flatten(vmesh.render(mesh))
    drawn = SVG_RENDERERS[renderer](path, 1)
    assert error_of(drawn, shown) < error_of(mean_of_pixels(mesh, shown), shown) / 10


@pytest.mark.parametrize("suffix", ["svg", "pdf"])
@pytest.mark.parametrize("components", [1, 3, 4])
def test_nothing_is_drawn_beyond_a_tilted_mesh(
    photograph: np.ndarray, components: int, suffix: str, tmp_path: Path
) -> None:
    opaque = np.dstack([photograph, np.full(photograph.shape[:2], 255, dtype=np.uint8)])
    picture = photograph[:, :, 0] if components == 1 else opaque[:, :, :components]
    tilted = vmesh.encode(picture, method="blue-noise", vertices=250).transform(
        (0.8, 0.6, -0.6, 0.8, 0, 0)
    )
    path = tmp_path / f"tilted.{suffix}"
    vmesh.export(tilted, path)
    renderer = SVG_RENDERERS["librsvg"] if suffix == "svg" else PDF_RENDERERS["poppler"]
    drawn = renderer(path, 1)
    outside = vmesh.render(tilted)[:, :, 3] == 0
    assert (drawn[:10, :10] == 255).all()
    assert (drawn[outside] == 255).all(axis=1).mean() > 0.97


def test_a_document_is_valid_xml_with_a_view_box(drawings: dict[Mode, Path]) -> None:
    root = etree.parse(drawings["gradient"]).getroot()
    assert root.tag == f"{SVG}svg"
    assert root.get("viewBox") == "0 0 300 200"
    ids = [element.get("id") for element in root.iter() if element.get("id")]
    assert len(ids) == len(set(ids))
    fills = {path.get("fill", "") for path in root.iter(f"{SVG}path")}
    references = {fill[5:-1] for fill in fills if fill.startswith("url(#")}
    assert references == {element.get("id") for element in root.iter(f"{SVG}linearGradient")}


def ids_of(path: Path) -> set[str]:
    """Ids in a document, which are all that it refers to."""
    root = etree.parse(path).getroot()
    ids = {element.get("id", "") for element in root.iter()} - {""}
    values = {str(value) for element in root.iter() for value in element.attrib.values()}
    assert ids == {value[5:-1] for value in values if value.startswith("url(#")}
    return ids


@pytest.mark.parametrize("style", [{}, {"mode": "exact"}, {"merge": 50.0}])
def test_different_drawings_share_no_ids(
    grey_and_alpha: dict[str, vmesh.Mesh], style: dict[str, Any], tmp_path: Path
) -> None:
    mesh = grey_and_alpha["alpha"]
    colors = mesh.plain_colors.copy()
    colors[0, 0] ^= 1
    turned = mesh.transform((-1, 0, 0, 1, 0, 0))
    other = vmesh.Mesh.from_colors(
        mesh.width,
        mesh.height,
        mesh.vertices,
        mesh.triangles,
        colors,
        subdivision=mesh.subdivision,
    )
    found = []
    for each in (mesh, turned, other):
        vmesh.export(each, tmp_path / "a.svg", **style)
        found.append(ids_of(tmp_path / "a.svg"))
    vmesh.export(mesh, tmp_path / "a.svg", **style, seams="trapping")
    found.append(ids_of(tmp_path / "a.svg"))
    assert sum(map(len, found)) == len(set().union(*found))


def test_the_same_drawing_of_another_size_has_the_same_ids(
    small: vmesh.Mesh, tmp_path: Path
) -> None:
    vmesh.export(small, tmp_path / "a.svg")
    vmesh.export(small, tmp_path / "b.svg", width="100%")
    assert ids_of(tmp_path / "a.svg") == ids_of(tmp_path / "b.svg")


def test_ids_begin_as_asked_and_no_two_prefixes_give_the_same(
    grey_and_alpha: dict[str, vmesh.Mesh], tmp_path: Path
) -> None:
    found = []
    for prefix in ("a", "ab", "a-", "_1", "Photo"):
        vmesh.export(grey_and_alpha["alpha"], tmp_path / "a.svg", id_prefix=prefix)
        found.append(ids_of(tmp_path / "a.svg"))
        assert all(each.startswith(prefix) for each in found[-1])
        VOCABULARY.assertValid(etree.parse(tmp_path / "a.svg"))
    assert sum(map(len, found)) == len(set().union(*found))


@pytest.mark.parametrize("prefix", ["", "1a", "-a", "a b", "a)", 'a"', "\u00e9", "a\n", 65 * "a"])
def test_what_ids_cannot_begin_with_is_refused(
    small: vmesh.Mesh, prefix: str, tmp_path: Path
) -> None:
    with pytest.raises(ValueError, match="expected ids to begin with a letter or _"):
        vmesh.export(small, tmp_path / "a.svg", id_prefix=prefix)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("mode", ["gradient", "flat"])
def test_every_triangle_has_a_path(
    detailed: vmesh.Mesh, drawings: dict[Mode, Path], mode: Mode
) -> None:
    assert len(etree.parse(drawings[mode]).findall(f".//{SVG}path")) == detailed.n_triangles


def test_compressed_svg_holds_the_same_document(small: vmesh.Mesh, tmp_path: Path) -> None:
    vmesh.export(small, tmp_path / "a.svg")
    vmesh.export(small, tmp_path / "a.svgz")
    plain = (tmp_path / "a.svg").read_bytes()
    assert gzip.decompress((tmp_path / "a.svgz").read_bytes()) == plain


@pytest.mark.parametrize("suffix", ["svg", "svgz", "pdf"])
def test_the_same_mesh_gives_the_same_bytes(small: vmesh.Mesh, tmp_path: Path, suffix: str) -> None:
    for name in ("a", "b"):
        vmesh.export(small, tmp_path / f"{name}.{suffix}")
    assert (tmp_path / f"a.{suffix}").read_bytes() == (tmp_path / f"b.{suffix}").read_bytes()


@pytest.mark.parametrize("mode", ["gradient", "exact", "auto", "flat"])
def test_progress_names_the_stages_of_each_layer(
    small: vmesh.Mesh, tmp_path: Path, mode: Mode
) -> None:
    stages: list[str] = []
    vmesh.export(small, tmp_path / "a.svg", mode=mode, tolerance=0.5, progress=stages.append)
    assert stages == ["fitting"] + (len(stages) // 2) * ["gradients", "paths"]
    assert len(stages) == Style(mode).n_stages


def test_an_unknown_mode_is_refused_and_leaves_no_file(small: vmesh.Mesh, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="mode"):
        vmesh.export(small, tmp_path / "a.svg", mode="round")  # type: ignore[arg-type]
    assert not list(tmp_path.iterdir())


def test_flat_colors_keep_within_the_limits(small: vmesh.Mesh, tmp_path: Path) -> None:
    for limits in (vmesh.Limits(max_pixels=1000), vmesh.Limits(max_work=1000)):
        with pytest.raises(vmesh.LimitError):
            vmesh.export(small, tmp_path / "a.svg", mode="flat", limits=limits)
    assert not list(tmp_path.iterdir())


def of_quads(width: int, height: int, places: Any, colors: Any) -> vmesh.Mesh:
    """A mesh of the columns between pairs of places, one above the other."""
    n = len(places) // 2
    faces = [t for i in range(0, 2 * n - 2, 2) for t in ((i, i + 2, i + 3), (i, i + 3, i + 1))]
    return vmesh.Mesh.from_colors(width, height, places, faces, np.asarray(colors, np.uint8))


EXTREMES = {
    "a single pixel": of_quads(1, 1, [(0, 0), (0, 1), (1, 0), (1, 1)], [(9, 90, 200)] * 4),
    "a pair of triangles": of_quads(
        40, 30, [(0, 0), (0, 30), (40, 0), (40, 30)], np.arange(12).reshape(4, 3) * 20
    ),
    "the widest canvas": of_quads(
        65_535, 20, [(0, 0), (0, 20), (65_535, 0), (65_535, 20)], np.arange(12).reshape(4, 3) * 20
    ),
    "slivers": of_quads(
        300,
        200,
        [(0, 0), (0, 200), (1, 0), (299, 200), (300, 0), (300, 200)],
        np.arange(18).reshape(6, 3) * 14,
    ),
    "alpha": of_quads(
        40, 30, [(0, 0), (0, 30), (40, 0), (40, 30)], np.arange(16).reshape(4, 4) * 16
    ),
}
STYLES: dict[str, dict[str, Any]] = {
    "gradient": {},
    "merged": {"merge": 1e3},
    "exact": {"mode": "exact"},
    "auto": {"mode": "auto"},
    "flat": {"mode": "flat"},
    "trapping": {"mode": "exact", "seams": "trapping"},
}
VOCABULARY = etree.RelaxNG(etree.parse(Path(__file__).with_name("svg-vocabulary.rng")))


@pytest.mark.parametrize("style", STYLES)
@pytest.mark.parametrize("name", EXTREMES)
def test_extreme_meshes_are_drawn_in_every_style(name: str, style: str, tmp_path: Path) -> None:
    mesh = EXTREMES[name]
    path = tmp_path / "extreme.svg"
    vmesh.export(mesh, path, **STYLES[style])
    VOCABULARY.assertValid(etree.parse(path))
    scale = 1 if mesh.width > 10_000 else 4
    drawn = SVG_RENDERERS["resvg"](path, scale)
    if STYLES[style].get("mode") in ("exact", "auto"):
        assert compare(drawn, mesh, scale).inside <= 4.5
    assert drawn.shape == (scale * mesh.height, scale * mesh.width, 3)


def test_a_document_with_all_that_it_may_hold_keeps_to_the_vocabulary(
    drawings: dict[Mode, Path], tmp_path: Path
) -> None:
    for path in drawings.values():
        VOCABULARY.assertValid(etree.parse(path))
    exif = Image.Exif()
    exif[270], exif[315] = "title", "author"
    metadata = vmesh.Metadata(exif=exif.tobytes().removeprefix(b"Exif\0\0"), icc=b"profile")
    path = tmp_path / "all.svg"
    mesh = EXTREMES["alpha"].replaced(metadata=metadata)
    vmesh.export(mesh, path, mode="exact", width="100%")
    tree = etree.parse(path)
    VOCABULARY.assertValid(tree)
    tree.getroot()[-1].set("colour", "red")
    assert not VOCABULARY.validate(tree)
