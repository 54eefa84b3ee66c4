"""Photographs as triangle meshes.

The public names, loaded when they are first used, so that ``import vmesh`` stays light::

    mesh = vmesh.encode(array)             pixels -> Mesh
    vmesh.dump(mesh, "photo.vmesh")        Mesh -> file;  dumps gives the bytes
    mesh = vmesh.load("photo.vmesh")       file -> Mesh;  loads takes the bytes
    array = vmesh.render(mesh, scale=2)    Mesh -> pixels
    vmesh.export(mesh, "photo.svg")        Mesh -> SVG, PDF, PNG, PLY ... by the file's name
    text = vmesh.data_uri(mesh)            Mesh -> SVG in the place of an address
    vmesh.export_album(meshes, "a.pdf")    Meshes -> PDF, a page each
    mesh = vmesh.import_mesh("mesh.ply")   PLY, OBJ, glTF or text -> Mesh
    vmesh.paint_mesh(mesh, context)        Mesh -> any cairo context
    vmesh.study(array)                     a report on the photograph, shown by notebooks
    vmesh.register()                       Image.open and Image.save of Pillow know .vmesh
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from vmesh.codec.reader import loads
    from vmesh.codec.stream import dump, load
    from vmesh.codec.writer import dumps
    from vmesh.color_lattice import ColorLattice
    from vmesh.encoder.pipeline import encode
    from vmesh.encoder.settings import Settings
    from vmesh.errors import (
        FormatError,
        ImageError,
        LimitError,
        MeshError,
        PartialFileWarning,
        VmeshError,
    )
    from vmesh.formats.models.mesh_import import import_mesh
    from vmesh.formats.pdf.album import export_album
    from vmesh.formats.pdf.cairo_backend import paint_mesh
    from vmesh.formats.raster.rendering import render
    from vmesh.formats.registry import data_uri, export
    from vmesh.limits import Limits
    from vmesh.mesh import Mesh, Metadata
    from vmesh.pillow_plugin import register
    from vmesh.report.study import Study, study

__version__ = "0.1.0"

__all__ = [
    "ColorLattice",
    "FormatError",
    "ImageError",
    "LimitError",
    "Limits",
    "Mesh",
    "MeshError",
    "Metadata",
    "PartialFileWarning",
    "Settings",
    "Study",
    "VmeshError",
    "data_uri",
    "dump",
    "dumps",
    "encode",
    "export",
    "export_album",
    "import_mesh",
    "load",
    "loads",
    "paint_mesh",
    "register",
    "render",
    "study",
]

_HOMES: Final = {
    "ColorLattice": "vmesh.color_lattice",
    "FormatError": "vmesh.errors",
    "ImageError": "vmesh.errors",
    "LimitError": "vmesh.errors",
    "Limits": "vmesh.limits",
    "Mesh": "vmesh.mesh",
    "MeshError": "vmesh.errors",
    "Metadata": "vmesh.mesh",
    "PartialFileWarning": "vmesh.errors",
    "Settings": "vmesh.encoder.settings",
    "Study": "vmesh.report.study",
    "VmeshError": "vmesh.errors",
    "data_uri": "vmesh.formats.registry",
    "dump": "vmesh.codec.stream",
    "dumps": "vmesh.codec.writer",
    "encode": "vmesh.encoder.pipeline",
    "export": "vmesh.formats.registry",
    "export_album": "vmesh.formats.pdf.album",
    "import_mesh": "vmesh.formats.models.mesh_import",
    "load": "vmesh.codec.stream",
    "loads": "vmesh.codec.reader",
    "paint_mesh": "vmesh.formats.pdf.cairo_backend",
    "register": "vmesh.pillow_plugin",
    "render": "vmesh.formats.raster.rendering",
    "study": "vmesh.report.study",
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(_HOMES[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted([*globals(), *_HOMES])
