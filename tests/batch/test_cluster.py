from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

import pytest

import vmesh
from tests.batch.pictures import write_pictures
from tests.cli.program import fail
from vmesh.arrays import UInt8Array

ROOT = Path(__file__).parents[2]

needs_distributed = pytest.mark.skipif(
    find_spec("distributed") is None, reason="the package distributed is not installed"
)


@pytest.fixture
def cluster() -> Iterator[tuple[str, list[int]]]:
    """Address of a cluster, and the process of each of its two workers."""
    with subprocess.Popen(
        [sys.executable, "-m", "tests.batch.cluster"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        cwd=ROOT,
    ) as process:
        assert process.stdout is not None
        address, *workers = process.stdout.readline().decode().split()
        yield address, [int(worker) for worker in workers]
        assert process.stdin is not None
        process.stdin.close()
        process.wait()


@needs_distributed
def test_a_worker_that_is_killed_loses_nothing(
    cluster: tuple[str, list[int]], tmp_path: Path, chelsea: UInt8Array
) -> None:
    address, workers = cluster
    sources = write_pictures(tmp_path / "photos", chelsea, 12)
    (tmp_path / "photos" / "bad.png").write_text("this is not an image")
    command = [sys.executable, "-m", "vmesh", "batch", "photos", "-o", "out", "--json"]
    with subprocess.Popen(
        [*command, "-e", "1", "--vertices", "60", "--scheduler", address],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    ) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        lines = [process.stdout.readline()]
        os.kill(workers[0], signal.SIGTERM if sys.platform == "win32" else signal.SIGKILL)
        lines += process.stdout.readlines()
        errors = process.stderr.read().decode()
    assert process.returncode == 1
    statuses = {line["source"]: line["status"] for line in map(json.loads, lines)}
    bad = str(tmp_path / "photos" / "bad.png")
    assert statuses == {**{str(path): "done" for path in sources}, bad: "failed"}
    assert errors == f"vmesh: {bad}: not an image in a format that can be read\n"
    assert all(vmesh.load(tmp_path / "out" / f"{path.stem}.vmesh") for path in sources)


def test_processes_and_a_cluster_at_once_are_wrong_usage(tmp_path: Path) -> None:
    text = fail(2, "batch", tmp_path, "-o", tmp_path, "-j", "2", "--scheduler", "tcp://localhost:1")
    assert "-j is for this machine" in text


def test_a_missing_package_is_told(tmp_path: Path, chelsea: UInt8Array) -> None:
    write_pictures(tmp_path, chelsea, 1)
    script = (
        "import sys\nsys.modules['distributed'] = None\nfrom vmesh.cli.main import main\nmain()\n"
    )
    arguments = ["batch", str(tmp_path), "-o", str(tmp_path), "--scheduler", "tcp://localhost:1"]
    done = subprocess.run(
        [sys.executable, "-c", script, *arguments], capture_output=True, check=False, text=True
    )
    expected = "vmesh: --scheduler needs the package distributed: pip install 'vmesh[dask]'\n"
    assert (done.returncode, done.stderr) == (1, expected)
