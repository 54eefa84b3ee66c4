"""The space that a photograph's numbers belong to, by its profile or by what else its file says.

What is done is what Chromium shows, for PNG by its chunks, for JPEG and WebP by their profiles:

::

    pixels    profile for    done
    any       damaged        left out, told
    RGB       RGB            kept
    RGB       grey, CMYK     left out, told
    grey      grey           kept
    grey      RGB            tones converted to sRGB, told
    grey      CMYK           left out, told
    CMYK      CMYK           converted to sRGB
    CMYK      none, another  converted by a formula, told

Without a profile PNG can give its tones and primaries as numbers (gAMA, cHRM): other tones are
converted, other primaries become a profile, since sRGB does not hold their colours.

References
----------
W3C, "Portable Network Graphics (PNG) Specification (Third Edition)", 2025, 4.3 and 13.13: which
chunk counts, and how exact a gamma is taken. DCF 2.0 (JEITA CP-3461), 2.4.2: "R03" for Adobe RGB.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from vmesh.arrays import SampleArray
from vmesh.codec.profile_name import profile_name
from vmesh.color_lattice import rescale
from vmesh.formats.color.conversion import is_srgb, is_usable, to_srgb, transform
from vmesh.formats.color.profiles import CMYK, GREY, RGB, grey_profile, rgb_profile, space_of

_NAMES: Final = {GREY: "grey", RGB: "RGB", CMYK: "CMYK"}
_SRGB_GAMMA: Final = 1 / 2.2
_SAME_GAMMA: Final = 0.05  # relative: less is not seen, and not corrected by libpng either
_MOST: Final = 20.0  # of gammas, and of their inverses: beyond it is no picture
# Chromaticities (x, y) of white, red, green and blue.
_SRGB: Final = (0.3127, 0.3290, 0.64, 0.33, 0.30, 0.60, 0.15, 0.06)
_ADOBE: Final = (0.3127, 0.3290, 0.64, 0.33, 0.21, 0.71, 0.15, 0.06)
_ADOBE_GAMMA: Final = 563 / 256
_SAME_PLACE: Final = 0.005  # of chromaticities, which files round
# Black is the ink that a picture has least of: its mean is 0.1 to 0.2 in photographs.
_MOST_BLACK: Final = 0.75
_NEUTRAL: Final = 2  # levels of 8 bits that rounding makes of equal components


@dataclass(frozen=True, slots=True)
class Interpretation:
    """Colours of a photograph as they are stored from now on.

    Parameters
    ----------
    array : ndarray
        uint8 or uint16, shape (h, w), (h, w, 3) or (h, w, 4).
    icc : bytes
        Profile of the array's colours, empty for sRGB.
    notes : tuple of str
        Sentences for the user about what was left out, or had to be guessed.
    """

    array: SampleArray
    icc: bytes = b""
    notes: tuple[str, ...] = ()

    def in_srgb(self) -> Interpretation:
        """Interpretation with its colours in sRGB, and without a profile."""
        return Interpretation(to_srgb(self.array, self.icc), b"", self.notes)


def interpret(
    array: SampleArray,
    profile: bytes,
    info: Mapping[Any, Any] | None = None,
    *,
    is_adobe_rgb: bool = False,
) -> Interpretation:
    """Interpretation of grey or RGB samples by an embedded profile, or by what PNG and EXIF say.

    Parameters
    ----------
    array : ndarray
        uint8 or uint16, shape (h, w), (h, w, 3) or (h, w, 4).
    profile : bytes
        As the file has it, empty if it has none.
    info : mapping, optional
        What Pillow tells of the file: "srgb", "gamma" and "chromaticity" are used.
    is_adobe_rgb : bool
        True if the EXIF block names that space, as cameras do instead of embedding a profile.
    """
    notes: tuple[str, ...] = ()
    if profile:
        if is_usable(profile):
            space, is_grey = space_of(profile), array.ndim == 2
            if space == (GREY if is_grey else RGB):
                return Interpretation(array, profile)
            if space == (RGB if is_grey else GREY) and (is_grey or _is_grey_with_alpha(array)):
                return _toned(array, profile)
            wanted = "grey" if is_grey else "RGB"
            why = f"is for {_NAMES[space]}, not for {wanted}"
        else:
            why = "is damaged or of a kind that is not read"
        notes = (f"{_called(profile)} {why}: it is left out",)
    elif is_adobe_rgb and array.ndim == 3:
        added = "its EXIF block says Adobe RGB: a profile of that space was added"
        return Interpretation(array, adobe_rgb(), (added,))
    return _by_numbers(array, info or {}, notes)


def interpret_inks(inks: SampleArray, profile: bytes, *, is_bare: bool = False) -> Interpretation:
    """Interpretation of CMYK: in sRGB, through its profile or by a formula.

    Parameters
    ----------
    inks : ndarray
        uint8 or uint16, shape (h, w, 4): amounts of ink, the largest sample for all of it.
    profile : bytes
        As the file has it, empty if it has none.
    is_bare : bool
        True of a JPEG without Adobe's marker, which says that inks are stored as what is left of
        white, as `inks` takes it. Most are stored so all the same, but not all.
    """
    notes: tuple[str, ...] = ()
    most = np.iinfo(inks.dtype).max
    if is_bare and inks[:, :, 3].mean() > _MOST_BLACK * most:
        inks = most - inks
        notes = ("nothing says how its inks are stored: they were taken as amounts of ink",)
    if profile:
        if space_of(profile) == CMYK and is_usable(profile):
            flat = transform(inks.reshape(-1, 4), profile)
            return Interpretation(flat.reshape(*inks.shape[:2], 3), b"", notes)
        notes += (f"{_called(profile)} is not one for CMYK that can be used: it is left out",)
    notes += ("its CMYK colours have no profile: they were converted by a plain formula",)
    return Interpretation(_plain_rgb(inks), b"", notes)


def adobe_rgb() -> bytes:
    """A profile of Adobe RGB (1998)."""
    return rgb_profile(_ADOBE, _ADOBE_GAMMA)


def _called(profile: bytes) -> str:
    """The profile as a subject, with its name if it has one."""
    name = profile_name(profile)
    return f"the ICC profile {name!r}" if name else "the ICC profile"


def _plain_rgb(inks: SampleArray) -> SampleArray:
    """RGB of inks that take away light each for itself, shape (h, w, 3)."""
    most = int(np.iinfo(inks.dtype).max)
    left = most - inks.astype(np.int64)
    rgb: SampleArray = ((left[:, :, :3] * left[:, :, 3:] + most // 2) // most).astype(inks.dtype)
    return rgb


def _by_numbers(
    array: SampleArray, info: Mapping[Any, Any], notes: tuple[str, ...]
) -> Interpretation:
    """Grey or RGB samples by the gamma and the primaries that PNG gives as numbers."""
    gamma, places = info.get("gamma"), info.get("chromaticity", ())
    if "srgb" in info or not isinstance(gamma, float) or not 1 / _MOST <= gamma <= _MOST:
        return Interpretation(array, b"", notes)
    if array.ndim == 3 and len(places) == 8 and not np.allclose(places, _SRGB, atol=_SAME_PLACE):
        made = rgb_profile(places, 1 / gamma)
        return Interpretation(array, made if is_usable(made) else b"", notes)
    if abs(gamma / _SRGB_GAMMA - 1) < _SAME_GAMMA:
        return Interpretation(array, b"", notes)
    return Interpretation(_with_table(array, _table(grey_profile(1 / gamma), array)), b"", notes)


def _is_grey_with_alpha(array: SampleArray) -> bool:
    """True of RGBA that came of grey."""
    return bool(array.shape[2] == 4 and (array[:, :, :2] == array[:, :, 1:3]).all())


def _toned(array: SampleArray, profile: bytes) -> Interpretation:
    """Grey, with alpha or without, whose profile cannot stay, in sRGB."""
    for_what = "RGB, not for grey" if space_of(profile) == RGB else "grey without alpha"
    said = f"{_called(profile)} is for {for_what}: "
    if is_srgb(profile):
        return Interpretation(array, b"", (f"{said}it is left out, which changes no colour",))
    note = f"{said}the tones were converted to sRGB"
    return Interpretation(_with_table(array, _table(profile, array)), b"", (note,))


def _table(profile: bytes, array: SampleArray) -> SampleArray:
    """RGB in sRGB of each level of grey that the array's type has, shape (n, 3)."""
    n_bits = 8 * array.dtype.itemsize
    # In 16 bits: in 8 littleCMS is up to two levels off where it is dark.
    levels = rescale(np.arange(1 << n_bits).astype(array.dtype)[:, None], n_bits, 16)
    n_components = 1 if space_of(profile) == GREY else 3
    return rescale(transform(np.repeat(levels, n_components, axis=1), profile), 16, n_bits)


def _with_table(array: SampleArray, table: SampleArray) -> SampleArray:
    """Samples with each level looked up; grey becomes RGB where a profile gives it a tint."""
    spread = np.ptp(table.astype(int), axis=1).max()
    has_tint = spread > _NEUTRAL * (len(table) // 256)
    if array.ndim == 2:
        return table[array] if has_tint else table[:, 1][array]
    colors = table[array[:, :, 1]] if has_tint else table[:, 1][array[:, :, :3]]
    return np.concatenate([colors, array[:, :, 3:]], axis=2)
