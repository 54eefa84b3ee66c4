"""Writing a file so that it is either whole or not there, and only where that was asked for."""

from __future__ import annotations

import errno
import os
import secrets
import shutil
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO, Final

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
                draft.complete(times)
            draft.take_name(target, replace=replace)
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
    """
    name = os.fspath(path)
    try:
        status = Path(path).stat()
    except OSError:
        return  # Nothing is there, or writing will tell.
    is_stream = not stat.S_ISREG(status.st_mode) and not stat.S_ISDIR(status.st_mode)
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

    On Linux it has no name at first: then nothing is left of it if the process is killed.
    """

    SUFFIX: Final = ".part"

    def __init__(self, target: Path) -> None:
        self.path: Path | None = None
        self._new_path = target.with_name(f".{secrets.token_hex(8)}{self.SUFFIX}")
        self.stream = self._nameless() or self._named()

    def _nameless(self) -> BinaryIO | None:
        """A file without a name, if the system has such, and can name them afterwards."""
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
        self.path = self._new_path
        return stream

    def complete(self, times: Times | None) -> None:
        """See to it that all is on the disk, under a name."""
        self.stream.flush()
        if times is not None and os.utime in os.supports_fd:
            with suppress(OSError):
                os.utime(self.stream.fileno(), ns=times)
        _sync(self.stream)
        if self.path is None:
            try:
                # Only with a descriptor does Python follow the path; which does not matter.
                os.link(_descriptor(self.stream), self._new_path, src_dir_fd=self.stream.fileno())
                self.path = self._new_path
            except OSError:
                self._copy(times)
        elif times is not None and os.utime not in os.supports_fd:
            with suppress(OSError):
                os.utime(self.path, ns=times)

    def _copy(self, times: Times | None) -> None:
        """Copy what cannot be named to a file with a name."""
        self.stream.seek(0)
        with self._named() as copy:
            shutil.copyfileobj(self.stream, copy)
            copy.flush()
            if times is not None:
                with suppress(OSError):
                    os.utime(copy.fileno(), ns=times)
            _sync(copy)

    def take_name(self, target: Path, *, replace: bool) -> None:
        """Take the name of the output."""
        assert self.path is not None
        if not replace:
            self._take_new_name(target)
            return
        if target.exists():
            with suppress(OSError):  # Some file systems have no modes.
                self.path.chmod(stat.S_IMODE(target.stat().st_mode))
        try:
            self.path.replace(target)
        except OSError as error:
            if error.errno not in _NOT_EXCHANGED or not target.is_file():
                raise
            _fill(target, self.path)

    def _take_new_name(self, target: Path) -> None:
        """Take a name that nothing else has, also where files have only one."""
        assert self.path is not None
        try:
            os.link(self.path, target)
        except FileExistsError:
            raise _is_there(target) from None
        except OSError:
            try:
                target.open("xb").close()
            except FileExistsError:
                raise _is_there(target) from None
            self.path.replace(target)

    def discard(self) -> None:
        """Leave nothing behind but what has taken its name."""
        if self.path is not None:
            with suppress(OSError):
                self.path.unlink()


def _is_there(target: Path) -> FileExistsError:
    return FileExistsError(errno.EEXIST, "is there already and was left as it is", str(target))


def _descriptor(stream: BinaryIO) -> str:
    """The path by which an open file can be linked to."""
    return f"/proc/self/fd/{stream.fileno()}"


def _sync(stream: BinaryIO) -> None:
    try:
        os.fsync(stream.fileno())
    except OSError as error:
        if error.errno not in _NOT_SYNCED:
            raise


def _fill(target: Path, source: Path) -> None:
    """Copy a file's bytes into another one that cannot be exchanged."""
    with source.open("rb") as read, target.open("r+b") as written:
        shutil.copyfileobj(read, written)
        written.truncate()
