from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

from vmesh.cli.main import COMMANDS

ROOT = Path(__file__).parents[2]


def test_the_reference_of_the_command_line_is_current() -> None:
    command = [sys.executable, "-m", "tools.cli_reference", "--check"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, check=False, text=True)
    assert done.returncode == 0, done.stderr


def test_the_reference_has_every_command() -> None:
    text = (ROOT / "docs" / "cli.md").read_text("utf-8")
    assert re.findall(r"^## vmesh (\S+)", text, re.MULTILINE) == list(COMMANDS)


def test_commands_and_options_are_completed() -> None:
    script = "import sys\nsys.argv[0] = 'vmesh'\nfrom vmesh.cli.main import main\nmain()\n"
    for words, expected in (("vmesh b", "batch"), ("vmesh batch --sch", "--scheduler")):
        done = subprocess.run(
            [sys.executable, "-c", script],
            env={
                **os.environ,
                "_VMESH_COMPLETE": "bash_complete",
                "COMP_WORDS": words,
                "COMP_CWORD": str(len(words.split()) - 1),
            },
            capture_output=True,
            check=False,
        )
        assert done.stdout.decode().strip().endswith(expected), done.stderr.decode()
