"""Pictures that are no photographs, drawn from numbers alone: the same on every run."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np
from PIL import Image, ImageDraw, ImageFont
from scipy.ndimage import gaussian_filter

from benchmarks.photographs import Photograph
from vmesh.arrays import Float64Array, UInt8Array

WIDTH: Final = 768
HEIGHT: Final = 512

_OVERSAMPLING: Final = 4  # shapes are drawn this much larger: their edges come out smooth
_TEXT: Final = (
    "a mesh of triangles carries the colours of a picture at its corners between them every pixel "
    "takes a mixture of three where it is smooth few are enough along an edge they gather what is "
    "stored is where corners lie and which colours they have all else follows and costs nothing"
)
_MANY_WORDS: Final = 1000  # more than any text here shows
# Shepp and Logan's head as Toft changed it: value, half axes, centre, and degrees of turn.
_ELLIPSES: Final = (
    (1.0, 0.69, 0.92, 0.0, 0.0, 0),
    (-0.8, 0.6624, 0.874, 0.0, -0.0184, 0),
    (-0.2, 0.11, 0.31, 0.22, 0.0, -18),
    (-0.2, 0.16, 0.41, -0.22, 0.0, 18),
    (0.1, 0.21, 0.25, 0.0, 0.35, 0),
    (0.1, 0.046, 0.046, 0.0, 0.1, 0),
    (0.1, 0.046, 0.046, 0.0, -0.1, 0),
    (0.1, 0.046, 0.023, -0.08, -0.605, 0),
    (0.1, 0.023, 0.023, 0.0, -0.606, 0),
    (0.1, 0.023, 0.046, 0.06, -0.605, 0),
)
_PHANTOM_GAIN: Final = 200
_PHANTOM_NOISE: Final = 4.0  # standard deviation, of 255
_PHANTOM_BLUR: Final = 0.8  # pixels


def synthetic_pictures() -> list[Photograph]:
    """All of the pictures, each WIDTH x HEIGHT pixels."""
    drawings: dict[str, Callable[[], UInt8Array]] = {
        "gradient": draw_gradient,
        "cartoon": draw_cartoon,
        "screenshot": draw_screenshot,
        "CT phantom": draw_phantom,
        "map": draw_map,
        "page of text": draw_page,
    }
    return [Photograph(name, draw()) for name, draw in drawings.items()]


def draw_gradient() -> UInt8Array:
    """Colours that go over into one another, and a soft light."""
    y, x = np.mgrid[0 : 1 : HEIGHT * 1j, 0 : 1 : WIDTH * 1j][..., None]
    corners = np.array([(20, 30, 90), (230, 120, 60), (40, 150, 140), (250, 220, 160)], dtype=float)
    colors = (1 - y) * ((1 - x) * corners[0] + x * corners[1])
    colors += y * ((1 - x) * corners[2] + x * corners[3])
    light = 60 * np.exp(-((x - 0.65) ** 2 + (y - 0.4) ** 2) / 0.04)
    return _rounded(colors + light)


def draw_cartoon() -> UInt8Array:
    """Flat areas with sharp edges and outlines: hills, a house, a sun and a tree."""
    image, draw = _oversampled((126, 200, 240))
    outline, line = (30, 30, 40), 3 * _OVERSAMPLING
    _ellipse(draw, (600, 40, 710, 150), (255, 214, 60), outline, line)
    for left, right, top, color in (
        (-200, 420, 250, (84, 170, 90)),
        (250, 1000, 290, (60, 140, 76)),
    ):
        _ellipse(draw, (left, top, right, top + 700), color, outline, line)
    _polygon(draw, [(150, 430), (150, 290), (330, 290), (330, 430)], (240, 226, 200), outline)
    _polygon(draw, [(130, 295), (240, 190), (350, 295)], (190, 60, 50), outline)
    _polygon(draw, [(215, 430), (215, 350), (262, 350), (262, 430)], (110, 70, 50), outline)
    for left in (168, 280):
        _polygon(
            draw,
            [(left, 310), (left + 34, 310), (left + 34, 344), (left, 344)],
            (250, 250, 210),
            outline,
        )
    _polygon(draw, [(538, 450), (548, 320), (568, 320), (578, 450)], (120, 80, 50), outline)
    for x, y, radius in ((558, 250, 80), (505, 290, 50), (612, 285, 55)):
        _ellipse(
            draw, (x - radius, y - radius, x + radius, y + radius), (40, 120, 50), outline, line
        )
    for x, y in ((90, 80), (330, 110), (470, 60)):
        for shift, radius in ((-34, 22), (0, 32), (36, 24)):
            box = (x + shift - radius, y - radius, x + shift + radius, y + radius)
            _ellipse(draw, box, (250, 250, 252), None, 0)
    return _reduced(image)


def draw_screenshot() -> UInt8Array:
    """A desktop with two windows, text, buttons and icons; no edge is smoothed but the text's."""
    image = Image.new("RGB", (WIDTH, HEIGHT), (46, 82, 110))
    draw = ImageDraw.Draw(image)
    small, large = ImageFont.load_default(11), ImageFont.load_default(14)
    for row in range(5):
        y = 14 + 76 * row
        draw.rectangle((18, y, 57, y + 39), fill=(236, 196 - 30 * row, 60 + 36 * row))
        draw.ellipse((28, y + 10, 47, y + 29), fill=(250, 250, 250))
        draw.text((16, y + 44), f"Folder {row + 1}", font=small, fill=(255, 255, 255))
    for left, top, right, bottom, title in (
        (96, 30, 560, 400, "Notes"),
        (400, 180, 740, 470, "Settings"),
    ):
        draw.rectangle((left, top, right, bottom), fill=(246, 246, 246), outline=(90, 90, 90))
        draw.rectangle((left, top, right, top + 26), fill=(58, 110, 165))
        draw.text((left + 10, top + 5), title, font=large, fill=(255, 255, 255))
        draw.rectangle((right - 24, top + 5, right - 8, top + 21), fill=(220, 70, 60))
        draw.line((right - 20, top + 9, right - 12, top + 17), fill=(255, 255, 255))
        draw.line((right - 12, top + 9, right - 20, top + 17), fill=(255, 255, 255))
    for line, text in enumerate(_wrapped(small, 288, 24)):
        draw.text((106, 66 + 13 * line), text, font=small, fill=(20, 20, 20))
    for row, name in enumerate(("Quality", "Effort", "Vertices", "Scale")):
        y = 222 + 40 * row
        draw.text((416, y), name, font=small, fill=(20, 20, 20))
        draw.rectangle((490, y + 4, 700, y + 9), fill=(200, 200, 200))
        draw.rectangle((490, y + 4, 540 + 40 * row, y + 9), fill=(58, 110, 165))
        draw.ellipse((534 + 40 * row, y, 546 + 40 * row, y + 12), fill=(30, 70, 120))
    for left, name in ((560, "Cancel"), (646, "OK")):
        draw.rectangle((left, 428, left + 74, 454), fill=(226, 226, 226), outline=(120, 120, 120))
        draw.text((left + 18, 434), name, font=small, fill=(20, 20, 20))
    draw.rectangle((0, HEIGHT - 28, WIDTH, HEIGHT), fill=(24, 28, 34))
    draw.text((WIDTH - 60, HEIGHT - 22), "12:34", font=large, fill=(230, 230, 230))
    return np.array(image)


