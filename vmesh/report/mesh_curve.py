"""Rate-distortion curve of the meshes of a photograph."""

from __future__ import annotations

from typing import Final

from vmesh.arrays import SampleArray, UInt8Array
from vmesh.codec.writer import dumps
from vmesh.encoder.pipeline import encode_with
from vmesh.encoder.settings import Settings
from vmesh.formats.color.conversion import to_srgb
from vmesh.formats.picture.conversion import flatten
from vmesh.formats.raster.rendering import render
from vmesh.limits import Limits
from vmesh.mesh import Mesh, Metadata
from vmesh.metrics import psnr
from vmesh.progress import Progress
from vmesh.report.rivals import Curve, Point

SHARES: Final = (0.25, 0.5, 1.0, 2.0)
"""Vertices of a curve's meshes, by those of the mesh it belongs to."""

_CODEC: Final = "vmesh"


def mesh_curve(
    array: SampleArray,
    original: UInt8Array,
    mesh: Mesh,
    settings: Settings,
    limits: Limits,
    progress: Progress,
) -> Curve:
    """Meshes of a picture by the size of their files, each size once.

    `original` is the picture in sRGB, in which they are measured.
    Vertices are what is asked for: a search for sizes would take many times as long.
    """
    points = {}
    for share in SHARES:
        wanted = max(4, min(round(share * mesh.n_vertices), mesh.width * mesh.height))
        chosen = settings.with_goal(vertices=wanted)
        other = mesh if share == 1 else encode_with(array, chosen, progress=progress)
        size = len(dumps(other.replaced(metadata=Metadata())))
        raster = to_srgb(render(other, limits=limits), mesh.metadata.icc, other.depth)
        pixels = flatten(raster, other.depth)
        points[size] = Point(size, psnr(original, pixels))
    return Curve(_CODEC, tuple(points[size] for size in sorted(points)))
