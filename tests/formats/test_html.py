"""Pages in a browser; tests/web has the element, and what needs none."""

from __future__ import annotations

import io
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from PIL import Image, ImageCms

import vmesh
from tests.formats.browser import NO_WEBGL, pixels_of, playwright, running, settle, wait_until
from tests.pictures import psnr, share_apart
from tests.web.profiles import DISPLAY_P3, matrix_profile
from vmesh.arrays import UInt8Array
from vmesh.formats.html.document import page_of
from vmesh.formats.picture.conversion import flatten
from vmesh.mesh import Metadata

BAR = 40  # rows below the stage
CONFORMING = Path(__file__).parents[2] / "spec" / "conformance" / "valid"


@pytest.fixture(scope="module")
def browser() -> Iterator[playwright.Browser]:
    with running() as started:
        yield started


@pytest.fixture(scope="module")
def mesh(coffee: UInt8Array) -> vmesh.Mesh:
    return vmesh.encode(coffee, vertices=3000, effort=2)


@pytest.fixture
def page(browser: playwright.Browser) -> Iterator[playwright.Page]:
    """A page for a picture of 600 x 400; a message in its console fails the test."""
    context = browser.new_context(viewport={"width": 600, "height": 400 + BAR})
    page = context.new_page()
    messages: list[str] = []
    page.on("console", lambda message: messages.append(message.text))
    page.on("pageerror", lambda error: messages.append(str(error)))
    yield page
    context.close()
    assert messages == []


def show(page: playwright.Page, text: str, folder: Path) -> playwright.Locator:
    """Open a page as a file, and wait for its stage."""
    path = folder / "page.html"
    path.write_text(text, "utf-8")
    page.goto(path.as_uri())
    settle(page)
    return page.locator("#stage")


def check_pixels(shown: UInt8Array, expected: npt.ArrayLike) -> None:
    """Check that a page shows the pixels of our raster.

    WebGL rounds colours on its own, and may give a centre that lies on an edge to the other side.
    """
    assert share_apart(shown, expected) < 0.001


def exported(mesh: vmesh.Mesh, folder: Path) -> str:
    vmesh.export(mesh, folder / "exported.html")
    return (folder / "exported.html").read_text("utf-8")


def test_a_page_shows_what_vmesh_renders(
    page: playwright.Page, mesh: vmesh.Mesh, tmp_path: Path
) -> None:
    stage = show(page, exported(mesh, tmp_path), tmp_path)
    assert page.evaluate("document.querySelector('canvas').getContext('webgl2') !== null")
    check_pixels(pixels_of(stage), vmesh.render(mesh))


def test_a_page_without_webgl_shows_the_exact_raster(
    page: playwright.Page, mesh: vmesh.Mesh, tmp_path: Path
) -> None:
    page.add_init_script(NO_WEBGL)
    stage = show(page, exported(mesh, tmp_path), tmp_path)
    assert np.array_equal(pixels_of(stage), vmesh.render(mesh))
    for name in ("Wireframe", "Vertices"):
        before = pixels_of(stage)
        page.get_by_role("button", name=name).click()
        assert not np.array_equal(pixels_of(stage), before)


def test_a_page_without_webgl_draws_triangles_anew_when_it_enlarges(
    page: playwright.Page, mesh: vmesh.Mesh, tmp_path: Path
) -> None:
    page.add_init_script(NO_WEBGL)
    page.set_viewport_size({"width": 1000, "height": 600 + BAR})
    stage = show(page, exported(mesh, tmp_path), tmp_path)
    enlarged = np.asarray(vmesh.render(mesh, scale=1.5))
    check_pixels(pixels_of(stage)[:, 50:950], enlarged)


