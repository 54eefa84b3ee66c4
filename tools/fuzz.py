"""Try the reader on damaged files whose checksums fit: ``python -m tools.fuzz --runs 100000``.

Files of the conformance folder are changed at random, their lengths and checksums repaired so that
the damage gets past them, and read. Each has to be refused with an error of vmesh or to load as a
valid mesh that can be stored again and drawn.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
import traceback
from collections import Counter
from importlib.util import find_spec
from pathlib import Path
from typing import Final

import click

from tests.codec.mutants import mutants
from tests.codec.trial import try_file

_N_SLOWEST: Final = 5
_BROKEN: Final = "BROKEN"


@click.command()
@click.option("--runs", type=click.IntRange(1), default=10_000, show_default=True)
@click.option("--seed", type=click.IntRange(0), default=0, show_default=True)
@click.option(
    "--keep",
    type=click.Path(path_type=Path, file_okay=False),
    default=Path("fuzz"),
    show_default=True,
    help="Folder for the files that break a promise.",
)
@click.option(
    "--atheris",
    "by_coverage",
    is_flag=True,
    help="Let atheris choose by coverage what to change further; the kernels run uncompiled.",
)
def main(runs: int, seed: int, keep: Path, by_coverage: bool) -> None:
    """Try the reader on damaged files; the status is 1 if one of them breaks a promise."""
    sys.exit(run_atheris(runs, seed, keep) if by_coverage else run(runs, seed, keep))


def run(runs: int, seed: int, keep: Path) -> int:
    """Try files and print a report; the exit status."""
    codes: Counter[str] = Counter()
    slowest: list[tuple[float, int, str]] = []
    began = time.perf_counter()
    for number, (data, is_partial) in enumerate(mutants(runs, seed)):
        start = time.perf_counter()
        try:
            code = try_file(data, allow_partial=is_partial).code
        except Exception:
            code = _BROKEN
            _keep(data, keep / f"{seed}-{number}{'-partial' if is_partial else ''}.vmesh")
        codes[code] += 1
        slowest = sorted([*slowest, (time.perf_counter() - start, len(data), code)])[-_N_SLOWEST:]
    taken = time.perf_counter() - began
    click.echo(f"{runs} files, seed {seed}: {runs / taken:.0f} a second, {codes[_BROKEN]} broken")
    for code, count in codes.most_common():
        click.echo(f"{code:12}{count:9}  {count / runs:7.2%}")
    for seconds, n_bytes, code in reversed(slowest):
        click.echo(f"{1000 * seconds:8.1f} ms  {n_bytes} bytes, {code}")
    return 1 if codes[_BROKEN] else 0


def _keep(data: bytes, path: Path) -> None:
    """Store a file that broke a promise, and say which."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(data)
    click.echo(f"{path}:\n{traceback.format_exc()}", err=True)


def run_atheris(runs: int, seed: int, keep: Path) -> int:
    """Start the fuzzer that is guided by coverage; its exit status."""
    if find_spec("atheris") is None:
        raise click.UsageError("atheris is not installed; it is in the dependency group fuzz")
    keep.mkdir(parents=True, exist_ok=True)
    options = [f"-runs={runs}", f"-seed={seed}", f"-artifact_prefix={keep}{os.sep}"]
    command = [sys.executable, "-m", "tools.fuzz_by_coverage", *options]
    plain = {**os.environ, "NUMBA_DISABLE_JIT": "1"}
    return subprocess.run(command, env=plain, check=False).returncode


if __name__ == "__main__":
    main()
