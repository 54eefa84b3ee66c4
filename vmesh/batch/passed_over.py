"""Files that a batch passes over in folders, so that nobody misses them unawares."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Final

from vmesh.batch.sources import Source
from vmesh.codec.layout import FILE_SUFFIX

_N_NAMED: Final = 4


def describe_passed_over(
    arguments: Iterable[str], output: str, sources: Iterable[Source]
) -> str | None:
    """A sentence about files in named folders that are no sources, None if there are none.

    What is hidden, meshes and the folder `output` are not counted.
    """
    taken = {source.path for source in sources}
    others = [
        path
        for argument in dict.fromkeys(arguments)
        for path in _files_in(Path(argument), Path(output).resolve())
        if path not in taken
    ]
    if not others:
        return None
    names = [path.name if path.name.isprintable() else ascii(path.name) for path in others]
    count = "1 file that is no picture" if len(names) == 1 else f"{len(names)} files, no pictures"
    more = ", ..." if len(names) > _N_NAMED else ""
    return f"passed over {count}: {', '.join(names[:_N_NAMED])}{more}"


def _files_in(folder: Path, output: Path) -> Iterator[Path]:
    """Files in a folder and below it, in the order in which sources are searched."""
    for place, folders, files in os.walk(folder):
        folders[:] = sorted(
            name
            for name in folders
            if not name.startswith(".") and Path(place, name).resolve() != output
        )
        for name in sorted(files):
            if not name.startswith(".") and Path(name).suffix.lower() != FILE_SUFFIX:
                yield Path(place, name)
