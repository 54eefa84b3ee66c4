"""Colours of a profile -> sRGB, by littleCMS.

Mean error in levels of 8 bits, and the largest, of samples of 16 bits in a wide space: 0.6 and 8.4
through the grid that littleCMS makes of a profile by default, 0.3 and 0.7 (the rounding of the
reference) without it. So samples of 16 bits take the longer way.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Final

import numpy as np

from vmesh.arrays import SampleArray
from vmesh.color_lattice import ColorLattice, rescale
from vmesh.errors import VmeshError
from vmesh.formats.color.profiles import CMYK, GREY, RGB, space_of, srgb_profile
from vmesh.mesh import Mesh, Metadata

_SPACES: Final = {GREY: "gray", RGB: "rgb", CMYK: "cmyk"}
_PERCEPTUAL: Final = 0  # as Pillow; profiles of displays have no other
_NO_GRID: Final = 0x0100  # cmsFLAGS_NOOPTIMIZE
_STRIDE: Final = 15  # levels between the colours by which a profile is known for that of sRGB
_SAME: Final = 2  # levels


class ProfileError(VmeshError):
    """The ICC profile cannot be used: it is damaged, or lacks what leads to other spaces."""


def to_srgb(picture: SampleArray, profile: bytes, depth: int | None = None) -> SampleArray:
    """Picture in sRGB of one in the space of a profile; itself where the profile does not fit it.

    Parameters
    ----------
    picture : ndarray
        uint8 or uint16, shape (h, w), (h, w, 3) or (h, w, 4). Alpha stays.
    profile : bytes
        ICC profile, or nothing for sRGB.
    depth : int, optional
        Bits of a sample, 8 to 16; as many as the type holds unless given.

    Returns
    -------
    ndarray
        The same shape, type and depth.
    """
    n_components = 1 if picture.ndim == 2 else picture.shape[-1]
    colors = picture.reshape(-1, n_components)
    converted = colors_in_srgb(colors, profile, depth)
    return picture if converted is colors else converted.reshape(picture.shape)


def colors_in_srgb(colors: SampleArray, profile: bytes, depth: int | None = None) -> SampleArray:
    """Colours in sRGB, shape (n, c) with c of 1, 3 or 4; the rest is as for :func:`to_srgb`."""
    n_components = colors.shape[1]
    if space_of(profile) != (GREY if n_components == 1 else RGB) or is_srgb(profile):
        return colors
    n_colors = min(n_components, 3)
    try:
        rgb = transform(colors[:, :n_colors], profile, depth)
    except ProfileError:
        return colors
    converted = rgb[:, 1:2] if n_colors == 1 else rgb
    return np.concatenate([converted, colors[:, n_colors:]], axis=1)


def transform(samples: SampleArray, profile: bytes, depth: int | None = None) -> SampleArray:
    """RGB in sRGB of colours in the space of a profile.

    Parameters
    ----------
    samples : ndarray
        uint8 or uint16, shape (n, c): grey, RGB, or CMYK as amounts of ink.
    profile : bytes
        ICC profile for these components.
    depth : int, optional
        Bits of a sample, 8 to 16; as many as the type holds unless given.

    Returns
    -------
    ndarray
        Shape (n, 3), of the type and depth of `samples`.

    Raises
    ------
    ProfileError
        If littleCMS cannot use the profile so.
    """
    from imagecodecs import CmsError, cms_transform

    if depth not in (None, 8, 16):
        return rescale(transform(rescale(samples, depth, 16), profile), 16, depth)
    row = np.ascontiguousarray(samples)[None]
    try:
        rgb = cms_transform(
            row[:, :, 0] if samples.shape[1] == 1 else row,
            profile,
            srgb_profile(),
            colorspace=_SPACES[space_of(profile)],
            outcolorspace="rgb",
            intent=_PERCEPTUAL,
            flags=0 if samples.dtype == np.uint8 else _NO_GRID,
        )
    except (CmsError, ValueError, KeyError) as error:
        raise ProfileError(f"the ICC profile cannot be used: {error}") from None
    converted: SampleArray = rgb[0]
    return converted


@lru_cache(maxsize=8)
def is_usable(profile: bytes) -> bool:
    """True if littleCMS can convert colours of a profile for grey, RGB or CMYK to sRGB."""
    n_components = {GREY: 1, RGB: 3, CMYK: 4}.get(space_of(profile))
    if n_components is None:
        return False
    try:
        transform(np.zeros((1, n_components), np.uint8), profile)
    except ProfileError:
        return False
    return True


@lru_cache(maxsize=8)
def is_srgb(profile: bytes) -> bool:
    """True if a profile for grey or RGB means sRGB, but for what rounding makes of it."""
    space = space_of(profile)
    if space not in (GREY, RGB):
        return False
    ramp = np.arange(0, 256, _STRIDE, dtype=np.uint8)
    axes = [ramp] * (1 if space == GREY else 3)
    colors = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, len(axes))
    try:
        moved = transform(colors, profile)
    except ProfileError:
        return False
    return bool(np.abs(moved.astype(int) - colors).max() <= _SAME)


def mesh_in_srgb(mesh: Mesh, refinement: int | None = None) -> Mesh:
    """Mesh with its colours in sRGB and without a profile; itself if it has none.

    What lies between vertices is drawn as the numbers are, before and after: the pictures differ a
    little where triangles are large and the profile's tones are not nearly those of sRGB.

    Parameters
    ----------
    mesh : Mesh
    refinement : int, optional
        The new steps of colours are the old ones divided by this. Unless given they are 1, which
        keeps colours exactly; a file of such a mesh is longer than the mesh's own.
    """
    metadata = mesh.metadata
    if not metadata.icc:
        return mesh
    lattice = ColorLattice.uniform(mesh.n_components, 1, mesh.depth)
    if refinement is not None:
        steps = (max(1, round(step / refinement)) for step in mesh.lattice.steps)
        lattice = ColorLattice(tuple(steps), mesh.depth)
    own = mesh.colors
    colors = colors_in_srgb(own, metadata.icc, mesh.depth)
    bare = Metadata(exif=metadata.exif, xmp=metadata.xmp, unknown=metadata.unknown)
    if colors is own:
        return mesh.replaced(metadata=bare)
    return mesh.replaced(levels=lattice.levels_from_colors(colors), lattice=lattice, metadata=bare)
