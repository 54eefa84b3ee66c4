"""Writing a file so that it is either whole or not there, and only where that was asked for."""

from __future__ import annotations

import errno
import os
import secrets
import shutil
import stat
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO, Final, cast

# What a file system says that cannot exchange a file, such as one that is mounted by itself.
_NOT_EXCHANGED: Final = (errno.EBUSY, errno.EPERM, errno.EACCES, errno.EXDEV)
# What fsync says where there is no such thing.
_NOT_SYNCED: Final = (errno.EINVAL, errno.ENOSYS, errno.EOPNOTSUPP)

Times = tuple[int, int]
"""Times of access and of change of a file, in nanoseconds."""


@contextmanager
def atomic_output(
    path: str | os.PathLike[str], *, replace: bool = True, times: Times | None = None
) -> Iterator[BinaryIO]:
    """A binary file that takes its name only when the block ends without an error.

    What is written goes to a new file in the same folder, which is renamed at the end: an earlier
    file of that name stays untouched until then, and a failed block leaves nothing behind; on Linux
    a killed process does not either. A device or a pipe is written directly. Where the system or
    the file system lacks what that takes, the file is written all the same, by the next best way.

    Parameters
    ----------
    path : str or path-like
        Name of the file; a link is followed.
    replace : bool, optional
        Whether an earlier file of that name gives way.
    times : tuple of int, optional
        Times of access and of change that the file gets, in nanoseconds.

    Yields
    ------
    binary file

    Raises
    ------
    OSError
        If it cannot be written; a FileExistsError if there is a file that may not be replaced.
    """
    named = Path(path)
    if named.is_dir():
        raise IsADirectoryError(f"{os.fspath(path)} is a folder")
    try:
        if named.exists() and not named.is_file():
            with named.open("wb") as stream:
                yield stream
            return
        # Only of links: the path from the root may be longer than is allowed.
        target = Path(os.path.realpath(named)) if named.is_symlink() else named
        draft = _Draft(target)
        try:
            with draft.stream:
                yield draft.stream
                draft.complete(times, replace=replace)
            draft.take_name(replace=replace)
        finally:
            draft.discard()
    except OSError as error:
        if error.filename is None or Path(os.fsdecode(error.filename)).suffix == _Draft.SUFFIX:
            error.filename, error.filename2 = os.fspath(path), None
        raise


def times_of(path: str | os.PathLike[str]) -> Times | None:
    """Times of a file; None of one that is not there."""
    try:
        status = Path(path).stat()
    except OSError:
        return None
    return status.st_atime_ns, status.st_mtime_ns


def check_replaceable(
    path: str | os.PathLike[str], *, overwrite: bool | None, is_named: bool
) -> None:
    """Check of an output before time is spent on it: whether what has its name may go.

    Parameters
    ----------
    path : str or path-like
    overwrite : bool, optional
        What was asked for: to replace whatever is there, or nothing. Unless given, only what was
        named, and is not protected from writing.
    is_named : bool
        Whether the user named it, as against a name that was derived from another.

    Raises
    ------
    FileExistsError
        If it is there, and stays.
    PermissionError
        If it is protected, and stays.
    IsADirectoryError
        If it is a folder.
    """
    name = os.fspath(path)
    try:
        status = Path(path).stat()
    except OSError:
        return  # Nothing is there, or writing will tell.
    if stat.S_ISDIR(status.st_mode):
        raise IsADirectoryError(f"{name} is a folder")
    is_stream = not stat.S_ISREG(status.st_mode)
    if overwrite or (is_stream and is_named):
        return
    if overwrite is not None or not is_named:
        hint = "" if overwrite is not None else "; --overwrite replaces it"
        raise FileExistsError(errno.EEXIST, f"is there already and was left as it is{hint}", name)
    # Root may write what is protected, and yet it was protected.
    if not status.st_mode & 0o222 or not os.access(path, os.W_OK):
        raise PermissionError(
            errno.EACCES, "is write-protected and was left as it is; --overwrite replaces it", name
        )


