from __future__ import annotations

import errno
import os
import signal
import subprocess
import sys
import tempfile
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest

from vmesh.files import atomic_output, check_replaceable


def test_a_file_appears_when_its_block_ends(tmp_path: Path) -> None:
    path = tmp_path / "picture.vmesh"
    with atomic_output(path) as stream:
        stream.write(b"new")
        assert not path.exists()
    assert path.read_bytes() == b"new"
    assert list(tmp_path.iterdir()) == [path]


def test_an_earlier_file_is_replaced_only_at_the_end(tmp_path: Path) -> None:
    path = tmp_path / "picture.vmesh"
    path.write_bytes(b"old")
    with atomic_output(str(path)) as stream:
        stream.write(b"new")
        stream.flush()
        assert path.read_bytes() == b"old"
    assert path.read_bytes() == b"new"


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt])
def test_a_failing_block_leaves_the_folder_as_it_was(
    tmp_path: Path, error: type[BaseException]
) -> None:
    path = tmp_path / "picture.vmesh"
    path.write_bytes(b"old")
    with pytest.raises(error), atomic_output(path) as stream:
        stream.write(b"half of the n")
        raise error
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_folder_is_not_written(tmp_path: Path) -> None:
    with pytest.raises(IsADirectoryError), atomic_output(tmp_path):
        pass
    assert list(tmp_path.iterdir()) == []


def test_a_missing_folder_is_an_error_of_the_system(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError), atomic_output(tmp_path / "missing" / "picture.vmesh"):
        pass
    assert list(tmp_path.iterdir()) == []


def test_a_long_name_has_room_for_its_temporary_file(tmp_path: Path) -> None:
    path = tmp_path / ("x" * 249 + ".vmesh")
    with atomic_output(path) as stream:
        stream.write(b"new")
    assert path.read_bytes() == b"new"


def test_a_long_name_of_wide_letters_has_room_for_its_temporary_file(tmp_path: Path) -> None:
    path = tmp_path / ("é" * 120 + ".vmesh")
    with atomic_output(path) as stream:
        stream.write(b"new")
    assert path.read_bytes() == b"new"


def test_a_link_is_followed(tmp_path: Path) -> None:
    path, link = tmp_path / "picture.vmesh", tmp_path / "link.vmesh"
    path.write_bytes(b"old")
    link.symlink_to(path)
    with atomic_output(link) as stream:
        stream.write(b"new")
    assert link.is_symlink()
    assert path.read_bytes() == b"new"


@pytest.mark.skipif(not Path(os.devnull).is_char_device(), reason="no null device")
def test_a_device_is_written_directly() -> None:
    with atomic_output(os.devnull) as stream:
        stream.write(b"new")
    assert Path(os.devnull).is_char_device()


def test_a_replaced_file_keeps_its_mode(tmp_path: Path) -> None:
    target = tmp_path / "file"
    target.write_bytes(b"old")
    target.chmod(0o600)
    with atomic_output(target) as stream:
        stream.write(b"new")
    assert target.stat().st_mode & 0o777 == 0o600


def test_a_missing_folder_is_told_by_the_name_that_was_given(tmp_path: Path) -> None:
    target = tmp_path / "none" / "file"
    with pytest.raises(FileNotFoundError) as caught, atomic_output(target):
        pass
    assert caught.value.filename == str(target)


def has_nameless_files(folder: Path) -> bool:
    with suppress(AttributeError, OSError):
        os.close(os.open(folder, os.O_TMPFILE | os.O_WRONLY))
        return True
    return False


