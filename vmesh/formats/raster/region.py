"""Part of a mesh -> pixels at any scale, without drawing the rest."""

from __future__ import annotations

from math import ceil

from vmesh.arrays import SampleArray
from vmesh.formats.raster.rendering import rasterize, scaled_positions
from vmesh.kernels.scanline import measure
from vmesh.limits import DEFAULT_LIMITS, MAX_SIDE, Limits
from vmesh.mesh import Mesh


def render_part(
    mesh: Mesh,
    part: tuple[int, int, int, int],
    size: tuple[int, int],
    *,
    limits: Limits = DEFAULT_LIMITS,
) -> SampleArray:
    """Pixels of a part of a mesh: a crop of what :func:`render` draws of the whole at that scale.

    A pixel of the result that is larger than one of the canvas is the mean of several.

    Parameters
    ----------
    mesh : Mesh
        Its triangles cover the part.
    part : tuple of int
        Left, top, width and height, in pixels of the canvas.
    size : tuple of int
        Columns and rows of the result.
    limits : Limits
        What may be asked for.

    Returns
    -------
    ndarray
        uint8, or uint16 if samples have more than 8 bits; shape (h, w) or (h, w, c).

    Raises
    ------
    ValueError
        If the whole canvas at this scale would have a side of more than 65,535 pixels.
    LimitError
        If the raster or the work is more than `limits` allow.
    """
    samples = max(1, ceil(max(part[2] / size[0], part[3] / size[1])))
    columns, rows = size[0] * samples, size[1] * samples
    limits.check_pixels(columns, rows)
    # More than that, and products of coordinates would no longer fit 64 bits.
    side = max(mesh.width * columns / part[2], mesh.height * rows / part[3])
    if side > max(MAX_SIDE, columns, rows):
        raise ValueError(f"at this scale the picture has {side:.0f} pixels a side, over {MAX_SIDE}")
    positions = scaled_positions(mesh, (columns, rows), part)
    _, n_rows = measure(positions, mesh.triangles, rows)
    limits.check_work(n_rows, columns * rows)
    raster = rasterize(positions, mesh.triangles, mesh.colors, size, samples)
    return raster[:, :, 0] if mesh.n_components == 1 else raster