@pytest.mark.parametrize(
    "name", ["grey", "12-bits-grey", "16-bits-extremes", "rgba", "one-pixel", "tiles"]
)
@pytest.mark.parametrize("has_webgl", [True, False])
def test_samples_of_all_kinds_are_shown(
    page: playwright.Page, tmp_path: Path, name: str, has_webgl: bool
) -> None:
    if not has_webgl:
        page.add_init_script(NO_WEBGL)
    mesh = vmesh.load(CONFORMING / f"{name}.vmesh")
    page.set_viewport_size({"width": max(mesh.width, 100), "height": max(mesh.height, 100) + BAR})
    stage = show(page, exported(mesh, tmp_path), tmp_path)
    page.add_style_tag(content="body { background: white !important }")
    stage.press("1")
    shown = pixels_of(stage)
    top = (shown.shape[0] - mesh.height + 1) // 2
    left = (shown.shape[1] - mesh.width + 1) // 2
    part = shown[top : top + mesh.height, left : left + mesh.width]
    check_pixels(part, flatten(vmesh.render(mesh), mesh.depth))


def test_a_dense_screen_shows_every_pixel_it_has(
    browser: playwright.Browser, mesh: vmesh.Mesh, tmp_path: Path
) -> None:
    size: playwright.ViewportSize = {"width": 600, "height": 400 + BAR}
    context = browser.new_context(viewport=size, device_scale_factor=2)
    stage = show(context.new_page(), exported(mesh, tmp_path), tmp_path)
    check_pixels(pixels_of(stage), vmesh.render(mesh, scale=2))
    context.close()


def test_a_picture_keeps_filling_its_stage(
    page: playwright.Page, mesh: vmesh.Mesh, tmp_path: Path
) -> None:
    stage = show(page, exported(mesh, tmp_path), tmp_path)
    page.set_viewport_size({"width": 300, "height": 200 + BAR})
    wait_until(page, "document.querySelector('canvas').width === 300")
    assert page.locator("#zoom").inner_text() == "50 %"
    check_pixels(pixels_of(stage), vmesh.render(mesh, scale=0.5))


@pytest.mark.parametrize("has_webgl", [True, False])
def test_the_wheel_zooms_at_the_pointer_to_64_times_without_blur(
    page: playwright.Page, coffee: UInt8Array, tmp_path: Path, has_webgl: bool
) -> None:
    if not has_webgl:
        page.add_init_script(NO_WEBGL)
    mesh = vmesh.encode(coffee[100:160, 200:290], vertices=500, effort=2)
    stage = show(page, exported(mesh, tmp_path), tmp_path)
    page.mouse.move(200, 160)
    for _ in range(20):
        page.mouse.wheel(0, -240)
    wait_until(page, "document.querySelector('#zoom').textContent === '6400 %'")
    # The picture was fitted to 600 x 400 pixels, and its point at (200, 160) has stayed there.
    left, top = 30 * 64 - 200, 24 * 64 - 160
    enlarged = np.asarray(vmesh.render(mesh, scale=64))[top : top + 400, left : left + 600]
    check_pixels(pixels_of(stage), enlarged)


def test_the_mouse_and_the_keys_move_the_picture(
    page: playwright.Page, mesh: vmesh.Mesh, tmp_path: Path
) -> None:
    stage = show(page, exported(mesh, tmp_path), tmp_path)
    picture = np.asarray(vmesh.render(mesh))
    page.mouse.move(300, 200)
    page.mouse.down()
    page.mouse.move(250, 170)
    page.mouse.up()
    check_pixels(pixels_of(stage)[:370, :550], picture[30:, 50:])
    stage.press("ArrowLeft")
    check_pixels(pixels_of(stage)[:370, 14:], picture[30:, :586])
    stage.press("+")
    wait_until(page, "document.querySelector('#zoom').textContent === '125 %'")
    stage.press("0")
    check_pixels(pixels_of(stage), picture)


