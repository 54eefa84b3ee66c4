"""`<vmesh-image>` in Chromium and in Firefox."""

from __future__ import annotations

import base64
import io
import time
from collections.abc import Iterator
from typing import Final

import numpy as np
import numpy.typing as npt
import pytest
from PIL import Image, ImageCms

import vmesh
from tests.pictures import PICTURES, share_apart
from tests.web.profiles import DISPLAY_P3, matrix_profile
from tests.web.windows import BROWSERS, Site, Window, pixels_of, settle, wait_until, window_of
from vmesh.arrays import UInt8Array
from vmesh.formats.html.document import element_script
from vmesh.mesh import Metadata
from vmesh.metrics import psnr

RED: Final = b"""<svg xmlns="http://www.w3.org/2000/svg" width="600" height="400">
<rect width="600" height="400" fill="#f00"/></svg>"""
CUP: Final = '<vmesh-image src="cup.vmesh" alt="A cup"></vmesh-image>'
WITH_FALLBACK: Final = (
    '<vmesh-image src="cup.vmesh" alt="A cup"><img src="red.svg" alt="A red cup"></vmesh-image>'
)


@pytest.fixture(scope="module", params=BROWSERS)
def window(request: pytest.FixtureRequest) -> Iterator[Window]:
    with window_of(request.param) as opened:
        opened.resize(700, 600)
        yield opened


@pytest.fixture(scope="module")
def mesh(coffee: UInt8Array) -> vmesh.Mesh:
    return vmesh.encode(coffee, vertices=3000, effort=2)


@pytest.fixture
def site(window: Window, mesh: vmesh.Mesh) -> Iterator[Site]:
    """A site with the element; errors and breaches of its policy fail the test."""
    made = Site(window)
    made.files |= {
        "cup.vmesh": vmesh.dumps(mesh),
        "red.svg": RED,
        "vmesh-image.js": element_script().encode(),
    }
    try:
        yield made
        assert made.messages == []
    finally:
        made.close()


def check_pixels(shown: UInt8Array, expected: npt.ArrayLike) -> None:
    """Check that a page shows the pixels of our raster, but for rounding at edges."""
    assert share_apart(shown, expected) < 0.001


def check_half(site: Site, shown: UInt8Array, mesh: vmesh.Mesh) -> None:
    """Check that a page shows a mesh at half its size; without WebGL the browser reduces it."""
    expected = np.asarray(vmesh.render(mesh, scale=0.5))
    if site.window.evaluate("!!document.createElement('canvas').getContext('webgl2')"):
        check_pixels(shown, expected)
    else:
        assert psnr(shown, expected) > 35


def box_of(site: Site, selector: str = "vmesh-image") -> list[float]:
    """Left, top, width and height of an element."""
    found: list[float] = site.window.evaluate(
        f"(({{ x, y, width, height }}) => [x, y, width, height])"
        f"(document.querySelector('{selector}').getBoundingClientRect())"
    )
    return found


def test_the_element_shows_a_file_at_its_size(site: Site, mesh: vmesh.Mesh) -> None:
    site.open(CUP)
    assert site.wait_for(1) == ["load"]
    check_pixels(pixels_of(site.window), vmesh.render(mesh))


def test_the_element_takes_a_data_uri(site: Site, mesh: vmesh.Mesh) -> None:
    source = "data:image/vnd.vmesh;base64," + base64.b64encode(vmesh.dumps(mesh)).decode()
    site.open(f'<vmesh-image src="{source}" style="width: 300px"></vmesh-image>')
    assert site.wait_for(1) == ["load"]
    check_half(site, pixels_of(site.window), mesh)


@pytest.mark.parametrize(
    ("fit", "size"),
    [("contain", (600, 400)), ("cover", (900, 600)), ("fill", (600, 600)), ("none", (600, 400))],
)
def test_the_element_follows_object_fit(
    site: Site, mesh: vmesh.Mesh, fit: str, size: tuple[int, int]
) -> None:
    style = f"width: 600px; height: 600px; object-fit: {fit}"
    site.open(f'<vmesh-image src="cup.vmesh" style="{style}"></vmesh-image>')
    site.wait_for(1)
    expected = np.full((600, 600, 3), 255, dtype=np.uint8)
    picture = np.asarray(vmesh.render(mesh, width=size[0], height=size[1]))
    across, down = (size[0] - 600) // 2, (600 - size[1]) // 2
    expected[down : down + size[1]] = picture[:, across : across + 600]
    check_pixels(pixels_of(site.window), expected)


