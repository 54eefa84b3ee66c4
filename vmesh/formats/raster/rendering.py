"""Mesh -> pixels, and pixels -> image files."""

from __future__ import annotations

import io
from operator import index
from typing import BinaryIO, Final

import numpy as np
from PIL import Image

from vmesh.arrays import Int32Array, Int64Array, SampleArray
from vmesh.color_lattice import rescale
from vmesh.formats.metadata.exif import EXIF_START
from vmesh.kernels.scanline import SUBPIXEL, draw, measure
from vmesh.limits import DEFAULT_LIMITS, MAX_SIDE, Limits
from vmesh.mesh import Mesh, Metadata
from vmesh.mesh.placement import Matrix, Placement

MAX_SUPERSAMPLE: Final = 16

_BAND_PIXELS: Final = 1 << 22  # drawn at a time when supersampling
LONGEST_SIDES: Final = {"JPEG": 65_500, "WEBP": 16_383}
_DEEP_FORMATS: Final = ("PNG", "TIFF")
_WHITE: Final = (255, 255, 255)
_ICC_SPACES: Final = {1: b"GRAY", 3: b"RGB ", 4: b"RGB "}


def render(
    mesh: Mesh,
    *,
    scale: float | None = None,
    width: int | None = None,
    height: int | None = None,
    transform: Matrix | None = None,
    supersample: int = 1,
    limits: Limits = DEFAULT_LIMITS,
) -> SampleArray:
    """Pixels of a mesh.

    Every pixel takes the colour at its centre; a centre on an edge belongs to the triangle on the
    right of the edge or below it (the top-left rule). At the mesh's own size the result is that of
    exact integer arithmetic; at any other, vertices are first rounded to 1/256 of a pixel of the
    result.

    Parameters
    ----------
    mesh : Mesh
    scale : float, optional
        Pixels of the result per pixel of the canvas.
    width, height : int, optional
        Size of the result; one of them alone keeps the proportions. Not together with `scale`.
    transform : sequence of six float, optional
        Affine map ``(a, b, c, d, e, f)`` in SVG's order, applied before the scaling; the result
        holds the whole moved canvas.
    supersample : int
        Each pixel is the mean of supersample x supersample centres, 1 to 16: for results that
        are smaller than the canvas.
    limits : Limits
        What may be asked for.

    Returns
    -------
    ndarray
        uint8, or uint16 if samples have more than 8 bits; shape (h, w) for grey, (h, w, 3) for
        RGB, (h, w, 4) for RGBA. RGBA too, transparent outside of the mesh, if the transform tilts
        the canvas.

    Raises
    ------
    LimitError
        If the raster or the work is more than `limits` allow.
    """
    placement = Placement.of(
        mesh.width, mesh.height, (1, 0, 0, 1, 0, 0) if transform is None else transform
    )
    columns, rows = raster_size(placement.width, placement.height, scale, width, height)
    supersample = index(supersample)
    if not 1 <= supersample <= MAX_SUPERSAMPLE:
        raise ValueError(f"expected a supersampling of 1 to {MAX_SUPERSAMPLE}, got {supersample}")
    limits.check_pixels(columns, rows)
    drawn = (columns * supersample, rows * supersample)
    if max(drawn) > MAX_SIDE:
        raise ValueError(f"a raster side of {max(drawn)} samples is more than {MAX_SIDE}")

    if transform is None:
        positions = scaled_positions(mesh, drawn)
    else:
        factor = np.array(drawn) / (placement.width, placement.height) * SUBPIXEL
        positions = np.rint(placement.move(mesh.points) * factor).astype(np.int64)
    triangles = mesh.triangles if placement.keeps_turn else mesh.triangles[:, ::-1].copy()
    doubled_area, n_rows = measure(positions, triangles, drawn[1])
    n_bands = -(-rows // _band_rows(columns, supersample, len(triangles)))
    limits.check_work(n_rows + n_bands * len(triangles), drawn[0] * drawn[1])

    colors = mesh.colors
    whole = drawn[0] * drawn[1] * SUBPIXEL**2
    if not placement.fills or doubled_area != 2 * whole:
        colors = with_alpha(colors, mesh.lattice.max_sample)
    raster = rasterize(positions, triangles, colors, (columns, rows), supersample)
    return raster[:, :, 0] if colors.shape[1] == 1 else raster


def rasterize(
    positions: Int64Array,
    triangles: Int32Array,
    colors: SampleArray,
    size: tuple[int, int],
    supersample: int,
) -> SampleArray:
    """Pixels of triangles, means of supersample x supersample centres each; shape (h, w, c)."""
    if supersample == 1:
        return _drawn(positions, triangles, colors, size)
    return _supersampled(positions, triangles, colors, size, supersample)


def _drawn(
    positions: Int64Array, triangles: Int32Array, colors: SampleArray, size: tuple[int, int]
) -> SampleArray:
    """Triangles drawn on a raster of their own, shape (h, w, c)."""
    raster = np.zeros((size[1], size[0], colors.shape[1]), dtype=colors.dtype)
    draw(positions, triangles, colors, raster)
    return raster


def write_raster(
    raster: SampleArray,
    stream: BinaryIO,
    format_name: str,
    *,
    metadata: Metadata | None = None,
    depth: int = 8,
    quality: int = 92,
) -> None:
    """Write an image file through Pillow.

    Samples of more than 8 bits are written as 16 bits where Pillow can, which is grey PNG and
    TIFF, and rounded to 8 elsewhere.

    Parameters
    ----------
    raster : ndarray
        uint8 or uint16, shape (h, w), (h, w, 3) or (h, w, 4).
    stream : binary file
    format_name : {"PNG", "JPEG", "WEBP", "TIFF"}
        JPEG has no alpha: the picture is laid on white.
    metadata : Metadata, optional
        ICC profile (where it fits the picture's components) and EXIF are written along.
    depth : int
        Bits of a sample, 8 for uint8, 9 to 16 for uint16.
    quality : int
        For JPEG and WebP, 1 to 100.
    """
    if depth > 8:
        n_bits = 16 if raster.ndim == 2 and format_name in _DEEP_FORMATS else 8
        raster = rescale(raster, depth, n_bits)
    image = Image.fromarray(raster)
    if max(image.size) > LONGEST_SIDES.get(format_name, MAX_SIDE):
        raise ValueError(
            f"{format_name} holds sides of at most {LONGEST_SIDES[format_name]} pixels, "
            f"got {image.width} x {image.height}"
        )
    if format_name == "JPEG" and image.mode == "RGBA":
        opaque = Image.new("RGB", image.size, _WHITE)
        opaque.paste(image, mask=image.getchannel("A"))
        image = opaque
    options: dict[str, object] = {}
    if format_name in ("JPEG", "WEBP"):
        options["quality"] = quality
    if metadata is not None:
        exif = EXIF_START + metadata.exif
        if metadata.exif and _takes_exif(format_name, image.mode, exif):
            options["exif"] = exif
        if fits_icc(metadata.icc, len(image.getbands())):
            options["icc_profile"] = metadata.icc
    image.save(stream, format_name, **options)


def png_of(raster: SampleArray) -> bytes:
    """The PNG file of a raster in 8 bits, without metadata."""
    stream = io.BytesIO()
    write_raster(raster, stream, "PNG")
    return stream.getvalue()


def _takes_exif(format_name: str, mode: str, exif: bytes) -> bool:
    """True if a format can hold an EXIF block, which may be too long or make no sense."""
    try:
        Image.new(mode, (1, 1)).save(io.BytesIO(), format_name, exif=exif)
    except Exception:
        # Pillow parses the block, and fails on one that makes no sense with errors of any kind.
        return False
    return True


def fits_icc(profile: bytes, n_components: int) -> bool:
    """True if an ICC profile describes pictures of this many components."""
    return profile[16:20] == _ICC_SPACES[n_components]


def raster_size(
    canvas_width: float,
    canvas_height: float,
    scale: float | None,
    width: int | None,
    height: int | None,
) -> tuple[int, int]:
    """Columns and rows of a raster of a canvas, by a scale or a size as `render` takes them."""
    if scale is not None and (width is not None or height is not None):
        raise ValueError("expected a scale or a size, not both")
    if max(width or 0, height or 0) > MAX_SIDE:
        raise ValueError(f"a raster side of more than {MAX_SIDE} pixels was asked for")
    if width is not None and height is not None:
        columns, rows = float(width), float(height)
    elif width is not None:
        columns, rows = float(width), width * canvas_height / canvas_width
    elif height is not None:
        columns, rows = height * canvas_width / canvas_height, float(height)
    else:
        factor = 1.0 if scale is None else float(scale)
        if not 0.0 < factor < float("inf"):
            raise ValueError(f"expected a scale above 0, got {scale}")
        columns, rows = canvas_width * factor, canvas_height * factor
    if columns <= 0 or rows <= 0:
        raise ValueError(f"expected a raster of at least one pixel, got {columns} x {rows}")
    if max(columns, rows) > MAX_SIDE:
        raise ValueError(f"a raster side of {max(columns, rows):.8g} pixels is over {MAX_SIDE}")
    return max(1, round(columns)), max(1, round(rows))


def scaled_positions(
    mesh: Mesh, size: tuple[int, int], part: tuple[int, int, int, int] | None = None
) -> Int64Array:
    """Vertices in 1/256 pixel of a raster of the canvas, shape (n, 2), int64.

    `part` is what the raster shows, unless all of it: left, top, width and height in pixels.
    """
    shown = np.array(part or (0, 0, mesh.width, mesh.height), dtype=np.int64) * mesh.unit
    corner, extent = shown[:2], shown[2:]
    distances = mesh.vertices.astype(np.int64) - corner
    positions: Int64Array = (2 * distances * (np.array(size) * SUBPIXEL) + extent) // (2 * extent)
    return positions


def with_alpha(colors: SampleArray, opaque: int = 255) -> SampleArray:
    """RGBA of grey, RGB or RGBA colours; an alpha of `opaque` where there is none."""
    if colors.shape[1] == 4:
        return colors
    alpha = np.full((len(colors), 1), opaque, dtype=colors.dtype)
    rgb = np.repeat(colors, 3, axis=1) if colors.shape[1] == 1 else colors
    return np.concatenate([rgb, alpha], axis=1)


def _band_rows(columns: int, factor: int, n_triangles: int) -> int:
    """Rows of a band, with so many samples that the visit to every triangle does not weigh."""
    return max(1, max(_BAND_PIXELS, 8 * n_triangles) // (columns * factor * factor))


def _supersampled(
    positions: Int64Array,
    triangles: Int32Array,
    colors: SampleArray,
    size: tuple[int, int],
    factor: int,
) -> SampleArray:
    """Means over factor x factor samples, drawn in bands of rows; shape (h, w, c)."""
    columns, rows = size
    n_components = colors.shape[1]
    band_rows = _band_rows(columns, factor, len(triangles))
    result = np.empty((rows, columns, n_components), dtype=colors.dtype)
    for first in range(0, rows, band_rows):
        last = min(first + band_rows, rows)
        shifted = positions - np.array([0, first * factor * SUBPIXEL])
        band = _drawn(shifted, triangles, colors, (columns * factor, (last - first) * factor))
        blocks = band.reshape(last - first, factor, columns, factor, n_components)
        result[first:last] = _block_means(blocks)
    return result


def _block_means(blocks: SampleArray) -> SampleArray:
    """Means over axes 1 and 3, rounded; colours count in proportion to their alpha."""
    count = blocks.shape[1] * blocks.shape[3]
    if blocks.shape[4] != 4:
        sums = blocks.sum(axis=(1, 3), dtype=np.int64)
        rounded: SampleArray = ((2 * sums + count) // (2 * count)).astype(blocks.dtype)
        return rounded
    alpha = blocks[..., 3:].astype(np.int64)
    covered = alpha.sum(axis=(1, 3))
    sums = (blocks[..., :3] * alpha).sum(axis=(1, 3))
    colors = (2 * sums + covered) // np.maximum(2 * covered, 1)
    means = (2 * covered + count) // (2 * count)
    whole: SampleArray = np.concatenate([colors, means], axis=2).astype(blocks.dtype)
    return whole
