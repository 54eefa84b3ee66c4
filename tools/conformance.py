"""Run any decoder of .vmesh files over the conformance files and say where it departs from them."""

from __future__ import annotations

import hashlib
import json
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any, Final

import click

FOLDER: Final = Path(__file__).parents[1] / "spec" / "conformance"


@click.command()
@click.option(
    "--decoder",
    required=True,
    help="Command line with {in} and {out}; spec/conformance/README.md says what it is to do.",
)
@click.option("--match", default="", help="Only files whose names contain this.")
@click.option(
    "--timeout", type=float, default=60.0, show_default=True, help="Seconds allowed for a file."
)
@click.option(
    "--folder",
    type=click.Path(path_type=Path, exists=True, file_okay=False),
    default=FOLDER,
    help="Folder of the files and their manifest.",
)
def main(decoder: str, match: str, timeout: float, folder: Path) -> None:
    """Run a decoder over the conformance files; the status is 1 if it fails one of them."""
    if "{in}" not in decoder or "{out}" not in decoder:
        raise click.UsageError("expected a decoder with {in} and {out}")
    manifest = json.loads((folder / "manifest.json").read_text(encoding="utf-8"))
    entries = [entry for entry in manifest["files"] if match in entry["file"]]
    if not entries:
        raise click.UsageError(f"no file has {match!r} in its name")
    n_failed = 0
    for entry in entries:
        complaint = try_file(decoder, folder, entry, timeout)
        if complaint:
            n_failed += 1
            click.echo(f"FAILED {entry['file']}: {complaint}")
    click.echo(f"{len(entries) - n_failed} of {len(entries)} files as expected")
    sys.exit(1 if n_failed else 0)


def try_file(decoder: str, folder: Path, entry: dict[str, Any], timeout: float) -> str:
    """Fault of what a decoder makes of a file; nothing if it is as expected."""
    path = folder / entry["file"]
    if sha256(path) != entry["sha256"]:
        return "the file itself is not the one of the manifest"
    with tempfile.TemporaryDirectory() as temporary:
        out = Path(temporary) / "out"
        command = [
            part.replace("{in}", str(path)).replace("{out}", str(out))
            for part in shlex.split(decoder)
        ]
        try:
            done = subprocess.run(
                command, capture_output=True, text=True, timeout=timeout, check=False
            )
        except subprocess.TimeoutExpired:
            return f"no answer within {timeout:g} s"
        code = (done.stdout.splitlines() or [""])[-1]
        made = sorted(found.name for found in Path(temporary).iterdir())
        if done.returncode == 1 and code == "limit" and entry.get("or_limit"):
            return f"files were left: {', '.join(made)}" if made else ""
        if "error" in entry:
            return check_refusal(entry["error"], done, code, made)
        return check_files(entry, done, out)


def check_refusal(
    expected: str, done: subprocess.CompletedProcess[str], code: str, made: list[str]
) -> str:
    """Fault of an answer to an invalid file; nothing if there is none."""
    if done.returncode != 1:
        return f"expected status 1 and the code {expected}, got status {done.returncode}"
    if code != expected:
        return f"expected the code {expected}, got {code!r}"
    return f"files were left: {', '.join(made)}" if made else ""


def check_files(entry: dict[str, Any], done: subprocess.CompletedProcess[str], out: Path) -> str:
    """Fault of an answer to a valid file; nothing if there is none."""
    if done.returncode != 0:
        said = (done.stdout + done.stderr).strip().splitlines() or ["nothing"]
        return f"expected status 0, got {done.returncode} and {said[-1]!r}"
    mesh, picture = out.with_suffix(".mesh"), out.with_suffix(".pam")
    if not mesh.exists():
        return "no mesh was written"
    if sha256(mesh) != entry["mesh_sha256"]:
        return "another mesh was decoded"
    wanted = entry.get("picture_sha256")
    if wanted and picture.exists() and sha256(picture) != wanted:
        return "another picture was drawn"
    return ""


def sha256(path: Path) -> str:
    """The SHA-256 of a file, in hexadecimal digits."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


if __name__ == "__main__":
    main()