class _Draft:
    """The new file of an output, until it has taken its name.

    On Linux it has no name at first: then nothing is left of it if the process is killed. Where its
    folder cannot be written, but the file that it replaces, it is elsewhere until it is copied.
    """

    SUFFIX: Final = ".part"

    def __init__(self, target: Path) -> None:
        self._target = target
        self._path: Path | None = None
        self._new_path = target.with_name(f".{secrets.token_hex(8)}{self.SUFFIX}")
        self.stream = self._nameless() or self._named_or_elsewhere()

    def _nameless(self) -> BinaryIO | None:
        """A file without a name, if the system has such and can name them afterwards."""
        if not hasattr(os, "O_TMPFILE"):
            return None
        with suppress(OSError):  # The file system may have none.
            folder = self._new_path.parent
            stream = os.fdopen(os.open(folder, os.O_TMPFILE | os.O_RDWR, 0o666), "w+b")
            if os.path.lexists(_descriptor(stream)):
                return stream
            stream.close()
        return None

    def _named(self) -> BinaryIO:
        stream = self._new_path.open("x+b")
        self._path = self._new_path
        return stream

    def _named_or_elsewhere(self) -> BinaryIO:
        try:
            return self._named()
        except OSError:
            if not self._target.is_file() or not os.access(self._target, os.W_OK):
                raise
            return cast("BinaryIO", tempfile.TemporaryFile())

    def complete(self, times: Times | None, *, replace: bool) -> None:
        """See to it that all is on the disk, under some name."""
        self.stream.flush()
        _set_times(self.stream, times)
        _sync(self.stream)
        if self._path is not None:
            return
        try:
            # Only with a descriptor does Python follow the path; which does not matter.
            os.link(_descriptor(self.stream), self._new_path, src_dir_fd=self.stream.fileno())
            self._path = self._new_path
        except (OSError, NotImplementedError):
            self.stream.seek(0)
            with self._copy(replace=replace) as copy:
                shutil.copyfileobj(self.stream, copy)
                copy.truncate()
                copy.flush()
                _set_times(copy, times)
                _sync(copy)

    def _copy(self, *, replace: bool) -> BinaryIO:
        """A file to copy the draft to, which cannot be given a name."""
        try:
            return self._named()
        except OSError:
            if not replace or not self._target.is_file():
                raise
            return self._target.open("r+b")

    def take_name(self, *, replace: bool) -> None:
        """Take the name of the output."""
        if self._path is None:
            return  # It was copied there.
        if not replace:
            self._take_new_name(self._path)
            return
        if self._target.exists():
            with suppress(OSError):  # Some file systems have no modes.
                self._path.chmod(stat.S_IMODE(self._target.stat().st_mode))
        try:
            self._path.replace(self._target)
        except OSError as error:
            if error.errno not in _NOT_EXCHANGED or not self._target.is_file():
                raise
            with self._path.open("rb") as read, self._target.open("r+b") as written:
                shutil.copyfileobj(read, written)
                written.truncate()

    def _take_new_name(self, path: Path) -> None:
        """Take a name that nothing else has, also where a file can have only one."""
        try:
            os.link(path, self._target)
        except FileExistsError:
            raise self._is_there() from None
        except OSError:
            try:
                self._target.open("xb").close()
            except FileExistsError:
                raise self._is_there() from None
            try:
                path.replace(self._target)
            except OSError:
                self._target.unlink()
                raise

    def _is_there(self) -> FileExistsError:
        text = "is there already and was left as it is"
        return FileExistsError(errno.EEXIST, text, os.fspath(self._target))

    def discard(self) -> None:
        """Leave nothing behind but what has taken its name."""
        if self._path is not None:
            with suppress(OSError):
                self._path.unlink()


def _descriptor(stream: BinaryIO) -> str:
    """The path by which an open file can be linked to."""
    return f"/proc/self/fd/{stream.fileno()}"


def _set_times(stream: BinaryIO, times: Times | None) -> None:
    if times is not None:
        with suppress(OSError):  # They are no reason to lose the file.
            os.utime(stream.fileno() if os.utime in os.supports_fd else stream.name, ns=times)


def _sync(stream: BinaryIO) -> None:
    try:
        os.fsync(stream.fileno())
    except OSError as error:
        if error.errno not in _NOT_SYNCED:
            raise
