"""The tables of formats that are written and read, by the ending of a file's name."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any, BinaryIO, Final

from vmesh.files import atomic_output
from vmesh.mesh import Mesh

Writer = Callable[..., None]


@dataclass(frozen=True, slots=True)
class Format:
    """An output format: its writer, and its name where it is made of pixels."""

    module: str
    function: str
    raster_name: str = ""

    @property
    def is_raster(self) -> bool:
        """Whether files of this format hold pixels."""
        return bool(self.raster_name)

    def writer(self) -> Writer:
        """The function that writes it."""
        found: Writer = getattr(import_module(self.module), self.function)
        return found


FORMATS: Final = {
    ".png": Format("vmesh.formats.raster.rendering", "write_raster", "PNG"),
    ".jpg": Format("vmesh.formats.raster.rendering", "write_raster", "JPEG"),
    ".jpeg": Format("vmesh.formats.raster.rendering", "write_raster", "JPEG"),
    ".webp": Format("vmesh.formats.raster.rendering", "write_raster", "WEBP"),
    ".tif": Format("vmesh.formats.raster.rendering", "write_raster", "TIFF"),
    ".tiff": Format("vmesh.formats.raster.rendering", "write_raster", "TIFF"),
    ".pam": Format("vmesh.formats.raster.pam", "write_pam", "PAM"),
    ".svg": Format("vmesh.formats.svg.document", "write_svg"),
    ".svgz": Format("vmesh.formats.svg.document", "write_svgz"),
    ".pdf": Format("vmesh.formats.pdf.document", "write_pdf"),
    ".html": Format("vmesh.formats.html.document", "write_html"),
    ".htm": Format("vmesh.formats.html.document", "write_html"),
    ".ply": Format("vmesh.formats.models.mesh_files", "write_ply"),
    ".obj": Format("vmesh.formats.models.mesh_files", "write_obj"),
    ".glb": Format("vmesh.formats.models.mesh_files", "write_glb"),
    ".txt": Format("vmesh.codec.text", "write_text"),
}

# Those that hold a mesh as other programs know it, and are read too.
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


def write_mesh(mesh: Mesh, stream: BinaryIO, target: Format, **options: Any) -> None:
    """Write a mesh into an open file; options are those of `render` or of the format's writer."""
    if not target.is_raster:
        target.writer()(mesh, stream, **options)
        return
    from vmesh.formats.raster.rendering import render

    raster = render(mesh, **options)
    target.writer()(raster, stream, target.raster_name, metadata=mesh.metadata, depth=mesh.depth)


def export(mesh: Mesh, path: str | os.PathLike[str], **options: Any) -> None:
    """Write a mesh as pixels, drawing, page or other programs' mesh, by the ending of the name.

    PNG, JPEG, WebP, TIFF and PAM; SVG, PDF and HTML; PLY, OBJ, glTF (``.glb``) and the canonical
    text (``.txt``). In PLY, OBJ and glTF a pixel is a unit, y points up, triangles are
    counter-clockwise, z is 0, and colours have 8 bits.

    Parameters
    ----------
    mesh : Mesh
    path : path
        Replaced only when the new file is complete.
    **options
        For images those of :func:`vmesh.render`; for SVG ``mode``, "gradient", "exact", "auto"
        with a ``tolerance`` in levels, or "flat", ``merge``, ``seams``, "crisp" or "trapping",
        ``fit``, the photograph as an array, and ``width`` or ``height``, such as "210mm" or "100%";
        for PDF ``page_width``, such as "210mm", and ``backend``, "native" or "cairo"; for PLY
        ``ascii``, true for text.
    """
    target = format_of(path)
    with atomic_output(path) as stream:
        write_mesh(mesh, stream, target, **options)
