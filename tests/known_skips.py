"""Tests may be skipped for few reasons where all that they need should be there.

With ``--only-known-skips`` a test that is skipped for another reason fails and tells it: so that
nothing is left out unseen where a renderer, a browser or Node is missing.
"""

from __future__ import annotations

from collections.abc import Generator
from typing import Final

import pytest

OPTION: Final = "--only-known-skips"

# What no installation changes.
KNOWN: Final = frozenset(
    {
        "root may write everywhere",
        "root may read everywhere",
        "no null device",
        "no files without names in this folder",
    }
)


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the option."""
    parser.addoption(
        OPTION,
        action="store_true",
        help="fail tests that are skipped for a reason that is not in tests/known_skips.py",
    )


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_makereport(
    item: pytest.Item,
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Fail a skipped test."""
    report = yield
    # An expected failure is reported as skipped too.
    if not hasattr(report, "wasxfail"):
        _check(report, item.config)
    return report


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_make_collect_report(
    collector: pytest.Collector,
) -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
    """Fail a file that is skipped as a whole, which pytest-xdist would not even name."""
    report = yield
    _check(report, collector.config)
    return report


def _check(report: pytest.TestReport | pytest.CollectReport, config: pytest.Config) -> None:
    """Make a failure of a skip, unless the option is off or the reason known."""
    if not report.skipped or not config.getoption(OPTION):
        return
    assert isinstance(report.longrepr, tuple)
    reason = report.longrepr[2].removeprefix("Skipped: ")
    if reason not in KNOWN:
        report.outcome = "failed"
        report.longrepr = (
            f"{report.nodeid}: skipped, though all that it needs should be there: {reason}"
        )
