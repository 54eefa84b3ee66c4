"""docs/api.md is what the docstrings say, and has every public name."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import vmesh

ROOT = Path(__file__).parents[2]
REFERENCE = (ROOT / "docs" / "api.md").read_text("utf-8")


def test_the_reference_is_current() -> None:
    command = [sys.executable, "-m", "tools.api_reference", "--check"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, check=False)
    assert done.returncode == 0, done.stderr.decode()


def test_every_public_name_is_in_it_once() -> None:
    assert sorted(re.findall(r"^### (.*)$", REFERENCE, re.MULTILINE)) == sorted(vmesh.__all__)


def test_every_public_name_has_a_docstring() -> None:
    assert not re.search(r"^#{3,4} .*\n+(```py\n[^`]*```\n+)?(#|\Z)", REFERENCE, re.MULTILINE)
