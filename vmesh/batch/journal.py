"""Journal of a folder of outputs: what they were made of, for the next batch to compare."""

from __future__ import annotations

import json
import os
import stat
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Final

from vmesh.files import atomic_output

NAME: Final = ".vmesh-batch.jsonl"
_MAX_BYTES: Final = 1 << 28
_READING: Final = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0)


@dataclass(frozen=True, slots=True)
class Origin:
    """Origin of an output, as far as it can be compared.

    Parameters
    ----------
    size : int
        Of the source, in bytes.
    mtime_ns : int
        When the source was changed, in nanoseconds.
    recipe : str
        Digest of the settings; empty if they are not known.
    """

    size: int
    mtime_ns: int
    recipe: str

    def is_of(self, other: Origin) -> bool:
        """Check: true if this is the other one as far as it is known."""
        same_file = (self.size, self.mtime_ns) == (other.size, other.mtime_ns)
        return same_file and self.recipe in ("", other.recipe)


class Journal:
    """Origins of the outputs in a folder, kept in it in a hidden file, a line of JSON for each.

    Lines are only added, so that a batch that is stopped at any time loses none, and the last one
    of an output counts. The file is a help and no more: without it, or where it is damaged, an
    output counts by its time.

    Parameters
    ----------
    folder : str
        Folder of the outputs; it need not be there yet.
    """

    def __init__(self, folder: str) -> None:
        self._folder = Path(folder)
        self._path = self._folder / NAME
        self._origins, n_lines = _read(self._path)
        if n_lines > 100 + 2 * len(self._origins):
            self._rewrite()

    def origin(self, target: Path) -> Origin | None:
        """Origin of an output, if it is known."""
        return self._origins.get(self._name(target))

    def add(self, origins: Mapping[Path, Origin]) -> None:
        """Note origins of outputs that are there; where nothing can be noted that is no error."""
        lines = []
        for target, origin in origins.items():
            name = self._name(target)
            if self._origins.get(name) != origin:
                self._origins[name] = origin
                lines.append(_line(name, origin))
        if lines:
            with suppress(OSError), self._path.open("ab") as file:
                # A line that was cut off before ends here.
                file.write(b"".join(lines) if _ends_well(self._path) else b"\n" + b"".join(lines))

    def _name(self, target: Path) -> str:
        return Path(os.path.relpath(target, self._folder)).as_posix()

    def _rewrite(self) -> None:
        """Leave out what later lines have overruled, and outputs that are gone."""
        there = {
            name: origin
            for name, origin in self._origins.items()
            if os.path.lexists(self._folder / name)
        }
        with suppress(OSError), atomic_output(self._path) as stream:
            for name, origin in there.items():
                stream.write(_line(name, origin))
        self._origins = there


def _line(name: str, origin: Origin) -> bytes:
    return json.dumps({"output": name, **asdict(origin)}).encode() + b"\n"


def _read(path: Path) -> tuple[dict[str, Origin], int]:
    """Origins by the names of their outputs, and the number of lines; what is damaged is left out.

    Nothing that is no ordinary file is waited for.
    """
    origins: dict[str, Origin] = {}
    lines: list[bytes] = []
    with suppress(OSError), os.fdopen(os.open(path, _READING), "rb") as file:
        status = os.fstat(file.fileno())
        if stat.S_ISREG(status.st_mode) and status.st_size <= _MAX_BYTES:
            lines = file.read().splitlines()
    for line in lines:
        with suppress(ValueError, TypeError, KeyError, RecursionError):
            name, origin = _parse(json.loads(line))
            origins[name] = origin
    return origins, len(lines)


def _parse(entry: dict[str, Any]) -> tuple[str, Origin]:
    """Name of an output and its origin."""
    name = entry["output"]
    origin = Origin(entry["size"], entry["mtime_ns"], entry["recipe"])
    kinds = (name, str), (origin.size, int), (origin.mtime_ns, int), (origin.recipe, str)
    if not all(isinstance(value, kind) for value, kind in kinds):
        raise TypeError(f"expected an entry of the journal, got {entry!r}")
    return name, origin


def _ends_well(path: Path) -> bool:
    """Check of a file: true if it is empty or ends with a whole line."""
    with path.open("rb") as file:
        if file.seek(0, os.SEEK_END) == 0:
            return True
        file.seek(-1, os.SEEK_END)
        return file.read() == b"\n"
