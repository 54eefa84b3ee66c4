"""The library as a decoder for conformance.py: ``python -m tools.library_decoder IN OUT``."""

from __future__ import annotations

import sys
from pathlib import Path

import vmesh
from vmesh.codec.text import mesh_text


def main(source: str, target: str) -> int:
    """Decode a file as ``spec/conformance/README.md`` says; the exit status."""
    try:
        mesh = vmesh.loads(Path(source).read_bytes())
        vmesh.export(mesh, f"{target}.pam")
    except vmesh.FormatError as error:
        print(error.code)
        return 1
    except vmesh.LimitError:
        print("limit")
        return 1
    Path(f"{target}.mesh").write_bytes(mesh_text(mesh).encode("ascii"))
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
