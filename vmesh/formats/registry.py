"""The tables of formats that are written and read, by the ending of a file's name."""

from __future__ import annotations

import io
import os
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from importlib import import_module
from inspect import Parameter, signature
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, Final, TypedDict, Unpack

import numpy as np

from vmesh.files import atomic_output
from vmesh.limits import DEFAULT_LIMITS, Limits
from vmesh.mesh import Mesh

if TYPE_CHECKING:
    from vmesh.arrays import SampleArray
    from vmesh.formats.metadata.privacy import Strip
    from vmesh.formats.pdf.document import Backend
    from vmesh.formats.pdf.page_size import Orientation
    from vmesh.formats.svg.size import Length
    from vmesh.formats.svg.style import Mode, Seams
    from vmesh.mesh.placement import Matrix
    from vmesh.progress import Progress

Writer = Callable[..., None]


class ExportOptions(TypedDict, total=False):
    """Options of all formats that are written; each takes some of them, as :func:`export` says."""

    scale: float | None
    width: Length | None
    height: Length | None
    transform: Matrix | None
    supersample: int
    mode: Mode
    tolerance: float
    merge: float
    seams: Seams
    id_prefix: str | None
    fit: SampleArray | None
    page_width: str | None
    page_size: str | None
    orientation: Orientation | None
    margin: str | None
    backend: Backend
    ascii: bool
    progress: Progress | None
    strip: Strip | None


@dataclass(frozen=True, slots=True)
class Format:
    """An output format.

    Parameters
    ----------
    name : str
        Its name, for pixels that by which Pillow knows it.
    module, function : str
        Where its writer is.
    is_raster : bool
        True of a format that holds pixels, which its writer takes in place of the mesh.
    is_compressed : bool
        True if what is written is compressed as a whole, by gzip.
    is_public : bool
        True of a document that is made to be shown: without private metadata unless asked for.
    has_profile : bool
        True of a format that says which space its colours belong to, or whose writer sees to it;
        others get sRGB.
    """

    name: str
    module: str
    function: str
    is_raster: bool = False
    is_compressed: bool = False
    is_public: bool = False
    has_profile: bool = True

    def writer(self) -> Writer:
        """Writer of the format, imported when it is asked for."""
        found: Writer = getattr(import_module(self.module), self.function)
        return found


FORMATS: Final = {
    ".png": Format("PNG", "vmesh.formats.raster.rendering", "write_raster", is_raster=True),
    ".jpg": Format("JPEG", "vmesh.formats.raster.rendering", "write_raster", is_raster=True),
    ".jpeg": Format("JPEG", "vmesh.formats.raster.rendering", "write_raster", is_raster=True),
    ".webp": Format("WEBP", "vmesh.formats.raster.rendering", "write_raster", is_raster=True),
    ".tif": Format("TIFF", "vmesh.formats.raster.rendering", "write_raster", is_raster=True),
    ".tiff": Format("TIFF", "vmesh.formats.raster.rendering", "write_raster", is_raster=True),
    ".pam": Format(
        "PAM", "vmesh.formats.raster.pam", "write_pam", is_raster=True, has_profile=False
    ),
    ".svg": Format(
        "SVG", "vmesh.formats.svg.document", "write_svg", is_public=True, has_profile=False
    ),
    ".svgz": Format(
        "SVG",
        "vmesh.formats.svg.document",
        "write_svg",
        is_compressed=True,
        is_public=True,
        has_profile=False,
    ),
    ".pdf": Format("PDF", "vmesh.formats.pdf.document", "write_pdf", is_public=True),
    ".html": Format("HTML", "vmesh.formats.html.document", "write_html", is_public=True),
    ".htm": Format("HTML", "vmesh.formats.html.document", "write_html", is_public=True),
    ".ply": Format("PLY", "vmesh.formats.models.mesh_files", "write_ply", has_profile=False),
    ".obj": Format("OBJ", "vmesh.formats.models.mesh_files", "write_obj", has_profile=False),
    ".glb": Format("glTF", "vmesh.formats.models.mesh_files", "write_glb", has_profile=False),
    ".txt": Format("text", "vmesh.codec.text", "write_text"),
}

DATA_URI: Final = replace(
    FORMATS[".svg"], module="vmesh.formats.svg.data_uri", function="write_data_uri"
)

# Formats that hold a mesh as other programs know it, which are read too.
MESH_SUFFIXES: Final = (".ply", ".obj", ".glb", ".txt")
RASTER_SUFFIXES: Final = tuple(suffix for suffix, f in FORMATS.items() if f.is_raster)


