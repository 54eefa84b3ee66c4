"""Reports in a browser; test_page.py has what needs none."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import vmesh
from tests.formats.browser import NO_WEBGL, pixels_of, playwright, running, settle, wait_until
from tests.pictures import PICTURES, psnr
from tests.report.studies import study_of
from vmesh.arrays import UInt8Array
from vmesh.formats.picture.conversion import flatten
from vmesh.report.page import page_of, section_of
from vmesh.report.study import Study

WIDTH, HEIGHT = 300, 200
NO_HANDLE = ".stage::before, .stage::after { display: none !important }"


@pytest.fixture(scope="module")
def browser() -> Iterator[playwright.Browser]:
    with running() as started:
        yield started


@pytest.fixture(scope="module")
def found(coffee: UInt8Array) -> Study:
    pixels = np.ascontiguousarray(coffee[100 : 100 + HEIGHT, 150 : 150 + WIDTH])
    return study_of(pixels, vertices=300)


@pytest.fixture(scope="module")
def file(found: Study, tmp_path_factory: pytest.TempPathFactory) -> str:
    """Where a report of one photograph is."""
    path = tmp_path_factory.mktemp("report") / "page.html"
    path.write_bytes(page_of([section_of(found, 0)]))
    return path.as_uri()


@pytest.fixture
def page(browser: playwright.Browser) -> Iterator[playwright.Page]:
    """A page with a touch screen; a message in its console or a request fails the test."""
    context = browser.new_context(viewport={"width": 800, "height": 900}, has_touch=True)
    page = context.new_page()
    page.set_default_timeout(5000)
    messages: list[str] = []
    page.on("console", lambda message: messages.append(message.text))
    page.on("pageerror", lambda error: messages.append(str(error)))
    page.on("request", lambda request: messages.append(request.url[:80]))
    yield page
    context.close()
    assert [text for text in messages if not text.startswith(("file:", "data:"))] == []


def show(page: playwright.Page, file: str) -> playwright.Locator:
    """Open a report without the handle of its divider, and wait for its stage."""
    page.goto(file)
    page.add_style_tag(content=NO_HANDLE)
    settle(page)
    return page.locator(".stage").first


def divide(page: playwright.Page, key: str) -> None:
    """Move the divider with a key."""
    page.get_by_role("slider").first.press(key)


def box_of(stage: playwright.Locator) -> playwright.FloatRect:
    """Where a stage is on the screen."""
    box = stage.bounding_box()
    assert box is not None
    return box


def check_divided(stage: playwright.Locator, found: Study, column: int) -> None:
    """The photograph is on the left of a column, on the right the mesh."""
    shown, mesh = pixels_of(stage), np.asarray(vmesh.render(found.mesh))
    near = 3  # the thumb of a slider may be a little aside of the pointer
    left, right = slice(0, column - near), slice(column + near, WIDTH)
    assert np.array_equal(shown[:, left], found.original[:, left])
    assert psnr(shown[:, right], mesh[:, right]) > 45


def test_the_ends_of_the_divider_show_the_mesh_and_the_photograph(
    page: playwright.Page, file: str, found: Study
) -> None:
    stage = show(page, file)
    divide(page, "Home")
    assert psnr(pixels_of(stage), np.asarray(vmesh.render(found.mesh))) > 45
    divide(page, "End")
    assert np.array_equal(pixels_of(stage), found.original)


def test_without_webgl_the_mesh_is_the_exact_raster(
    page: playwright.Page, file: str, found: Study
) -> None:
    page.add_init_script(NO_WEBGL)
    stage = show(page, file)
    divide(page, "Home")
    assert np.array_equal(pixels_of(stage), vmesh.render(found.mesh))


def test_the_divider_starts_in_the_middle_and_moves_by_keys(
    page: playwright.Page, file: str, found: Study
) -> None:
    stage = show(page, file)
    check_divided(stage, found, WIDTH // 2)
    for _ in range(5):
        divide(page, "ArrowRight")
    place = float(page.get_by_role("slider").input_value())
    assert place > 50
    check_divided(stage, found, round(WIDTH * place / 100))


def test_the_mouse_drags_the_divider(page: playwright.Page, file: str, found: Study) -> None:
    stage = show(page, file)
    box = box_of(stage)
    page.mouse.move(box["x"] + WIDTH / 2, box["y"] + 50)
    page.mouse.down()
    for column in (120, 90, 60):
        page.mouse.move(box["x"] + column, box["y"] + 80)
    page.mouse.up()
    check_divided(stage, found, 60)


def test_a_finger_drags_the_divider(page: playwright.Page, file: str, found: Study) -> None:
    stage = show(page, file)
    box = box_of(stage)
    touch = page.context.new_cdp_session(page)

    def finger(kind: str, *columns: int) -> None:
        points = [{"x": box["x"] + column, "y": box["y"] + 100} for column in columns]
        touch.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    finger("touchStart", 150)
    for column in (180, 210, 240):
        finger("touchMove", column)
    finger("touchEnd")
    wait_until(page, "document.querySelector('input').value > 75")
    check_divided(stage, found, 240)


def test_the_wireframe_is_drawn_and_taken_away(
    page: playwright.Page, file: str, found: Study
) -> None:
    stage, button = show(page, file), page.get_by_role("button", name="Wireframe")
    divide(page, "Home")
    plain = pixels_of(stage)
    button.click()
    assert button.get_attribute("aria-pressed") == "true"
    changed = (pixels_of(stage) != plain).any(axis=2)
    corners = np.floor(found.mesh.points).astype(int).clip(0, [WIDTH - 1, HEIGHT - 1])
    assert changed[corners[:, 1], corners[:, 0]].mean() > 0.7
    assert not changed.all()
    button.click()
    assert button.get_attribute("aria-pressed") == "false"
    assert np.array_equal(pixels_of(stage), plain)


def test_a_narrow_window_holds_the_page(page: playwright.Page, file: str) -> None:
    page.set_viewport_size({"width": 320, "height": 700})
    stage = show(page, file)
    assert box_of(stage)["width"] == 288
    assert page.evaluate("document.documentElement.scrollWidth") == 320


@pytest.mark.parametrize("name", ["disc", "grey noise", "one pixel"])
def test_several_pictures_are_shown_each_by_itself(
    page: playwright.Page, tmp_path: Path, found: Study, name: str
) -> None:
    path = tmp_path / "page.html"
    small = study_of(PICTURES[name])
    path.write_bytes(page_of([section_of(found, 0), section_of(small, 1)]))
    stage = show(page, path.as_uri())
    divide(page, "Home")
    assert psnr(pixels_of(stage), np.asarray(vmesh.render(found.mesh))) > 45
    last = page.locator(".stage").last
    page.get_by_role("slider").last.press("Home")
    size = (round(box_of(last)["width"]), round(box_of(last)["height"]))
    enlarged = vmesh.render(small.mesh, width=size[0], height=size[1])
    assert psnr(pixels_of(last), flatten(enlarged)) > 40
