from __future__ import annotations

import os
import signal
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

import pytest

from vmesh.files import atomic_output


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