def format_of(path: str | os.PathLike[str]) -> Format:
    """Format that a file's name asks for.

    Raises
    ------
    ValueError
        If its ending is not in the table.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in FORMATS:
        raise ValueError(
            f"expected a name that ends in {', '.join(FORMATS)}, got {os.fspath(path)}"
        )
    return FORMATS[suffix]


def write_mesh(
    mesh: Mesh,
    stream: BinaryIO,
    target: Format,
    *,
    limits: Limits = DEFAULT_LIMITS,
    **options: Unpack[ExportOptions],
) -> None:
    """Write a mesh into an open file; options and errors are those of :func:`export`."""
    write, asked = target.writer(), dict[str, Any](options)
    strip: Strip = asked.pop("strip", None) or ("private" if target.is_public else "none")
    if strip != "none":
        from vmesh.formats.metadata.privacy import stripped

        mesh = mesh.replaced(metadata=stripped(mesh.metadata, strip))
    if target.is_raster:
        from vmesh.formats.raster.rendering import render

        _check_options(target.name, render, asked)
        raster = render(mesh, limits=limits, **asked)
        if mesh.metadata.icc and not target.has_profile:
            from vmesh.formats.color.conversion import to_srgb

            raster = to_srgb(raster, mesh.metadata.icc, mesh.depth)
        write(raster, stream, target.name, metadata=mesh.metadata, depth=mesh.depth)
        return
    _check_options(target.name, write, asked)
    if mesh.metadata.icc and not target.has_profile:
        from vmesh.formats.color.conversion import mesh_in_srgb, to_srgb

        if asked.get("fit") is not None:
            asked["fit"] = to_srgb(np.asarray(asked["fit"]), mesh.metadata.icc)
        mesh = mesh_in_srgb(mesh)
    if target.is_compressed:
        from vmesh.formats.svg.document import gzipped

        with gzipped(stream) as compressed:
            write(mesh, compressed, limits=limits, **asked)
    else:
        write(mesh, stream, limits=limits, **asked)


def _check_options(name: str, function: Callable[..., object], options: Iterable[str]) -> None:
    """Refuse options that are no keywords of a function, which makes or writes a format."""
    keywords = [
        parameter.name
        for parameter in signature(function).parameters.values()
        if parameter.kind is Parameter.KEYWORD_ONLY and parameter.name != "limits"
    ]
    for option in options:
        if option not in keywords:
            known = f"one of {', '.join(keywords)}" if keywords else "none"
            raise TypeError(f"{name} has no option {option!r}: expected {known}")


def export(
    mesh: Mesh,
    path: str | os.PathLike[str],
    *,
    limits: Limits = DEFAULT_LIMITS,
    **options: Unpack[ExportOptions],
) -> None:
    """Write a mesh as pixels, drawing, page or other programs' mesh, by the ending of the name.

    PNG, JPEG, WebP, TIFF and PAM; SVG, PDF and HTML; PLY, OBJ, glTF (``.glb``) and the canonical
    text (``.txt``). In PLY, OBJ and glTF a pixel is a unit, y points up, triangles are
    counter-clockwise, z is 0, and colours have 8 bits. PNG, JPEG, WebP, TIFF and PDF carry the
    picture's ICC profile; colours of the others are converted to sRGB, but for the text's, which
    are the mesh's levels.

    Parameters
    ----------
    mesh : Mesh
    path : path
        Replaced only when the new file is complete.
    limits : Limits
        Limits on the mesh, and on the pixels that are made of it.
    scale, transform, supersample
        For images: as for :func:`vmesh.render`.
    width, height : int or str
        For images the size in pixels, as for :func:`vmesh.render`. For SVG that at which it shows,
        such as "210mm" or "100%"; a number counts pixels.
    mode : {"gradient", "exact", "auto", "flat"}
        For SVG what fills a triangle; for PDF "exact".
    tolerance : float
        For SVG in mode "auto": largest error of a channel in levels, 4 unless given.
    merge : float
        For SVG in mode "gradient": squared error below which neighbours share one gradient, 0
        unless given.
    seams : {"crisp", "trapping"}
        For SVG how no seams show.
    id_prefix : str
        For SVG what ids begin with, a digest of the drawing unless given: two different drawings
        may be in one HTML page.
    fit : ndarray
        For SVG the photograph whose pixels the gradients are fitted to, in the mesh's profile.
    page_width, page_size, orientation, margin : str
        For PDF, as for :func:`vmesh.export_album`.
    backend : {"native", "cairo"}
        For PDF what writes it.
    ascii : bool
        For PLY true to get text.
    progress : callable
        For SVG, called with the name of each stage as it begins.
    strip : {"none", "private", "all"}
        Metadata that are left out: places, serial numbers and makers' notes, or all but the colour
        profile. "private" for SVG, PDF and HTML unless given, else "none".

    Raises
    ------
    TypeError
        If the format has no such option.
    ValueError
        If the ending is not one of these, or an option is none that the format knows.
    LimitError
        If the mesh or its pixels are more than `limits` allow.
    """
    target = format_of(path)
    with atomic_output(path) as stream:
        write_mesh(mesh, stream, target, limits=limits, **options)


def data_uri(
    mesh: Mesh, *, limits: Limits = DEFAULT_LIMITS, **options: Unpack[ExportOptions]
) -> str:
    """Data URI of a mesh as SVG, to stand in quotes where HTML or CSS expect an address.

    Parameters
    ----------
    mesh : Mesh
    limits : Limits
        Limits on the mesh.
    **options
        As :func:`export` takes them for SVG.

    Raises
    ------
    TypeError
        If SVG has no such option.
    ValueError
        If an option is none that SVG knows.
    LimitError
        If the mesh is more than `limits` allow.
    """
    stream = io.BytesIO()
    write_mesh(mesh, stream, DATA_URI, limits=limits, **options)
    return stream.getvalue().decode("ascii")
