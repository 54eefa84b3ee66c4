"""Sources of a batch: files that are named, files in folders, files of patterns."""

from __future__ import annotations

import glob
import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

# What is taken from a folder; a file that is named, or of a pattern, is taken whatever its name.
PICTURE_SUFFIXES: Final = frozenset(
    (
        *(".png", ".jpg", ".jpeg", ".jpe", ".jfif", ".webp", ".avif", ".tif", ".tiff", ".gif"),
        *(".bmp", ".ppm", ".pgm", ".pbm", ".pnm", ".jp2", ".j2k", ".jpx", ".tga", ".pcx", ".qoi"),
        *(".apng", ".heic", ".heif", ".hif", ".jxl"),
    )
)


@dataclass(frozen=True, slots=True)
class Source:
    """A file to work on.

    Parameters
    ----------
    path : Path
        Where it is.
    name : Path
        Its place below the folder, or below the part of the pattern without wildcards, that it was
        found by: the place of its outputs below theirs.
    """

    path: Path
    name: Path


def find_sources(arguments: Iterable[str], output: str) -> list[Source]:
    """Files that some arguments stand for, each once, in the order of the arguments.

    Folders are searched with the folders below them, in the order of names, for pictures by the
    ending of their names. What is hidden, links to folders and the folder `output` are passed over.

    Raises
    ------
    OSError
        If a folder cannot be read.
    ValueError
        If there are none.
    """
    named = list(arguments)
    found = {
        (source.path.resolve(), source.name): source
        for argument in named
        for source in _expand(argument, output)
    }
    if not found:
        raise ValueError(f"no pictures were found in {', '.join(named)}")
    return list(found.values())


def _expand(argument: str, output: str) -> Iterator[Source]:
    """Files that one argument stands for.

    A pattern that nothing matches, or a file that is not there, is a source that cannot be read.
    """
    named = Path(argument)
    if os.path.lexists(named) or not glob.has_magic(argument):
        matches, base = [named], named if named.is_dir() else named.parent
    else:
        # Path.glob starts at a folder, and would have the pattern cut in two.
        base = _fixed_part(named)
        pattern = Path(glob.escape(str(base)), *named.parts[len(base.parts) :])
        matched = sorted(glob.glob(str(pattern), recursive=True))  # noqa: PTH207
        matches = [Path(match) for match in matched] or [named]
    for match in matches:
        for path in _pictures_in(match, output) if match.is_dir() else [match]:
            yield Source(path, path.relative_to(base))


def _fixed_part(pattern: Path) -> Path:
    """The folders of a pattern before the first wildcard; brackets in names of some are none."""
    fixed = Path()
    for part in pattern.parts:
        if glob.has_magic(part) and not os.path.lexists(fixed / part):
            break
        fixed /= part
    return fixed


def _pictures_in(folder: Path, output: str) -> Iterator[Path]:
    """Pictures in a folder and below it, but not in `output` below it."""
    left_out = Path(output).resolve()
    for place, folders, files in os.walk(folder, onerror=_refuse):
        folders[:] = sorted(
            name
            for name in folders
            if not name.startswith(".") and Path(place, name).resolve() != left_out
        )
        for name in sorted(files):
            path = Path(place, name)
            if not name.startswith(".") and path.suffix.lower() in PICTURE_SUFFIXES:
                yield path


def _refuse(error: OSError) -> None:
    raise error
