"""EXIF blocks: one of what may be shown, of another.

The list below says what stays, not what goes: what nobody has thought of is left out. So is a block
that is damaged, as a whole.
"""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from PIL import Image

from vmesh.formats.metadata.directories import DETAILS, FIRST, INTEROPERABILITY, entries_of
from vmesh.formats.metadata.exif import EXIF_START

# Directory -> tags: what the picture shows, who made it and may use it, when, with which model of a
# camera, and how it is printed. Not: places, serial numbers, owners, makers' notes, other blocks.
_PUBLIC: Final = {
    FIRST: {
        *(270, 271, 272, 305, 315, 33432),  # description, make, model, software, artist, copyright
        *(274, 282, 283, 296, 306),  # orientation, density, when it was changed
        *(318, 319, 529, 531, 532),  # white point, primaries, Y Cb Cr
        18246,  # rating
        *range(40091, 40096),  # title, comment, author, keywords, subject, as Windows has them
    },
    DETAILS: {
        *(33434, 33437, 34850, 34855, *range(34864, 34870)),  # exposure, sensitivity
        *(36864, 36867, 36868, 36880, 36881, 36882, 37121, 37122),  # version, dates
        *range(37377, 37387),  # shutter to focal length
        *(37510, 37520, 37521, 37522, 40960, 40961, 40962, 40963),  # comment, parts of seconds
        *(41483, 41486, 41487, 41488, 41492, 41493, 41495),  # sensor
        *(41728, 41729, 41730, *range(41985, 41995), 41996),  # scene
        *(42034, 42035, 42036, 42240),  # lens, gamma
    },
    INTEROPERABILITY: {1, 2},  # which space the colours are in
}
_MOST_SHARED: Final = 4  # times a byte may belong to entries: some programs store equal values once


def public_exif(block: bytes) -> bytes:
    """An EXIF block of the entries that may be shown, empty if there are none or it is damaged."""
    try:
        _check(block)
        given, kept = Image.Exif(), Image.Exif()
        given.load(EXIF_START + block)
        chosen = {
            directory: {tag: value for tag, value in _entries(given, directory) if tag in tags}
            for directory, tags in _PUBLIC.items()
        }
        kept.update(chosen[FIRST])
        if chosen[INTEROPERABILITY]:
            chosen[DETAILS][INTEROPERABILITY] = chosen[INTEROPERABILITY]
        if chosen[DETAILS]:
            kept.get_ifd(DETAILS).update(chosen[DETAILS])
        return kept.tobytes().removeprefix(EXIF_START) if any(chosen.values()) else b""
    except Exception:  # Pillow fails on blocks that make no sense with errors of any kind
        return b""


def _entries(exif: Image.Exif, directory: int) -> list[tuple[int, Any]]:
    """Tags and values of a directory."""
    return list((exif if directory == FIRST else exif.get_ifd(directory)).items())


def _check(block: bytes) -> None:
    """Raise :class:`ValueError` if entries that may be shown hold bytes of others."""
    entries = entries_of(block)
    if sum(entry.stop - entry.start for entry in entries) > _MOST_SHARED * len(block):
        raise ValueError("entries hold the same bytes over and over")
    is_public = [entry.tag in _PUBLIC.get(entry.directory, ()) for entry in entries]
    hidden = np.zeros(len(block) + 1, dtype=bool)
    for entry, shows in zip(entries, is_public, strict=True):
        if not shows:
            hidden[entry.start : entry.stop] = True
    for entry, shows in zip(entries, is_public, strict=True):
        if shows and (entry.stop > len(block) or hidden[entry.start : entry.stop].any()):
            raise ValueError("an entry holds bytes of another")
