"""The photographs that a benchmark measures on: those of a folder."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import click

from vmesh.arrays import UInt8Array
from vmesh.formats.picture.conversion import flatten
from vmesh.formats.picture.picture import read_picture

_SUFFIXES: Final = (".png", ".jpg", ".jpeg")


@dataclass(frozen=True, slots=True)
class Photograph:
    """A picture to measure on: its name, and its pixels of shape (h, w, 3), uint8."""

    name: str
    pixels: UInt8Array

    @property
    def n_pixels(self) -> int:
        """Width times height."""
        height, width = self.pixels.shape[:2]
        return int(height * width)


def load_photographs(
    folder: Path, limit: int | None = None, names: Sequence[str] | None = None
) -> list[Photograph]:
    """Photographs of a folder as RGB, by name: the first ones, or some names only, where given."""
    paths = sorted(path for path in folder.iterdir() if path.suffix.lower() in _SUFFIXES)
    paths = [path for path in paths if names is None or path.stem in names][:limit]
    if not paths:
        raise click.UsageError(f"{folder}: no photographs that end in {', '.join(_SUFFIXES)}")
    return [_load(path) for path in paths]


def _load(path: Path) -> Photograph:
    with path.open("rb") as stream:
        return Photograph(path.stem, flatten(read_picture(stream).array))


def n_pictures(n: int) -> str:
    """A number of pictures, in words for a caption."""
    return f"{n} picture{'s' * (n != 1)}"
