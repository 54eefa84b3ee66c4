#!/usr/bin/env python3
"""Inkscape's way in: ``vmesh to-svg`` on the file that it names, to standard output."""

import subprocess
import sys

if __name__ == "__main__":
    sys.exit(subprocess.run(["vmesh", "to-svg", sys.argv[-1], "-"], check=False).returncode)
