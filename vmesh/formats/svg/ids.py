"""Ids of a drawing: short, and its own among all drawings that one HTML page shows.

Ids belong to the page that a drawing is put into, so those of two drawings must differ. They begin
with a digest of what is drawn: the same drawing has the same ids, in which two copies agree. Five
letters and digits tell 768 million drawings apart; that two of 100 begin alike has odds of 6 in a
million. A prefix of the caller's own ends with a hyphen, which no digest and no name has, so that
"a" and "ab" are as different as others.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from itertools import count, product
from string import ascii_letters, digits
from typing import Final

import numpy as np

from vmesh.arrays import UInt8Array
from vmesh.formats.svg.style import Style
from vmesh.mesh import Mesh

_LENGTH: Final = 5
_ALPHABET: Final = ascii_letters + digits


class Ids:
    """Ids of the elements of one drawing.

    Parameters
    ----------
    prefix : str
        What all of them begin with, as of :func:`prefix_of`.
    """

    def __init__(self, prefix: str) -> None:
        self.mask: Final = f"{prefix}_"  # names of gradients have no underscore
        self.gradients: Final = _names(prefix)


def prefix_of(mesh: Mesh, style: Style, rgba: UInt8Array | None) -> str:
    """Beginning of the ids of a drawing: its style's prefix, else a digest of what is drawn.

    Parameters
    ----------
    mesh : Mesh
    style : Style
    rgba : ndarray, optional
        The photograph that gradients are fitted to, shape (h, w, 4), uint8.
    """
    if style.id_prefix is not None:
        return f"{style.id_prefix}-"
    numbers = (mesh.width, mesh.height, mesh.unit, mesh.n_components)
    digest = hashlib.sha256(repr((numbers, style)).encode())
    digest.update(mesh.vertices.astype("<i4", copy=False).tobytes())
    digest.update(mesh.triangles.astype("<i4", copy=False).tobytes())
    digest.update(mesh.plain_colors.tobytes())
    if rgba is not None:
        # Pixels that do not show are not fitted to.
        shows = (rgba[:, :, 3:] > 0) | (mesh.n_components < 4)
        digest.update(np.where(shows, rgba, np.uint8(0)).tobytes())
    return _letters(int.from_bytes(digest.digest(), "big"))


def _letters(number: int) -> str:
    """A number as letters and digits, the first a letter, of which XML wants one."""
    number, first = divmod(number, len(ascii_letters))
    text = ascii_letters[first]
    for _ in range(_LENGTH - 1):
        number, place = divmod(number, len(_ALPHABET))
        text += _ALPHABET[place]
    return text


def _names(prefix: str) -> Iterator[str]:
    """Different names with a prefix, shorter ones first."""
    for length in count(1):
        for letters in product(_ALPHABET, repeat=length):
            yield prefix + "".join(letters)