# --- what readers of the page are told ----------------------------------------------------------


def test_a_screen_reader_is_told_of_an_image_and_its_alternative_text(site: Site) -> None:
    site.open(WITH_FALLBACK)
    site.wait_for(1)
    role, name = site.window.role_and_name("vmesh-image")
    assert (role in ("img", "image"), name) == (True, "A cup")


def test_an_image_without_meaning_is_hidden_from_screen_readers(site: Site) -> None:
    site.open('<vmesh-image src="cup.vmesh" alt=""></vmesh-image>')
    site.wait_for(1)
    role, name = site.window.role_and_name("vmesh-image")
    assert (role in ("img", "image"), name) == (False, "")


def test_the_alternative_text_takes_the_place_of_a_damaged_file(site: Site) -> None:
    site.files["cup.vmesh"] = site.files["cup.vmesh"][:-1]
    site.open('<vmesh-image src="cup.vmesh" alt="A cup">\n</vmesh-image>')
    assert site.wait_for(1) == ["error"]
    shown = "document.querySelector('vmesh-image').shadowRoot.querySelector('span').textContent"
    assert site.window.evaluate(shown) == "A cup"
    site.window.evaluate("document.querySelector('vmesh-image').alt = 'A mug'")
    assert site.window.evaluate(shown) == "A mug"


# --- what is in the element ---------------------------------------------------------------------


def check_red(site: Site, selector: str = "vmesh-image") -> None:
    """Check that nothing but red is shown; a browser may paint a picture after it is loaded."""
    end = time.monotonic() + 10
    while not (pixels_of(site.window, selector) == (255, 0, 0)).all():
        assert time.monotonic() < end, "never all red"


def test_what_is_in_the_element_is_shown_until_the_file_is_there(
    site: Site, mesh: vmesh.Mesh
) -> None:
    site.hold("cup.vmesh")
    site.open(WITH_FALLBACK)
    wait_until(site.window, "document.querySelector('img').complete")
    assert box_of(site) == [0, 0, 600, 400]
    check_red(site)
    site.release("cup.vmesh")
    assert site.wait_for(1) == ["load"]
    check_pixels(pixels_of(site.window), vmesh.render(mesh))


@pytest.mark.parametrize("content", [None, b"", b"<!doctype html>Not found", b"\x8bVM\r\n"])
def test_what_is_in_the_element_is_shown_where_the_file_fails(
    site: Site, content: bytes | None
) -> None:
    del site.files["cup.vmesh"]
    if content is not None:
        site.files["cup.vmesh"] = content
    site.open(WITH_FALLBACK)
    assert site.wait_for(1) == ["error"]
    wait_until(site.window, "document.querySelector('img').complete")
    check_red(site)


def test_what_is_in_the_element_is_shown_without_the_script(site: Site) -> None:
    site.open(WITH_FALLBACK, head="")
    wait_until(site.window, "document.querySelector('img').complete")
    check_red(site, "img")


def test_what_is_in_the_element_fills_its_box_as_the_picture_will(site: Site) -> None:
    site.hold("cup.vmesh")
    body = WITH_FALLBACK.replace(" alt", ' width="300" height="300" alt', 1)
    site.open(body + "<style>vmesh-image { object-fit: cover }</style>")
    wait_until(site.window, "document.querySelector('img').complete")
    assert box_of(site, "img") == [0, 0, 300, 300]
    check_red(site)


# --- the box ------------------------------------------------------------------------------------


@pytest.mark.parametrize("inside", ["", '<img src="red.svg" alt="A red cup">'])
def test_attributes_keep_the_place_of_the_picture(
    site: Site, mesh: vmesh.Mesh, inside: str
) -> None:
    site.hold("cup.vmesh")
    element = f'<vmesh-image src="cup.vmesh" width="300" height="200">{inside}</vmesh-image>'
    site.open(f'{element}<p id="below">Text below</p>')
    settle(site.window)
    box, below = box_of(site), box_of(site, "#below")
    assert box == [0, 0, 300, 200]
    site.release("cup.vmesh")
    assert site.wait_for(1) == ["load"]
    check_half(site, pixels_of(site.window), mesh)
    assert box_of(site) == box
    assert box_of(site, "#below") == below
    assert site.window.evaluate("shift") == 0


