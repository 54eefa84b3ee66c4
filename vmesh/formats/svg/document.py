"""Mesh -> SVG: for each triangle, or region of several, one flat colour or linear gradient.

SVG knows no triangle gradient. Colours over a triangle are an affine function of the place; the
best linear gradient is found in `regions.py` and written in `gradients.py`. A single channel of
colour is drawn exactly, so that three layers, joined by `mix-blend-mode: lighten`, show the mesh as
it is (`parts.py`).

Seams: neighbouring anti-aliased edges would let the page shine through. Edges are crisp, and the
same to the last digit on both sides; or regions are trapped, and reach under their neighbours
(`outlines.py`). Alpha is drawn as a mask in the same manner.
"""

from __future__ import annotations

import gzip
from typing import BinaryIO, Final

import numpy as np
from lxml import etree

from vmesh.arrays import SampleArray, UInt8Array
from vmesh.formats.metadata.description import Description
from vmesh.formats.raster.rendering import scaled_positions
from vmesh.formats.svg.drawing import Drawing
from vmesh.formats.svg.ids import Ids, prefix_of
from vmesh.formats.svg.photograph import Photograph, rgba_of
from vmesh.formats.svg.size import Length, size_attributes
from vmesh.formats.svg.style import Mode, Seams, Style
from vmesh.kernels.scanline import measure
from vmesh.limits import DEFAULT_LIMITS, Limits
from vmesh.mesh import Mesh
from vmesh.progress import Progress, silent

NAMESPACE: Final = "http://www.w3.org/2000/svg"


def write_svg(
    mesh: Mesh,
    stream: BinaryIO | gzip.GzipFile,
    *,
    mode: Mode = "gradient",
    tolerance: float = 4.0,
    merge: float = 0.0,
    seams: Seams = "crisp",
    id_prefix: str | None = None,
    fit: SampleArray | None = None,
    width: Length | None = None,
    height: Length | None = None,
    progress: Progress | None = None,
    limits: Limits = DEFAULT_LIMITS,
) -> None:
    """Write a mesh as an SVG document.

    Parameters
    ----------
    mesh : Mesh
        In sRGB: a profile is passed over.
    stream : binary file
    mode : {"gradient", "exact", "auto", "flat"}
        What fills a triangle: its best linear gradient, three gradients in layers of which the
        lighter shows, the cheapest of these that keeps within `tolerance`, or one colour. Programs
        without blend modes show the last of three layers, which is about the picture.
    tolerance : float
        Largest error of a channel in mode "auto", in levels; above 0.
    merge : float
        In mode "gradient", neighbours share one gradient where that adds less than this to the
        squared error, summed over pixels and channels.
    seams : {"crisp", "trapping"}
        How seams are avoided: by edges that are not smoothed, or by regions that reach under their
        neighbours, for programs that smooth all edges. Not "trapping" in mode "auto".
    id_prefix : str, optional
        What ids begin with: a letter or _, then letters, digits, _ and -. Without it a digest of
        the drawing, so that different drawings may be put into one HTML page.
    fit : ndarray, optional
        The photograph that the mesh was made from, as :func:`vmesh.encode` takes it, in the size of
        the canvas: gradients are fitted to its pixels instead of to the mesh.
    width, height : str or float, optional
        Size at which it shows, in units of CSS such as "210mm" or "100%"; a number counts
        pixels. One of them alone keeps the proportions; without both a pixel shows as one.
    progress : callable, optional
        Called with the name of each stage as it begins: fitting, and for each layer gradients and
        paths.
    limits : Limits
        What the mesh may ask for; the colours of flat triangles come from a raster.

    Raises
    ------
    ValueError
        If an option is none of these, or has no meaning in the mode.
    """
    limits.check_vertices(mesh.n_vertices)
    style = Style(mode, tolerance, merge, seams, id_prefix)
    size = size_attributes(mesh, width, height)
    if mode == "flat" or fit is not None:
        _check_work(mesh, limits)
    root = {"viewBox": f"0 0 {mesh.width} {mesh.height}", "version": "1.1", **size}
    rgba = None if fit is None else rgba_of(mesh, fit)
    with (
        etree.xmlfile(stream, encoding="utf-8") as document,
        document.element("svg", root, nsmap={None: NAMESPACE}),
    ):
        _write_description(document, mesh)
        draw_mesh(document, stream, mesh, style, rgba, progress or silent)


def draw_mesh(
    document: etree._IncrementalFileWriter,
    stream: BinaryIO | gzip.GzipFile,
    mesh: Mesh,
    style: Style,
    rgba: UInt8Array | None = None,
    progress: Progress = silent,
) -> None:
    """Write the groups that show a mesh into an open document.

    Parameters
    ----------
    document : lxml's writer of elements
    stream : binary file
        What it writes to.
    mesh : Mesh
    style : Style
    rgba : ndarray, optional
        The photograph to fit to, shape (h, w, 4), uint8.
    progress : callable
        As of :func:`write_svg`.
    """
    colors = mesh.plain_colors
    ids = Ids(prefix_of(mesh, style, rgba))
    drawing = Drawing(mesh, stream, document, style, ids.gradients, progress)
    if mesh.n_components == 4:
        whole = {"width": str(mesh.width), "height": str(mesh.height)}
        frame = {"maskUnits": "userSpaceOnUse", "x": "0", "y": "0", **whole}
        with document.element("mask", {"id": ids.mask, **frame}):
            drawing.write(colors[:, [3, 3, 3]], _channels(rgba, [3, 3, 3]))
        with document.element("g", {"mask": f"url(#{ids.mask})"}):
            drawing.write(colors[:, :3], _channels(rgba, [0, 1, 2], 3))
    else:
        rgb = colors[:, [0, 0, 0]] if colors.shape[1] == 1 else colors
        drawing.write(rgb, _channels(rgba, [0, 1, 2]))


def _channels(
    rgba: UInt8Array | None, shown: list[int], weight: int | None = None
) -> Photograph | None:
    """Channels of a photograph that are shown, and the one that says how much pixels count."""
    if rgba is None:
        return None
    weights = np.full(rgba.shape[:2], 255, np.uint8) if weight is None else rgba[:, :, weight]
    return Photograph(rgba[:, :, shown], weights)


def gzipped(stream: BinaryIO) -> gzip.GzipFile:
    """Gzip file on a stream, without name and time: the same drawing gives the same bytes."""
    return gzip.GzipFile(filename="", fileobj=stream, mode="wb", mtime=0)


def _check_work(mesh: Mesh, limits: Limits) -> None:
    """Refuse a raster, of flat colours or of pixels to fit to, that is larger than allowed."""
    limits.check_pixels(mesh.width, mesh.height)
    positions = scaled_positions(mesh, (mesh.width, mesh.height))
    _, n_rows = measure(positions, mesh.triangles, mesh.height)
    limits.check_work(2 * n_rows, 2 * mesh.width * mesh.height)


def _write_description(document: etree._IncrementalFileWriter, mesh: Mesh) -> None:
    """Write title, author and rights of the picture, as its EXIF tells them."""
    known = Description.of(mesh.metadata)
    texts = {"title": known.title, "desc": ", ".join(filter(None, (known.author, known.rights)))}
    for name, text in texts.items():
        if text:
            element = etree.Element(name)
            element.text = text
            document.write(element)
