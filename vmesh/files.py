"""Writing a file so that it is either whole or not there."""

from __future__ import annotations

import os
import secrets
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO


@contextmanager
def atomic_output(path: str | os.PathLike[str]) -> Iterator[BinaryIO]:
    """A binary file that takes its name only when the block ends without an error.

    What is written goes to a new file in the same folder, which is renamed at the end: an earlier
    file of that name stays untouched until then, and a failed block leaves nothing behind; on Linux
    a killed process does not either. A device or a pipe is written directly.
    """
    named = Path(path)
    if named.is_dir():
        raise IsADirectoryError(f"{os.fspath(path)} is a folder")
    if named.exists() and not named.is_file():
        with named.open("wb") as stream:
            yield stream
        return
    target = named.resolve()
    temporary = target.with_name(f".{secrets.token_hex(8)}.part")
    try:
        with _open_new(temporary) as stream:
            yield stream
            stream.flush()
            os.fsync(stream.fileno())
            if not temporary.exists():
                # Only with a descriptor does Python follow the path; which one does not matter.
                opened = f"/proc/self/fd/{stream.fileno()}"
                os.link(opened, temporary, src_dir_fd=stream.fileno())
        if target.exists():
            temporary.chmod(stat.S_IMODE(target.stat().st_mode))
        temporary.replace(target)
    except BaseException as error:
        if isinstance(error, OSError) and error.filename in (None, str(temporary)):
            error.filename = os.fspath(path)
        with suppress(OSError):
            temporary.unlink()
        raise


def _open_new(path: Path) -> BinaryIO:
    """A new file, without its name as yet where the system has files without names.

    Nothing is left of such a file if the process is killed.
    """
    if hasattr(os, "O_TMPFILE"):
        with suppress(OSError):  # The file system may have none.
            return os.fdopen(os.open(path.parent, os.O_TMPFILE | os.O_WRONLY, 0o666), "wb")
    return path.open("xb")