@pytest.mark.parametrize(
    ("attributes", "style", "before", "after"),
    [
        ('width="300"', "", None, [300, 200]),
        ('height="100"', "", None, [150, 100]),
        ('width="50%" height="100"', "", [350, 100], [350, 100]),
        ('width="900" height="600"', "max-width: 100%; height: auto", [700, 700 / 1.5], None),
        ('width="300" height="200"', "width: 100%; height: auto", [700, 700 / 1.5], None),
        ('width="300" height="300"', "height: auto", [300, 300], [300, 200]),
        ('width="300" height="200"', "width: 90px; height: 80px", [90, 80], [90, 80]),
        ("", "aspect-ratio: 2; width: 300px", [300, 150], [300, 150]),
        ('width="-5" height="red; color: red"', "", None, [600, 400]),
        ("hidden", "", [0, 0], [0, 0]),
    ],
)
def test_the_box_is_that_of_an_image(
    site: Site,
    attributes: str,
    style: str,
    before: list[float] | None,
    after: list[float] | None,
) -> None:
    site.files["own.css"] = f"vmesh-image {{ {style} }}".encode()
    site.hold("cup.vmesh")
    link = '<link rel="stylesheet" href="own.css">'
    site.open(f'{link}<vmesh-image src="cup.vmesh" {attributes}></vmesh-image>')
    settle(site.window)
    if before is not None:
        assert box_of(site)[2:] == pytest.approx(before, abs=0.1)
    site.release("cup.vmesh")
    assert site.wait_for(1) == ["load"]
    assert box_of(site)[2:] == pytest.approx(after or before, abs=0.1)


# --- pages of all kinds -------------------------------------------------------------------------


def test_a_strict_policy_allows_the_element(site: Site, mesh: vmesh.Mesh) -> None:
    site.policy = (
        "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; "
        "img-src 'self'; require-trusted-types-for 'script'"
    )
    site.open(WITH_FALLBACK.replace(" alt", ' width="300" height="200" alt', 1))
    assert site.wait_for(1) == ["load"]
    check_half(site, pixels_of(site.window), mesh)


def test_the_script_may_run_twice(site: Site, mesh: vmesh.Mesh) -> None:
    site.files["again.js"] = site.files["vmesh-image.js"]
    script = '<script src="vmesh-image.js"></script>'
    again = '<script type="module" src="again.js"></script>'
    site.open(CUP, head=f"{script}{script}{again}")
    assert site.wait_for(1) == ["load"]
    check_pixels(pixels_of(site.window), vmesh.render(mesh))


def test_more_elements_than_webgl_contexts_are_all_shown(site: Site) -> None:
    site.files["small.vmesh"] = vmesh.dumps(vmesh.encode(PICTURES["ramp"], vertices=9))
    site.open('<vmesh-image src="small.vmesh"></vmesh-image>' * 30)
    assert site.wait_for(30) == ["load"] * 30
    for number in (1, 30):
        assert pixels_of(site.window, f"vmesh-image:nth-of-type({number})").std() > 30


def test_the_element_loads_another_source(site: Site) -> None:
    site.open('<vmesh-image src="data:,nothing" alt="A cup"></vmesh-image>')
    assert site.wait_for(1) == ["error"]
    site.window.evaluate("document.querySelector('vmesh-image').src = 'cup.vmesh'")
    assert site.wait_for(2) == ["error", "load"]


def test_a_source_that_failed_may_be_tried_again(site: Site) -> None:
    found = site.files.pop("cup.vmesh")
    site.open(CUP)
    assert site.wait_for(1) == ["error"]
    site.files["cup.vmesh"] = found
    site.window.evaluate("document.querySelector('vmesh-image').src = 'cup.vmesh'")
    assert site.wait_for(2) == ["error", "load"]


