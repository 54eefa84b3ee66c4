"""Processors that a process may use."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from vmesh import processors


def groups(root: Path, own: str, **files: str) -> Path:
    """A system whose process is in some control groups, with limits in files below their root."""
    for name, text in {"proc/self/cgroup": own, **files}.items():
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return root


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="processes are not bound")
def test_a_bound_process_counts_the_processors_that_it_is_bound_to() -> None:
    before = os.sched_getaffinity(0)
    try:
        os.sched_setaffinity(0, {min(before)})
        assert processors.count_processors() == 1
    finally:
        os.sched_setaffinity(0, before)


@pytest.mark.parametrize(
    ("own", "files", "share"),
    [
        ("0::/user/app\n", {"user/app/cpu.max": "150000 100000\n"}, 1.5),
        (
            "0::/user/app\n",
            {"user/app/cpu.max": "max 100000\n", "user/cpu.max": "50000 100000"},
            0.5,
        ),
        ("0::/user/app\n", {"user/app/cpu.max": "max 100000\n"}, None),
        ("0::/\n", {"cpu.max": "200000 100000\n"}, 2.0),
        ("0::/elsewhere/outside\n", {"cpu.max": "200000 100000\n"}, 2.0),
        ("0::/../../other\n", {"cpu.max": "200000 100000\n"}, 2.0),
        (
            "4:cpu,cpuacct:/docker/1\n",
            {
                "cpu,cpuacct/docker/1/cpu.cfs_quota_us": "300000\n",
                "cpu,cpuacct/docker/1/cpu.cfs_period_us": "100000\n",
            },
            3.0,
        ),
        (
            "4:cpuacct,cpu:/docker/1\n",
            {"cpu/cpu.cfs_quota_us": "100000\n", "cpu/cpu.cfs_period_us": "50000\n"},
            2.0,
        ),
        (
            "4:cpu:/\n",
            {"cpu/cpu.cfs_quota_us": "-1\n", "cpu/cpu.cfs_period_us": "100000\n"},
            None,
        ),
        ("4:memory:/a\n", {"memory/a/cpu.max": "100000 100000\n"}, None),
        ("nonsense\n:::\n", {"cpu.max": "much\n"}, None),
        ("0::/\n", {"cpu.max": "100000 0\n"}, None),
    ],
)
def test_control_groups_of_both_versions_limit_the_share_of_time(
    tmp_path: Path, own: str, files: dict[str, str], share: float | None
) -> None:
    root = groups(tmp_path, own, **{f"sys/fs/cgroup/{name}": text for name, text in files.items()})
    assert processors.quota(root) == share


def test_a_system_without_control_groups_has_no_limit(tmp_path: Path) -> None:
    assert processors.quota(tmp_path) is None


@pytest.mark.parametrize(("share", "expected"), [(0.2, 1), (1.0, 1), (None, 4), (2.5, 3), (9.0, 4)])
def test_a_part_of_a_processor_counts_as_one(
    monkeypatch: pytest.MonkeyPatch, share: float | None, expected: int
) -> None:
    monkeypatch.setattr(processors, "quota", lambda: share)
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0, 1, 2, 3}, raising=False)
    assert processors.count_processors() == expected
