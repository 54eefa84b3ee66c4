"""Sources of a command: files that are named, files in folders, files of patterns."""

from __future__ import annotations

import glob
import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from vmesh.codec.layout import FILE_SUFFIX
from vmesh.errors import shown

# What is taken from a folder; a file that is named, or of a pattern, is taken whatever its name.
PICTURE_SUFFIXES: Final = frozenset(
    (
        *(".png", ".jpg", ".jpeg", ".jpe", ".jfif", ".webp", ".avif", ".tif", ".tiff", ".gif"),
        *(".bmp", ".ppm", ".pgm", ".pbm", ".pnm", ".jp2", ".j2k", ".jpx", ".tga", ".pcx", ".qoi"),
    )
)


@dataclass(frozen=True, slots=True)
class Kind:
    """Files that are taken from a folder.

    Parameters
    ----------
    name : str
        What they are, for messages.
    suffixes : frozenset of str
        Endings of their names, in small letters.
    """

    name: str
    suffixes: frozenset[str]


PICTURES: Final = Kind("pictures", PICTURE_SUFFIXES)
MESHES: Final = Kind(f"{FILE_SUFFIX} files", frozenset((FILE_SUFFIX,)))
# Of a picture and a mesh that differ in their endings alone, the picture.
PICTURES_AND_MESHES: Final = Kind(
    f"pictures and {FILE_SUFFIX} files", PICTURES.suffixes | MESHES.suffixes
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


@dataclass(frozen=True, slots=True)
class Found:
    """Files that some arguments stand for.

    Parameters
    ----------
    sources : list of Source
        Each once, in the order of the arguments.
    passed_over : list of Path
        Other files in the folders, but for those that differ in their endings alone from a source
        beside them.
    """

    sources: list[Source]
    passed_over: list[Path]


def find_sources(arguments: Iterable[str], output: str | None, kind: Kind) -> Found:
    """Files that some arguments stand for.

    Folders are searched with the folders below them, in the order of names, for files of a kind by
    the ending of their names. What is hidden, links to folders and the folder `output` are passed
    over, and so is a mesh beside the picture that it seems to be of.

    Raises
    ------
    OSError
        If a folder cannot be read.
    ValueError
        If there are none.
    """
    named = list(arguments)
    passed_over: list[Path] = []
    found = {
        (source.path.resolve(), source.name): source
        for argument in named
        for source in _expand(argument, output, kind, passed_over)
    }
    if not found:
        endings = ", ".join(sorted({shown(path.suffix) or path.name for path in passed_over})[:5])
        only = f", only others such as {endings}" if endings else ""
        raise ValueError(f"no {kind.name} were found in {', '.join(map(shown, named))}{only}")
    return Found(list(found.values()), passed_over)


def _expand(
    argument: str, output: str | None, kind: Kind, passed_over: list[Path]
) -> Iterator[Source]:
    """Files that one argument stands for; adds those that are passed over.

    A pattern that nothing matches, or a file that is not there, is a source that cannot be read.
    """
    named = Path(argument)
    if os.path.lexists(named) or not glob.has_magic(argument):
        matches, base = [named], named if named.is_dir() else named.parent
    else:
        # Path.glob starts at a folder, and would have the pattern cut in two.
        matched = sorted(glob.glob(argument, recursive=True))  # noqa: PTH207
        matches = [Path(match) for match in matched] or [named]
        base = _fixed_part(named)
    for match in matches:
        taken = _files_in(match, output, kind, passed_over) if match.is_dir() else [match]
        for path in taken:
            yield Source(path, path.relative_to(base))


def _fixed_part(pattern: Path) -> Path:
    """The folders of a pattern before the first wildcard."""
    n_fixed = next(n for n, part in enumerate(pattern.parts) if glob.has_magic(part))
    return Path(*pattern.parts[:n_fixed])


def _files_in(
    folder: Path, output: str | None, kind: Kind, passed_over: list[Path]
) -> Iterator[Path]:
    """Files of a kind in a folder and below it, but not in `output` below it."""
    left_out = None if output is None else Path(output).resolve()
    for place, folders, files in os.walk(folder, onerror=_refuse):
        folders[:] = sorted(
            name
            for name in folders
            if not name.startswith(".") and Path(place, name).resolve() != left_out
        )
        paths = [Path(place, name) for name in sorted(files) if not name.startswith(".")]
        taken = [path for path in paths if path.suffix.lower() in kind.suffixes]
        pictured = {path.stem for path in taken if path.suffix.lower() != FILE_SUFFIX}
        yield from (
            path
            for path in taken
            if path.suffix.lower() != FILE_SUFFIX or path.stem not in pictured
        )
        stems = {path.stem for path in taken}
        passed_over += [path for path in paths if path.stem not in stems]


def _refuse(error: OSError) -> None:
    raise error
