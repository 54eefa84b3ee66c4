"""An encoding with its intermediate results."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy.typing as npt

from vmesh.arrays import Float64Array, SampleArray, UInt8Array, UInt16Array
from vmesh.codec.writer import dumps
from vmesh.encoder.image import weighted
from vmesh.encoder.pipeline import encode_with
from vmesh.encoder.proposals import propose
from vmesh.encoder.settings import Settings
from vmesh.formats.color.conversion import mesh_in_srgb, to_srgb
from vmesh.formats.picture.conversion import flatten
from vmesh.formats.raster.rendering import render
from vmesh.inspection.heat import error_levels
from vmesh.limits import DEFAULT_LIMITS, Limits
from vmesh.mesh import Mesh, Metadata
from vmesh.metrics import psnr
from vmesh.progress import Progress


@dataclass(frozen=True)
class Inspection:
    """An encoding and its stages.

    Parameters
    ----------
    photograph : ndarray
        As :func:`vmesh.encode` takes it.
    salience : ndarray
        Shape (c, h, w), uint16, in 1/256 level.
    classes : ndarray, optional
        Shape (h, w), uint8: bit i is set where the mesh has a sample of colour plane i. None where
        vertices have moved since they were sampled.
    mesh : Mesh
    limits : Limits
        Limits on what is drawn of it.
    """

    photograph: SampleArray
    salience: UInt16Array
    classes: UInt8Array | None
    mesh: Mesh
    limits: Limits = DEFAULT_LIMITS

    @cached_property
    def shown(self) -> Mesh:
        """The mesh in sRGB, as sheets have it."""
        return mesh_in_srgb(self.mesh)

    @cached_property
    def original(self) -> UInt8Array:
        """The photograph in sRGB on white, shape (h, w, 3)."""
        return flatten(to_srgb(self.photograph, self.mesh.metadata.icc))

    @cached_property
    def rendered(self) -> UInt8Array:
        """The mesh in sRGB on white at its own size, shape (h, w, 3)."""
        mesh = self.mesh
        raster = to_srgb(render(mesh, limits=self.limits), mesh.metadata.icc, mesh.depth)
        return flatten(raster, mesh.depth)

    @cached_property
    def errors(self) -> Float64Array:
        """Root mean square of the difference of photograph and mesh, shape (h, w), in levels."""
        return error_levels(self.original, self.rendered)

    @cached_property
    def psnr(self) -> float:
        """PSNR of the mesh over RGB, in dB."""
        return psnr(self.original, self.rendered)

    @cached_property
    def n_bytes(self) -> int:
        """Size of the ``.vmesh`` file, metadata included."""
        return len(dumps(self.mesh))


def inspect_encoding(
    photograph: SampleArray,
    settings: Settings,
    *,
    weights: npt.ArrayLike | None = None,
    metadata: Metadata | None = None,
    limits: Limits = DEFAULT_LIMITS,
    progress: Progress | None = None,
) -> Inspection:
    """Encode a photograph, and keep the intermediate results.

    Parameters
    ----------
    photograph, weights, metadata, progress
        As for :func:`vmesh.encode`.
    settings : Settings
    limits : Limits
        Limits on the mesh and on what is drawn of it.
    """
    salience, samples = propose(weighted(photograph, weights), settings)
    mesh = encode_with(photograph, settings, weights=weights, metadata=metadata, progress=progress)
    limits.check_vertices(mesh.n_vertices)
    classes = samples.classes if settings.method == "blue-noise" else None
    return Inspection(photograph, salience, classes, mesh, limits)
