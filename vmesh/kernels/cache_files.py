"""Files of compiled code, whole or none: what is damaged, foreign or out of date is not there."""

from __future__ import annotations

import os
import pickle
import stat
import tempfile
from hashlib import blake2b
from pathlib import Path
from typing import Any, Final

from numba.core.caching import IndexDataCacheFile, InTreeCacheLocator

_DIGEST_SIZE: Final = 16
_READING: Final = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
_MAX_BYTES: Final = 1 << 26  # a hundred times what the largest kernel takes


class CacheFile(IndexDataCacheFile):  # type: ignore[misc]
    """Numba's files of the compiled code of a function, with a digest in front of their content.

    Machine code of which a byte is wrong would end the process, whether it can be unpickled or not.

    Parameters
    ----------
    cache_path : str
        Folder.
    filename_base : str
        Start of the names.
    source_stamp : object
        Stamp of all sources that the code is made of; code with another one is out of date.
    """

    def _load_index(self) -> dict[Any, str]:
        try:
            version, stamp, index = pickle.loads(_read(self._index_path))
        except Exception:  # Whatever the unpickling of bytes may raise.
            return {}
        is_current = (version, stamp) == (self._version, self._source_stamp)
        return dict(index) if is_current else {}

    def _save_index(self, overloads: dict[Any, str]) -> None:
        self._write(self._index_path, (self._version, self._source_stamp, overloads))

    def _load_data(self, name: str) -> Any:
        try:
            return pickle.loads(_read(self._data_path(name)))
        except Exception as error:
            raise OSError(f"{name} is no compiled code") from error  # Then Numba compiles.

    def _save_data(self, name: str, data: Any) -> None:
        self._write(self._data_path(name), data)

    def _write(self, path: str, content: Any) -> None:
        data = self._dump(content)
        with self._open_for_write(path) as file:
            file.write(_digest(data) + data)


class TemporaryLocator(InTreeCacheLocator):  # type: ignore[misc]
    """Folder for compiled code where no other can be written, such as for a user without a home.

    It is below the system's folder for temporary files, and of this user alone: code that others
    could have put there would be run.
    """

    def get_cache_path(self) -> str:
        """The folder of the function's file."""
        place = Path(tempfile.gettempdir())
        name = self.get_suitable_cache_subpath(self._py_file)
        return str(place / f"vmesh-cache-{os.geteuid()}" / name)

    def ensure_cache_path(self) -> None:
        """Make the folder, and refuse one that others can write or exchange."""
        if not hasattr(os, "geteuid"):
            raise OSError("no users to tell apart")
        folder = Path(self.get_cache_path()).parent
        shared = folder.parent.stat()
        if shared.st_mode & 0o022 and not shared.st_mode & stat.S_ISVTX:
            raise OSError(f"others can exchange what is in {folder.parent}")
        try:
            folder.mkdir(mode=0o700)
        except FileExistsError:
            status = folder.lstat()
            is_ours = stat.S_ISDIR(status.st_mode) and status.st_uid == os.geteuid()
            if not is_ours or status.st_mode & 0o077:
                raise
        super().ensure_cache_path()


def _read(path: str) -> bytes:
    """Content of a whole file; neither a pipe nor a device is waited for.

    Raises
    ------
    OSError
        If it cannot be read.
    ValueError
        If it is no such file, or not as it was written.
    """
    descriptor = os.open(path, _READING)
    with os.fdopen(descriptor, "rb") as file:
        status = os.fstat(descriptor)
        if not stat.S_ISREG(status.st_mode) or status.st_size > _MAX_BYTES:
            raise ValueError(f"{path} is no file of compiled code")
        data = file.read()
    content = data[_DIGEST_SIZE:]
    if data[:_DIGEST_SIZE] != _digest(content):
        raise ValueError(f"{path} is damaged")
    return content


def _digest(content: bytes) -> bytes:
    return blake2b(content, digest_size=_DIGEST_SIZE).digest()