def test_two_fingers_zoom(page: playwright.Page, mesh: vmesh.Mesh, tmp_path: Path) -> None:
    show(page, exported(mesh, tmp_path), tmp_path)
    touch = page.context.new_cdp_session(page)

    def fingers(kind: str, *columns: int) -> None:
        points = [{"x": x, "y": 200, "id": i} for i, x in enumerate(columns)]
        touch.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    fingers("touchStart", 250, 350)
    fingers("touchMove", 200, 400)
    fingers("touchEnd")
    wait_until(page, "document.querySelector('#zoom').textContent === '200 %'")


@pytest.mark.parametrize(("name", "key"), [("Wireframe", "w"), ("Vertices", "v")])
def test_toggles_show_the_mesh_by_mouse_and_by_key(
    page: playwright.Page, mesh: vmesh.Mesh, tmp_path: Path, name: str, key: str
) -> None:
    stage = show(page, exported(mesh, tmp_path), tmp_path)
    plain = pixels_of(stage)
    button = page.get_by_role("button", name=name)
    button.click()
    assert button.get_attribute("aria-pressed") == "true"
    marked = pixels_of(stage)
    corners = np.floor(mesh.points[:200]).astype(int).clip(0, [599, 399])
    changed = (marked != plain).any(axis=2)
    assert changed[corners[:, 1], corners[:, 0]].mean() > 0.7
    page.keyboard.press(key)
    assert np.array_equal(pixels_of(stage), plain)


def test_a_damaged_file_is_told_in_words(
    page: playwright.Page, mesh: vmesh.Mesh, tmp_path: Path
) -> None:
    show(page, page_of(vmesh.dumps(mesh)[:-1], "A cup"), tmp_path)
    failure = page.get_by_role("alert")
    assert failure.inner_text() == "A cup cannot be shown: truncated: the file ends too early"
    assert not page.locator("canvas").is_visible()


def test_a_dropped_file_takes_the_place_of_the_other(
    page: playwright.Page, mesh: vmesh.Mesh, tmp_path: Path
) -> None:
    stage = show(page, page_of(b"damaged", "A cup"), tmp_path)
    drop = """([bytes, name]) => {
        const transfer = new DataTransfer();
        transfer.items.add(new File([new Uint8Array(bytes)], name));
        dispatchEvent(new DragEvent("drop", { dataTransfer: transfer }));
    }"""
    page.evaluate(drop, [list(vmesh.dumps(mesh)), "other.vmesh"])
    page.get_by_role("img", name="other.vmesh").wait_for()
    assert not page.get_by_role("alert").is_visible()
    check_pixels(pixels_of(stage), vmesh.render(mesh))


def test_the_name_of_a_picture_is_its_alternative_text_and_the_title_of_the_page(
    page: playwright.Page, mesh: vmesh.Mesh, tmp_path: Path
) -> None:
    name = 'A "cup" of <coffee>'
    show(page, page_of(vmesh.dumps(mesh), name), tmp_path)
    assert page.get_by_role("img", name=name).is_visible()
    assert page.title() == name


@pytest.mark.parametrize("has_webgl", [True, False])
def test_a_page_shows_a_wide_gamut_in_the_colours_of_the_screen(
    page: playwright.Page, mesh: vmesh.Mesh, tmp_path: Path, has_webgl: bool
) -> None:
    if not has_webgl:
        page.add_init_script(NO_WEBGL)
    profile = matrix_profile(DISPLAY_P3)
    wide = mesh.replaced(metadata=Metadata(icc=profile))
    shown = pixels_of(show(page, page_of(vmesh.dumps(wide), "A cup"), tmp_path))
    expected = ImageCms.profileToProfile(
        Image.fromarray(np.asarray(vmesh.render(mesh))),
        ImageCms.ImageCmsProfile(io.BytesIO(profile)),
        ImageCms.createProfile("sRGB"),
        renderingIntent=ImageCms.Intent.RELATIVE_COLORIMETRIC,
    )
    assert psnr(shown, np.asarray(expected)) > psnr(shown, np.asarray(vmesh.render(mesh))) + 10
    assert psnr(shown, np.asarray(expected)) > 40