def test_the_last_of_two_sources_is_shown(site: Site, mesh: vmesh.Mesh) -> None:
    site.files["slow.vmesh"] = vmesh.dumps(vmesh.encode(PICTURES["ramp"], vertices=9))
    site.hold("slow.vmesh")
    site.open('<vmesh-image src="slow.vmesh"></vmesh-image>')
    site.window.evaluate("document.querySelector('vmesh-image').src = 'cup.vmesh'")
    assert site.wait_for(1) == ["load"]
    site.release("slow.vmesh")
    settle(site.window)
    check_pixels(pixels_of(site.window), vmesh.render(mesh))
    assert site.window.evaluate("events.length") == 1


def test_an_element_without_its_source_shows_what_is_in_it(site: Site) -> None:
    site.open(WITH_FALLBACK)
    site.wait_for(1)
    site.window.evaluate("document.querySelector('vmesh-image').removeAttribute('src')")
    check_red(site)


def test_an_element_that_is_taken_out_and_put_back_shows_its_picture(
    site: Site, mesh: vmesh.Mesh
) -> None:
    site.open(f"{CUP}<main></main>")
    site.wait_for(1)
    site.window.evaluate(
        """(() => {
        window.element = document.querySelector("vmesh-image");
        element.remove();
        const main = document.querySelector("main");
        main.append(element);
        main.append(element.cloneNode(true));
        })()"""
    )
    assert site.wait_for(2) == ["load", "load"]
    for number in (1, 2):
        selector = f"vmesh-image:nth-of-type({number})"
        check_pixels(pixels_of(site.window, selector), vmesh.render(mesh))


def test_an_element_made_by_a_script_shows_its_picture(site: Site, mesh: vmesh.Mesh) -> None:
    site.open("")
    site.window.evaluate(
        """(() => {
        const element = document.createElement("vmesh-image");
        element.addEventListener("load", () => events.push("own"));
        Object.assign(element, { src: "cup.vmesh", alt: "A cup" });
        document.body.append(element);
        })()"""
    )
    assert sorted(site.wait_for(2)) == ["load", "own"]
    check_pixels(pixels_of(site.window), vmesh.render(mesh))


def test_properties_set_before_the_script_has_run_are_kept(site: Site) -> None:
    site.open('<vmesh-image></vmesh-image><script src="later.js" defer></script>', head="")
    site.window.evaluate("document.querySelector('vmesh-image').src = 'cup.vmesh'")
    site.window.evaluate(
        """(() => {
        const script = document.createElement("script");
        script.src = "vmesh-image.js";
        document.head.append(script);
        })()"""
    )
    assert site.wait_for(1) == ["load"]


def test_a_lazy_element_waits_until_it_comes_into_sight(site: Site) -> None:
    lazy = '<vmesh-image loading="lazy" src="cup.vmesh"></vmesh-image>'
    site.open(f'<div style="height: 9000px"></div>{lazy}')
    settle(site.window)
    assert "cup.vmesh" not in site.asked
    site.window.evaluate("scrollTo(0, 9000)")
    assert site.wait_for(1) == ["load"]


# --- colours ------------------------------------------------------------------------------------


def test_a_picture_of_a_wide_gamut_is_shown_in_the_colours_of_the_screen(site: Site) -> None:
    """Compared with littleCMS, pixel by pixel."""
    y, x = np.mgrid[0:120, 0:160]
    photograph = np.stack([90 + x // 2, 160 - y // 2, 100 + (x + y) // 4], axis=2).astype(np.uint8)
    profile = matrix_profile(DISPLAY_P3)
    mesh = vmesh.encode(photograph, vertices=400, effort=2).replaced(metadata=Metadata(icc=profile))
    site.files["cup.vmesh"] = vmesh.dumps(mesh)
    site.open(CUP)
    assert site.wait_for(1) == ["load"]
    shown = pixels_of(site.window).astype(int)
    drawn = np.asarray(vmesh.render(mesh))
    expected = ImageCms.profileToProfile(
        Image.fromarray(drawn),
        ImageCms.ImageCmsProfile(io.BytesIO(profile)),
        ImageCms.createProfile("sRGB"),
        renderingIntent=ImageCms.Intent.RELATIVE_COLORIMETRIC,
    )
    # The raster that littleCMS is given, and what it makes of it, are rounded to 8 bits.
    assert (np.abs(shown - np.asarray(expected)) > 2).mean() < 0.001
    assert np.abs(shown - drawn).max() > 8