def draw_phantom() -> UInt8Array:
    """A slice of a head as a tomograph shows it, slightly blurred and with noise."""
    scale = HEIGHT / 2
    rows, columns = np.mgrid[0:HEIGHT, 0:WIDTH]
    x, y = (columns - WIDTH / 2) / scale, -(rows - HEIGHT / 2) / scale
    values = np.zeros((HEIGHT, WIDTH))
    for value, width, height, center_x, center_y, degrees in _ELLIPSES:
        cosine, sine = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
        along = (x - center_x) * cosine + (y - center_y) * sine
        across = (y - center_y) * cosine - (x - center_x) * sine
        values += value * ((along / width) ** 2 + (across / height) ** 2 <= 1)
    noise = np.random.default_rng(1).normal(0, _PHANTOM_NOISE, values.shape)
    gray = gaussian_filter(_PHANTOM_GAIN * values + 16, _PHANTOM_BLUR) + noise
    return _rounded(np.repeat(gray[..., None], 3, axis=2))


def draw_map() -> UInt8Array:
    """Water, land and heights in flat colours with contour lines, roads and names of places."""
    size = (HEIGHT * _OVERSAMPLING // 2, WIDTH * _OVERSAMPLING // 2)
    noise = np.random.default_rng(2).normal(size=size)
    heights = gaussian_filter(noise, 90) * 90 + gaussian_filter(noise, 30) * 8
    colors = np.array(
        [(150, 196, 230), (214, 232, 190), (238, 236, 200), (236, 216, 176), (216, 188, 150)],
        dtype=np.uint8,
    )
    levels = np.searchsorted(np.quantile(heights, (0.3, 0.55, 0.75, 0.9)), heights)
    picture = colors[levels]
    borders = (np.diff(levels, axis=0, append=levels[-1:]) != 0) | (
        np.diff(levels, axis=1, append=levels[:, -1:]) != 0
    )
    picture[borders] = (130, 120, 100)
    image = Image.fromarray(picture).resize((WIDTH, HEIGHT), Image.Resampling.BOX)
    large = image.resize((WIDTH * _OVERSAMPLING, HEIGHT * _OVERSAMPLING), Image.Resampling.BOX)
    draw = ImageDraw.Draw(large)
    rng = np.random.default_rng(3)
    for color, width in (((200, 60, 50), 4), ((250, 250, 250), 3), ((250, 250, 250), 3)):
        _draw_road(draw, rng, color, width)
    image = large.resize((WIDTH, HEIGHT), Image.Resampling.BOX)
    draw = ImageDraw.Draw(image)
    font = ImageFont.load_default(13)
    for name in ("Oakham", "Newbridge", "Stone Hill", "Millford", "Easton", "Lakeside"):
        x, y = int(rng.integers(30, WIDTH - 100)), int(rng.integers(20, HEIGHT - 30))
        draw.ellipse((x - 4, y - 4, x + 4, y + 4), fill=(255, 255, 255), outline=(20, 20, 20))
        draw.text((x + 8, y - 8), name, font=font, fill=(20, 20, 20))
    return np.array(image)


def draw_page() -> UInt8Array:
    """A page of black text on white under a heading."""
    image = Image.new("RGB", (WIDTH, HEIGHT), (255, 255, 255))
    draw = ImageDraw.Draw(image)
    draw.text((48, 30), "On meshes", font=ImageFont.load_default(28), fill=(0, 0, 0))
    font = ImageFont.load_default(13)
    for line, text in enumerate(_wrapped(font, WIDTH - 96, 23)):
        draw.text((48, 82 + 17 * line), text, font=font, fill=(0, 0, 0))
    return np.array(image)


def _rounded(values: Float64Array) -> UInt8Array:
    return np.clip(np.rint(values), 0, 255).astype(np.uint8)


def _oversampled(color: tuple[int, int, int]) -> tuple[Image.Image, ImageDraw.ImageDraw]:
    image = Image.new("RGB", (WIDTH * _OVERSAMPLING, HEIGHT * _OVERSAMPLING), color)
    return image, ImageDraw.Draw(image)


def _reduced(image: Image.Image) -> UInt8Array:
    return np.array(image.resize((WIDTH, HEIGHT), Image.Resampling.BOX))


def _ellipse(
    draw: ImageDraw.ImageDraw,
    box: tuple[int, int, int, int],
    fill: tuple[int, int, int],
    outline: tuple[int, int, int] | None,
    line: int,
) -> None:
    draw.ellipse([_OVERSAMPLING * side for side in box], fill=fill, outline=outline, width=line)


def _polygon(
    draw: ImageDraw.ImageDraw,
    corners: list[tuple[int, int]],
    fill: tuple[int, int, int],
    outline: tuple[int, int, int],
) -> None:
    scaled = [(_OVERSAMPLING * x, _OVERSAMPLING * y) for x, y in corners]
    draw.polygon(scaled, fill=fill, outline=outline, width=3 * _OVERSAMPLING)


def _draw_road(
    draw: ImageDraw.ImageDraw, rng: np.random.Generator, color: tuple[int, int, int], width: int
) -> None:
    """A bending line from the left side to the right one, with darker sides."""
    x = np.linspace(-10, WIDTH + 10, 200)
    bends = gaussian_filter(rng.normal(size=x.size), 14) * 320
    y = bends + rng.uniform(0.2, 0.8) * HEIGHT
    points = [
        (float(a) * _OVERSAMPLING, float(b) * _OVERSAMPLING) for a, b in zip(x, y, strict=True)
    ]
    for shade, extra in (((110, 100, 90), 2), (color, 0)):
        draw.line(points, fill=shade, width=(width + extra) * _OVERSAMPLING, joint="curve")


def _wrapped(
    font: ImageFont.FreeTypeFont | ImageFont.ImageFont, width: int, n_lines: int
) -> list[str]:
    """Lines of running text that fit a width in pixels."""
    lines: list[str] = []
    line = ""
    # In no order: lines that come again would flatter the lossless files.
    for word in np.random.default_rng(4).choice(_TEXT.split(), _MANY_WORDS):
        longer = f"{line} {word}".strip()
        if font.getlength(longer) > width:
            lines.append(line)
            line = word
        else:
            line = longer
        if len(lines) == n_lines:
            break
    return lines
