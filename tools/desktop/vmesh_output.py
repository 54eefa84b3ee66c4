#!/usr/bin/env python3
"""Inkscape's way out: the page as pixels, and ``vmesh encode`` on those, to standard output."""

import subprocess
import sys
import tempfile
from pathlib import Path


def main(*arguments: str) -> int:
    """Encode the drawing that is the last argument, with the options before it."""
    *options, drawing = arguments
    # Of Inkscape's own options, such as the identifiers of what is selected, none matters.
    chosen = [option for option in options if option.startswith("--quality=")]
    with tempfile.TemporaryDirectory() as folder:
        pixels = str(Path(folder) / "page.png")
        drawn = subprocess.run(
            ["inkscape", "--export-area-page", f"--export-filename={pixels}", drawing],
            stdout=sys.stderr,  # the file itself goes to standard output
            check=False,
        )
        if drawn.returncode:
            return drawn.returncode
        return subprocess.run(["vmesh", "encode", pixels, "-", *chosen], check=False).returncode


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
