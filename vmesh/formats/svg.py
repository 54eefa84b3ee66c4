"""Mesh -> SVG: for each triangle, or region of several, one flat colour or linear gradient.

SVG knows no triangle gradient. Colours over a triangle are an affine function of the place; the
best linear gradient is `svg_regions.py`, its text `svg_gradients.py`. A single channel of colour is
drawn exactly, so that three layers, one for each channel, joined by `mix-blend-mode: screen`, show
the mesh as it is.

Seams: neighbouring anti-aliased edges would let the page shine through. Edges are crisp, and the
same to the last digit on both sides (`svg_outlines.py`). Alpha is drawn as a mask of the same make.
"""

from __future__ import annotations

import gzip
from collections.abc import Iterator
from itertools import count, islice, product
from string import ascii_letters, digits
from typing import Any, BinaryIO, Final, get_args

import numpy as np
from lxml import etree

from vmesh.arrays import Float64Array, UInt8Array
from vmesh.formats.description import Description
from vmesh.formats.raster import scaled_positions
from vmesh.formats.svg_gradients import gradient_bodies, hex_colors
from vmesh.formats.svg_layers import Layer, Mode, layers_of
from vmesh.formats.svg_regions import Moments
from vmesh.kernels.scanline import SUBPIXEL, fill, label, measure
from vmesh.limits import DEFAULT_LIMITS, Limits
from vmesh.mesh import Mesh

_NAMESPACE: Final = "http://www.w3.org/2000/svg"
_MASK: Final = "_alpha"  # names of gradients have no underscore
# Pixels by which flat triangles move up and left. A centre that lies on an edge then falls to its
# right or below it, as in our raster, whatever a program's own rule; gradients would shift too.
_FLAT_SHIFT: Final = 1 / 16
_CHUNK: Final = 1 << 12  # elements that are written at a time
_GRADIENT: Final = '<linearGradient id="{}"{}</linearGradient>'
_PATH: Final = '<path fill="{}" d="{}"/>'
_ICC_NOTE: Final = " Colours are numbers in the picture's own profile, which SVG has no place for. "


def write_svg(
    mesh: Mesh,
    stream: BinaryIO | gzip.GzipFile,
    *,
    mode: Mode = "gradient",
    tolerance: float = 4.0,
    merge: float = 0.0,
    limits: Limits = DEFAULT_LIMITS,
) -> None:
    """Write a mesh as an SVG document.

    Parameters
    ----------
    mesh : Mesh
    stream : binary file
    mode : {"gradient", "exact", "auto", "flat"}
        What fills a triangle: its best linear gradient, three gradients in layers that are
        screened, the cheapest of these that keeps within `tolerance`, or one colour.
    tolerance : float
        Largest error of a channel in mode "auto", in levels; above 0.
    merge : float
        In mode "gradient", neighbours share one gradient where that adds less than this to the
        squared error, summed over pixels and channels.
    limits : Limits
        What the mesh may ask for; the colours of flat triangles come from a raster.

    Raises
    ------
    ValueError
        If an option is none of these, or has no meaning in the mode.
    """
    limits.check_vertices(mesh.n_vertices)
    _check_options(mode, tolerance, merge)
    if mode == "flat":
        _check_work(mesh, limits)
    drawing = _Drawing(mesh, stream, mode, tolerance, merge)
    size = {"width": str(mesh.width), "height": str(mesh.height)}
    root = {"viewBox": f"0 0 {mesh.width} {mesh.height}", "version": "1.1", **size}
    colors = mesh.plain_colors
    with (
        etree.xmlfile(stream, encoding="utf-8") as document,
        document.element("svg", root, nsmap={None: _NAMESPACE}),
    ):
        _write_description(document, mesh)
        if mesh.n_components == 4:
            frame = {"maskUnits": "userSpaceOnUse", "x": "0", "y": "0", **size}
            with document.element("mask", {"id": _MASK, **frame}):
                drawing.write(document, colors[:, [3, 3, 3]])
            with document.element("g", {"mask": f"url(#{_MASK})"}):
                drawing.write(document, colors[:, :3])
        else:
            drawing.write(document, colors[:, [0, 0, 0]] if colors.shape[1] == 1 else colors)


def write_svgz(
    mesh: Mesh, stream: BinaryIO, *, limits: Limits = DEFAULT_LIMITS, **options: Any
) -> None:
    """Write a mesh as a compressed SVG document; as :func:`write_svg`."""
    # No name and no time in the gzip header: the same mesh gives the same bytes.
    with gzip.GzipFile(filename="", fileobj=stream, mode="wb", mtime=0) as compressed:
        write_svg(mesh, compressed, limits=limits, **options)


def _check_options(mode: str, tolerance: float, merge: float) -> None:
    if mode not in get_args(Mode):
        raise ValueError(f"expected mode to be one of {', '.join(get_args(Mode))}, got {mode!r}")
    if not 0 < tolerance <= 255:
        raise ValueError(f"expected a tolerance above 0, of at most 255 levels, got {tolerance}")
    if not 0 <= merge < np.inf:
        raise ValueError(f"expected a finite error of 0 or more to merge by, got {merge}")
    if merge and mode != "gradient":
        raise ValueError(f"regions are merged in mode gradient only, got mode {mode}")


