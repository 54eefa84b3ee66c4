"""Synthetic pictures made in code, and how to draw a mesh to compare it with one."""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

from vmesh.arrays import SampleArray, UInt8Array
from vmesh.kernels.scanline import SUBPIXEL, draw
from vmesh.mesh import Mesh


def constant(height: int, width: int, *color: int) -> UInt8Array:
    """One colour everywhere, shape (h, w, c), or (h, w) for a single component."""
    picture = np.full((height, width, len(color)), color, dtype=np.uint8)
    return picture[:, :, 0] if len(color) == 1 else picture


def ramp(height: int, width: int) -> UInt8Array:
    """RGB ramps: red from left to right, green from top to bottom, blue against red."""
    x = np.linspace(0, 255, width)[None, :].repeat(height, axis=0)
    y = np.linspace(0, 255, height)[:, None].repeat(width, axis=1)
    return np.rint(np.stack([x, y, 255 - x], axis=2)).astype(np.uint8)


def grey_ramp(height: int, width: int) -> UInt8Array:
    """A grey ramp from left to right, shape (h, w)."""
    return ramp(height, width)[:, :, 0].copy()


def step_edge(height: int, width: int) -> UInt8Array:
    """Black on the left half, white on the right."""
    picture = np.zeros((height, width, 3), dtype=np.uint8)
    picture[:, width // 2 :] = 255
    return picture


def checkerboard(height: int, width: int, side: int = 1) -> UInt8Array:
    """Black and white squares, shape (h, w)."""
    y, x = np.mgrid[:height, :width]
    return np.where((x // side + y // side) % 2 == 0, 0, 255).astype(np.uint8)


def noise(height: int, width: int, n_components: int = 3, seed: int = 1) -> UInt8Array:
    """Independent uniform samples, shape (h, w, c)."""
    random = np.random.default_rng(seed)
    return random.integers(0, 256, (height, width, n_components), dtype=np.uint8)


def disc(
    height: int, width: int, hidden: tuple[int, int, int], visible: tuple[int, int, int]
) -> UInt8Array:
    """RGBA: an opaque disc with a soft rim, and a colour hidden where it is transparent."""
    y, x = np.mgrid[:height, :width]
    radius = np.hypot(x - (width - 1) / 2, y - (height - 1) / 2)
    alpha = np.clip((min(height, width) / 3 - radius) / 3 + 0.5, 0, 1)
    picture = np.empty((height, width, 4), dtype=np.uint8)
    picture[:, :, :3] = np.where((alpha > 0)[:, :, None], visible, hidden)
    picture[:, :, 3] = np.rint(255 * alpha)
    return picture


PICTURES: Final[dict[str, UInt8Array]] = {
    "one pixel": constant(1, 1, 10, 200, 30),
    "one grey pixel": constant(1, 1, 7),
    "one transparent pixel": constant(1, 1, 255, 0, 0, 0),
    "one row": ramp(1, 17),
    "one column": ramp(17, 1),
    "one row of noise": noise(1, 40),
    "one column of grey noise": noise(40, 1, 1)[:, :, 0],
    "two by two": noise(2, 2),
    "three by two": noise(2, 3),
    "constant": constant(9, 14, 90, 90, 90),
    "constant grey": constant(14, 9, 128),
    "ramp": ramp(24, 32),
    "grey ramp": grey_ramp(20, 31),
    "step edge": step_edge(20, 20),
    "fine checkerboard": checkerboard(16, 16),
    "coarse checkerboard": checkerboard(24, 24, 6),
    "noise": noise(24, 24),
    "grey noise": noise(24, 24, 1)[:, :, 0],
    "transparent noise": noise(24, 24, 4),
    "disc": disc(32, 32, hidden=(255, 0, 0), visible=(20, 90, 160)),
}


def drawn(mesh: Mesh) -> SampleArray:
    """Pixels of a mesh at its own size, shape (h, w, c); 0 where nothing is drawn."""
    colors = mesh.colors
    raster = np.zeros((mesh.height, mesh.width, mesh.n_components), dtype=colors.dtype)
    positions = mesh.vertices.astype(np.int64) * (SUBPIXEL // mesh.unit)
    draw(positions, mesh.triangles, colors, raster)
    return raster


def share_apart(first: npt.ArrayLike, second: npt.ArrayLike) -> float:
    """Share of the pixels of two pictures that are more than a level apart in some component."""
    apart = np.abs(np.subtract(first, second, dtype=np.float64)).max(axis=-1) > 1
    return float(apart.mean())


def psnr(first: UInt8Array, second: UInt8Array) -> float:
    """Peak signal-to-noise ratio in decibels of two pictures of the same shape."""
    error = np.mean((first.astype(float).ravel() - second.astype(float).ravel()) ** 2)
    return float(10 * np.log10(255**2 / max(error, 1e-12)))
