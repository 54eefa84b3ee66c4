"""Ways of storing a mesh that others wrote, or that come to mind first."""

from __future__ import annotations

import zlib
from collections.abc import Callable
from importlib import import_module
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from benchmarks.software import import_optional
from vmesh.mesh import Mesh

Coder = Callable[[Mesh], bytes]
DRACO: Final = "Draco"


def available_coders() -> dict[str, Coder]:
    """Coders of meshes other than vmesh, as far as their packages are installed."""
    coders: dict[str, Coder] = {
        "raw arrays": raw,
        "raw, zlib 9": lambda mesh: zlib.compress(raw(mesh), 9),
        "differences, zlib 9": lambda mesh: zlib.compress(differences(mesh), 9),
    }
    if (brotli := import_optional("brotli")) is not None:
        coders["raw, brotli 11"] = lambda mesh: brotli.compress(raw(mesh))
        coders["differences, brotli 11"] = lambda mesh: brotli.compress(differences(mesh))
    if (zstandard := import_optional("zstandard")) is not None:
        coders["differences, zstd 22"] = lambda mesh: zstandard.compress(differences(mesh), 22)
    if import_optional("DracoPy") is not None:
        coders[DRACO] = code_with_draco
    return coders


def planes(mesh: Mesh) -> list[npt.NDArray[np.int64]]:
    """Coordinates, levels and corners of a mesh, each as an array of its own."""
    columns = [*mesh.vertices.T, *mesh.levels.T, *mesh.triangles.T]
    return [column.astype(np.int64) for column in columns]


def raw(mesh: Mesh) -> bytes:
    """Every array in the smallest type that holds it."""
    return b"".join(smallest(column).tobytes() for column in planes(mesh))


def differences(mesh: Mesh) -> bytes:
    """Every array as differences from entry to entry; corners from the first of their triangle."""
    *rest, a, b, c = planes(mesh)
    columns = [np.diff(column, prepend=0) for column in (*rest, a)]
    return b"".join(smallest(column).tobytes() for column in (*columns, b - a, c - a))


def smallest(column: npt.NDArray[np.int64]) -> npt.NDArray[Any]:
    """An array in the smallest type that holds it, its bytes in planes."""
    low, high = int(column.min()), int(column.max())
    kind = np.promote_types(np.min_scalar_type(low), np.min_scalar_type(high))
    narrow = column.astype(kind)
    return narrow.view(np.uint8).reshape(len(narrow), -1).T.copy()


def code_with_draco(mesh: Mesh) -> bytes:
    """The mesh by Draco's slowest and smallest setting; positions are exact, colours are drawn."""
    draco = import_module("DracoPy")
    side = max(mesh.width, mesh.height) << mesh.subdivision
    bits = side.bit_length()
    points = np.pad(mesh.vertices, ((0, 0), (0, 1))).astype(np.float32)
    data: bytes = draco.encode(
        points,
        mesh.triangles.astype(np.uint32),
        quantization_bits=bits,
        compression_level=10,
        quantization_range=(1 << bits) - 1,
        quantization_origin=[0, 0, 0],
        colors=mesh.colors.astype(np.uint8),
    )
    return data
