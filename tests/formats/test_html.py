"""Pages and the element in a browser; test_bundle.py has what needs none."""

from __future__ import annotations

import base64
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import vmesh
from tests.formats.browser import NO_WEBGL, pixels_of, playwright, running, settle, wait_until
from tests.pictures import PICTURES, share_apart
from vmesh.arrays import UInt8Array
from vmesh.formats.html.document import element_script, page_of
from vmesh.formats.picture.conversion import flatten

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


class Site:
    """Pages with the element on them, and files beside them."""

    def __init__(self, page: playwright.Page) -> None:
        self.page = page
        self.asked: list[str] = []
        self.files: dict[str, bytes] = {"vmesh-image.js": element_script().encode()}
        page.route("http://site.test/**", self._answer)

    def _answer(self, route: Any) -> None:
        name = route.request.url.rsplit("/", 1)[1]
        self.asked.append(name)
        kind = "text/html" if name == "page" else "text/javascript"
        found = name in self.files
        route.fulfill(
            status=200 if found else 404, body=self.files.get(name, b""), content_type=kind
        )

    def open(self, body: str) -> None:
        """Open a page; what happens to its elements is noted in `events`."""
        note = """const events = [];
        for (const type of ["load", "error"]) document.addEventListener(type, (event) => {
          if (event.target.localName === "vmesh-image") events.push(type);
        }, true);"""
        head = f'<!doctype html><script>{note}</script><script src="vmesh-image.js"></script>'
        self.files["page"] = f"{head}<body style='margin: 0'>{body}".encode()
        self.page.goto("http://site.test/page")

    def wait_for(self, n_events: int) -> list[str]:
        """Events of the elements, once there are so many."""
        wait_until(self.page, f"events.length >= {n_events}")
        events: list[str] = self.page.evaluate("events")
        return events


@pytest.fixture
def site(page: playwright.Page, mesh: vmesh.Mesh) -> Site:
    made = Site(page)
    made.files["cup.vmesh"] = vmesh.dumps(mesh)
    return made


def test_the_element_shows_a_file_at_its_size(site: Site, mesh: vmesh.Mesh) -> None:
    site.open('<vmesh-image src="cup.vmesh" alt="A cup"></vmesh-image>')
    assert site.wait_for(1) == ["load"]
    shown = pixels_of(site.page.locator("vmesh-image"))
    check_pixels(shown, vmesh.render(mesh))
    # Playwright knows no roles but those in attributes: the browser itself is asked.
    tree = site.page.context.new_cdp_session(site.page).send("Accessibility.getFullAXTree")
    named = [node for node in tree["nodes"] if node.get("name", {}).get("value") == "A cup"]
    assert "image" in [node["role"]["value"] for node in named]


def test_the_element_takes_a_data_uri(site: Site, mesh: vmesh.Mesh) -> None:
    source = "data:image/vnd.vmesh;base64," + base64.b64encode(vmesh.dumps(mesh)).decode()
    site.open(f'<vmesh-image src="{source}" style="width: 300px"></vmesh-image>')
    assert site.wait_for(1) == ["load"]
    shown = pixels_of(site.page.locator("vmesh-image"))
    check_pixels(shown, vmesh.render(mesh, scale=0.5))


@pytest.mark.parametrize(
    ("fit", "size"),
    [("contain", (300, 200)), ("cover", (600, 400)), ("fill", (300, 400)), ("none", (600, 400))],
)
def test_the_element_follows_object_fit(
    site: Site, mesh: vmesh.Mesh, fit: str, size: tuple[int, int]
) -> None:
    style = f"width: 300px; height: 400px; object-fit: {fit}"
    site.open(f'<vmesh-image src="cup.vmesh" style="{style}"></vmesh-image>')
    site.wait_for(1)
    shown = pixels_of(site.page.locator("vmesh-image"))
    expected = np.full((400, 300, 3), 255, dtype=np.uint8)
    picture = np.asarray(vmesh.render(mesh, width=size[0], height=size[1]))
    across, down = (600 - 300) // 2 if size[0] == 600 else 0, (400 - size[1]) // 2
    expected[down : down + size[1]] = picture[:, across : across + 300]
    check_pixels(shown, expected)


def test_the_element_shows_its_alternative_text_in_place_of_a_damaged_file(site: Site) -> None:
    site.files["cup.vmesh"] = site.files["cup.vmesh"][:-1]
    site.open('<vmesh-image src="cup.vmesh" alt="A cup"></vmesh-image>')
    assert site.wait_for(1) == ["error"]
    assert site.page.locator("vmesh-image span").inner_text() == "A cup"


def test_the_element_loads_another_source(site: Site) -> None:
    site.open('<vmesh-image src="data:,nothing" alt="A cup"></vmesh-image>')
    assert site.wait_for(1) == ["error"]
    site.page.evaluate("document.querySelector('vmesh-image').src = 'cup.vmesh'")
    assert site.wait_for(2) == ["error", "load"]


def test_a_lazy_element_waits_until_it_comes_into_sight(site: Site) -> None:
    lazy = '<vmesh-image loading="lazy" src="cup.vmesh"></vmesh-image>'
    site.open(f'<div style="height: 9000px"></div>{lazy}')
    settle(site.page)
    assert "cup.vmesh" not in site.asked
    site.page.evaluate("scrollTo(0, 9000)")
    assert site.wait_for(1) == ["load"]


def test_more_elements_than_webgl_contexts_are_all_shown(site: Site) -> None:
    site.files["small.vmesh"] = vmesh.dumps(vmesh.encode(PICTURES["ramp"], vertices=9))
    site.open('<vmesh-image src="small.vmesh"></vmesh-image>' * 30)
    assert site.wait_for(30) == ["load"] * 30
    for element in site.page.locator("vmesh-image").all()[::29]:
        assert pixels_of(element).std() > 30
