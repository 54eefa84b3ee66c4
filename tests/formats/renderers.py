"""Programs and libraries that others wrote, which draw SVG and PDF for the tests."""

from __future__ import annotations

import io
import subprocess
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from lxml import etree
from PIL import Image

from tests.programs import need_program
from vmesh.formats.picture.conversion import flatten

Pixels = npt.NDArray[np.uint8]
Renderer = Callable[[Path, int], Pixels]


def _pixels(image: Image.Image) -> Pixels:
    """What a viewer shows: the picture on white."""
    return flatten(np.asarray(image.convert("RGBA")))


def draw_with_librsvg(path: Path, scale: int) -> Pixels:
    program = need_program("rsvg-convert", "librsvg2-bin")
    drawn = subprocess.run(
        [program, "--unlimited", "--zoom", str(scale), str(path)], check=True, capture_output=True
    )
    return _pixels(Image.open(io.BytesIO(drawn.stdout)))


def draw_with_resvg(path: Path, scale: int) -> Pixels:
    resvg_py = pytest.importorskip("resvg_py", reason="renderer resvg is missing (resvg-py)")
    drawn = resvg_py.svg_to_bytes(svg_path=str(path), zoom=scale)
    return _pixels(Image.open(io.BytesIO(bytes(drawn))))


def draw_with_chromium(path: Path, scale: int) -> Pixels:
    program = need_program("chromium", "chromium")
    width, height = drawing_size(path)
    # A headless window keeps a part of its height to itself.
    window = f"--window-size={max(width, 500)},{height + 200}"
    with tempfile.TemporaryDirectory() as folder:
        picture = Path(folder, "screenshot.png")
        options = ["--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", window]
        options += [f"--force-device-scale-factor={scale}", f"--user-data-dir={folder}/profile"]
        subprocess.run(
            [program, *options, f"--screenshot={picture}", path.resolve().as_uri()],
            check=True,
            capture_output=True,
            timeout=300,
        )
        return _pixels(Image.open(picture))[: height * scale, : width * scale]


def draw_with_cairosvg(path: Path, scale: int) -> Pixels:
    cairosvg = pytest.importorskip("cairosvg", reason="renderer CairoSVG is missing (CairoSVG)")
    drawn = cairosvg.svg2png(url=str(path), scale=scale, unsafe=True)
    return _pixels(Image.open(io.BytesIO(drawn)))


def drawing_size(path: Path) -> tuple[int, int]:
    """Width and height of an SVG document in pixels."""
    root = etree.parse(path, etree.XMLParser(huge_tree=True)).getroot()
    return int(root.get("width", "0")), int(root.get("height", "0"))


def draw_with_poppler(path: Path, scale: int) -> Pixels:
    program = need_program("pdftoppm", "poppler-utils")
    drawn = subprocess.run(
        [program, "-r", str(72 * scale), "-png", "-singlefile", str(path)],
        check=True,
        capture_output=True,
    )
    return _pixels(Image.open(io.BytesIO(drawn.stdout)))


def draw_with_mupdf(path: Path, scale: int) -> Pixels:
    pymupdf = pytest.importorskip("pymupdf", reason="renderer mupdf is missing (pymupdf)")
    with pymupdf.open(path) as document:
        page = document[0].get_pixmap(matrix=pymupdf.Matrix(scale, scale), alpha=False)
        return np.frombuffer(page.samples, np.uint8).reshape(page.h, page.w, page.n)[:, :, :3]


def draw_with_pdfium(path: Path, scale: int) -> Pixels:
    pypdfium2 = pytest.importorskip("pypdfium2", reason="renderer pdfium is missing (pypdfium2)")
    document = pypdfium2.PdfDocument(path)
    try:
        return _pixels(document[0].render(scale=scale).to_pil())
    finally:
        document.close()


def draw_with_ghostscript(path: Path, scale: int) -> Pixels:
    program = need_program("gs", "ghostscript")
    options = ["-q", "-dSAFER", "-dBATCH", "-dNOPAUSE", "-sDEVICE=png16m", "-sOutputFile=-"]
    drawn = subprocess.run(
        [program, *options, f"-r{72 * scale}", str(path)], check=True, capture_output=True
    )
    return _pixels(Image.open(io.BytesIO(drawn.stdout)))


SVG_RENDERERS: dict[str, Renderer] = {
    "librsvg": draw_with_librsvg,
    "resvg": draw_with_resvg,
    "chromium": draw_with_chromium,
    "cairosvg": draw_with_cairosvg,
}
PDF_RENDERERS: dict[str, Renderer] = {
    "poppler": draw_with_poppler,
    "mupdf": draw_with_mupdf,
    "pdfium": draw_with_pdfium,
    "ghostscript": draw_with_ghostscript,
}