def _check_work(mesh: Mesh, limits: Limits) -> None:
    """Refuse a raster for flat colours that is larger than what is allowed."""
    limits.check_pixels(mesh.width, mesh.height)
    positions = scaled_positions(mesh, (mesh.width, mesh.height))
    _, n_rows = measure(positions, mesh.triangles, mesh.height)
    limits.check_work(2 * n_rows, 2 * mesh.width * mesh.height)


def _write_description(document: etree._IncrementalFileWriter, mesh: Mesh) -> None:
    """Write what the picture's EXIF says of it."""
    known = Description.of(mesh.metadata)
    texts = {"title": known.title, "desc": ", ".join(filter(None, (known.author, known.rights)))}
    for name, text in texts.items():
        if text:
            element = etree.Element(name)
            element.text = text
            document.write(element)
    if mesh.metadata.icc:
        document.write(etree.Comment(_ICC_NOTE))


class _Drawing:
    """Writes layers of a mesh. Names of gradients are told apart over the whole document.

    What is inside of a layer is written as text, past lxml: elements made one by one took
    twice as long, and nothing in that text needs escaping.
    """

    def __init__(
        self,
        mesh: Mesh,
        stream: BinaryIO | gzip.GzipFile,
        mode: Mode,
        tolerance: float,
        merge: float,
    ) -> None:
        self._mesh = mesh
        self._stream = stream
        self._options = (mode, tolerance, merge)
        self._names = _names()

    def write(self, document: etree._IncrementalFileWriter, rgb: UInt8Array) -> None:
        """Write a group that shows colours of shape (n, 3)."""
        mesh, mode = self._mesh, self._options[0]
        moments = Moments.of_triangles(mesh, rgb.astype(np.float64))
        if mode == "flat":
            moments.means[:, 2:] = _shown_means(mesh, rgb, moments.means[:, 2:])
        moves = [f"translate({-_FLAT_SHIFT} {-_FLAT_SHIFT})"] if mode == "flat" else []
        moves += [f"scale({1 / mesh.unit:.9g})"] if mesh.unit > 1 else []
        group = {"shape-rendering": "crispEdges"}
        if moves:
            group["transform"] = " ".join(moves)
        with document.element("g", group):
            if mesh.covers_canvas:
                whole = {name: str(getattr(mesh, name) * mesh.unit) for name in ("width", "height")}
                mean = hex_colors(np.average(moments.means[:, 2:], 0, moments.weights)[None])[0]
                document.write(etree.Element("rect", {**whole, "fill": mean}))
            first, *screened = layers_of(mesh, moments, *self._options)
            self._write_layer(document, first)
            for layer in screened:
                with document.element("g", {"style": "mix-blend-mode:screen"}):
                    self._write_layer(document, layer)

    def _write_layer(self, document: etree._IncrementalFileWriter, layer: Layer) -> None:
        """Write the gradients of a layer, and its paths."""
        paints = hex_colors(layer.fits.middles)
        worth, bodies = gradient_bodies(layer, self._mesh.unit)
        names = list(islice(self._names, len(worth)))
        for region, name in zip(worth.tolist(), names, strict=True):
            paints[region] = f"url(#{name})"
        if bodies:
            with document.element("defs"):
                self._write_text(document, map(_GRADIENT.format, names, bodies))
        self._write_text(document, map(_PATH.format, paints, layer.outlines.path_data))

    def _write_text(self, document: etree._IncrementalFileWriter, elements: Iterator[str]) -> None:
        """Write elements as text, many to a line."""
        document.flush()
        while chunk := "".join(islice(elements, _CHUNK)):
            self._stream.write(chunk.encode("ascii") + b"\n")


def _names() -> Iterator[str]:
    """Names that XML allows, shorter ones first."""
    for length in count():
        for letters in product(ascii_letters, *[ascii_letters + digits] * length):
            yield "".join(letters)


def _shown_means(mesh: Mesh, rgb: UInt8Array, means: Float64Array) -> Float64Array:
    """Mean of the pixels that show each triangle at the canvas's own size, shape (m, 3).

    Crisp edges give a pixel to the triangle that holds its centre, so for small triangles this is
    closer than the mean over the triangle: by some 3 dB at 20,000 vertices on photographs. Those
    without a pixel keep that of `means`.
    """
    positions = scaled_positions(mesh, (mesh.width, mesh.height))
    raster = np.zeros((mesh.height, mesh.width, 3), dtype=np.uint8)
    fill(positions, mesh.triangles, np.ascontiguousarray(rgb), raster)
    labels = np.full((mesh.height, mesh.width), mesh.n_triangles, dtype=np.int32)
    label(positions - round(_FLAT_SHIFT * SUBPIXEL), mesh.triangles, labels)
    owners, n = labels.ravel(), mesh.n_triangles
    counts = np.bincount(owners, minlength=n)[:n, None]
    sums = [np.bincount(owners, raster[:, :, z].ravel(), minlength=n)[:n] for z in range(3)]
    return np.where(counts > 0, np.stack(sums, axis=1) / np.maximum(counts, 1), means)