def test_a_killed_process_leaves_the_folder_as_it_was(tmp_path: Path) -> None:
    if not has_nameless_files(tmp_path):
        pytest.skip("no files without names in this folder")
    path = tmp_path / "picture.vmesh"
    path.write_bytes(b"old")
    script = (
        "import sys, time\n"
        "from vmesh.files import atomic_output\n"
        "with atomic_output(sys.argv[1]) as stream:\n"
        "    stream.write(b'half of the n')\n"
        "    stream.flush()\n"
        "    print('written', flush=True)\n"
        "    time.sleep(60)\n"
    )
    command = [sys.executable, "-c", script, str(path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == b"written\n"
        process.send_signal(signal.SIGKILL)
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_full_disk_leaves_the_folder_as_it_was(tmp_path: Path) -> None:
    pytest.importorskip("resource")
    path = tmp_path / "picture.vmesh"
    path.write_bytes(b"old")
    script = (
        "import resource, signal, sys\n"
        "from vmesh.files import atomic_output\n"
        "signal.signal(signal.SIGXFSZ, signal.SIG_IGN)\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))\n"
        "with atomic_output(sys.argv[1]) as stream:\n"
        "    stream.write(bytes(100_000))\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script, str(path)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 1
    assert "OSError" in done.stderr
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


def test_without_nameless_files_nothing_changes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delattr(os, "O_TMPFILE", raising=False)
    path = tmp_path / "picture.vmesh"
    with atomic_output(path) as stream:
        stream.write(b"new")
        assert len(list(tmp_path.iterdir())) == 1
    assert path.read_bytes() == b"new"
    assert list(tmp_path.iterdir()) == [path]


# Systems and file systems that lack what the best way takes.

ERRORS = ["EOPNOTSUPP", "EPERM", "EINVAL", "ENOENT", "EISDIR", "EXDEV", "EIO"]


def refuse(monkeypatch: pytest.MonkeyPatch, name: str, number: int, *, only: int = 0) -> list[str]:
    """Let a function of the system fail, of `os.open` only with some flags; returns its calls."""
    calls: list[str] = []
    whole = getattr(os, name)

    def fail(*arguments: Any, **options: Any) -> Any:
        if only and not (len(arguments) > 1 and arguments[1] & only == only):
            return whole(*arguments, **options)
        calls.append(name)
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(os, name, fail)
    return calls


def check_that_it_is_written(folder: Path) -> None:
    """Write a new file, replace it, and leave it as it is."""
    path = folder / "picture.vmesh"
    for content in (b"new", b"newer and longer", b"short"):
        with atomic_output(path) as stream:
            stream.write(content)
        assert path.read_bytes() == content
    with (
        pytest.raises(FileExistsError, match="left as it is"),
        atomic_output(path, replace=False) as stream,
    ):
        stream.write(b"other")
    assert path.read_bytes() == b"short"
    with atomic_output(folder / "other", replace=False, times=(5, 7 * 10**9)) as stream:
        stream.write(b"other")
    assert (folder / "other").read_bytes() == b"other"
    assert (folder / "other").stat().st_mtime == 7
    assert {path.name for path in folder.iterdir()} == {"picture.vmesh", "other"}


@pytest.mark.parametrize("error", ERRORS)
def test_a_file_system_without_nameless_files_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: str
) -> None:
    if hasattr(os, "O_TMPFILE"):
        refuse(monkeypatch, "open", getattr(errno, error), only=os.O_TMPFILE)
    check_that_it_is_written(tmp_path)


@pytest.mark.parametrize("error", ERRORS)
def test_a_file_system_without_links_is_written_and_no_work_is_lost(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: str
) -> None:
    assert refuse(monkeypatch, "link", getattr(errno, error)) == []
    check_that_it_is_written(tmp_path)


def test_a_system_without_descriptors_as_files_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = os.path.lexists
    monkeypatch.setattr(
        os.path, "lexists", lambda path: not str(path).startswith("/proc") and whole(path)
    )
    calls = refuse(monkeypatch, "link", errno.ENOENT)
    check_that_it_is_written(tmp_path)
    assert len(calls) == 2  # those that shall replace nothing


@pytest.mark.parametrize(("name", "error"), [("fsync", "EINVAL"), ("chmod", "EPERM")])
def test_what_a_file_system_does_not_know_is_left_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, error: str
) -> None:
    calls = refuse(monkeypatch, name, getattr(errno, error))
    check_that_it_is_written(tmp_path)
    assert calls


@pytest.mark.parametrize("error", ["EBUSY", "EPERM", "EXDEV"])
def test_a_file_that_cannot_be_exchanged_is_filled(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: str
) -> None:
    path = tmp_path / "mounted.vmesh"
    path.write_bytes(b"an earlier file, and a long one")
    refuse(monkeypatch, "replace", getattr(errno, error))
    with atomic_output(path) as stream:
        stream.write(b"new")
    assert path.read_bytes() == b"new"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("error", ["EACCES", "EROFS"])
def test_a_file_that_can_be_written_in_a_folder_that_cannot_is_filled(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: str
) -> None:
    path = tmp_path / "mounted.vmesh"
    path.write_bytes(b"an earlier file, and a long one")
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(elsewhere))

    whole = Path.open

    def refused(self: Path, mode: str = "r", *arguments: Any) -> Any:
        if "x" in mode:
            raise OSError(getattr(errno, error), "refused", str(self))
        return whole(self, mode, *arguments)

    monkeypatch.setattr(Path, "open", refused)
    if hasattr(os, "O_TMPFILE"):
        refuse(monkeypatch, "open", errno.EOPNOTSUPP, only=os.O_TMPFILE)
    with atomic_output(path) as stream:
        stream.write(b"new")
        assert path.read_bytes().startswith(b"an earlier")
    assert path.read_bytes() == b"new"
    with pytest.raises(OSError, match="refused"), atomic_output(tmp_path / "new"):
        pass


def test_a_file_that_came_meanwhile_is_left_as_it_is(tmp_path: Path) -> None:
    path = tmp_path / "picture.vmesh"
    with pytest.raises(FileExistsError) as caught, atomic_output(path, replace=False) as stream:
        stream.write(b"ours")
        path.write_bytes(b"theirs")
    assert caught.value.filename == str(path)
    assert path.read_bytes() == b"theirs"
    assert list(tmp_path.iterdir()) == [path]


def test_a_name_of_the_greatest_length_has_room_for_its_temporary_file(tmp_path: Path) -> None:
    path = tmp_path / ("x" * 255)
    with atomic_output(path) as stream:
        stream.write(b"new")
    assert path.read_bytes() == b"new"
    with pytest.raises(OSError, match="too long"), atomic_output(tmp_path / ("x" * 256)):
        pass


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no such device")
def test_an_error_of_a_device_names_it() -> None:
    with pytest.raises(OSError, match="No space") as caught, atomic_output("/dev/full") as stream:
        stream.write(b"new")
    assert caught.value.filename == "/dev/full"


# What is there.


def test_what_may_be_replaced_follows_from_the_request_and_from_who_named_it(
    tmp_path: Path,
) -> None:
    path = tmp_path / "picture.vmesh"
    for overwrite in (None, False, True):
        for is_named in (False, True):
            check_replaceable(path, overwrite=overwrite, is_named=is_named)
    path.touch()
    check_replaceable(path, overwrite=None, is_named=True)
    check_replaceable(path, overwrite=True, is_named=False)
    for overwrite, is_named in ((None, False), (False, True), (False, False)):
        with pytest.raises(FileExistsError, match="left as it is"):
            check_replaceable(path, overwrite=overwrite, is_named=is_named)
    path.chmod(0o444)
    check_replaceable(path, overwrite=True, is_named=True)
    with pytest.raises(PermissionError, match="write-protected"):
        check_replaceable(path, overwrite=None, is_named=True)
    with pytest.raises(IsADirectoryError, match="is a folder"):
        check_replaceable(tmp_path, overwrite=True, is_named=True)
