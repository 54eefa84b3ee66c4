"""The code samples of a document, and what it says that they print."""

from __future__ import annotations

import doctest
import io
import os
import re
import subprocess
from collections.abc import Iterator
from contextlib import redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from tests.programs import place_vmesh

_BLOCK: Final = re.compile(r"^```(sh|python|text)\n(.*?)^```$", re.DOTALL | re.MULTILINE)


@dataclass(frozen=True, slots=True)
class Sample:
    """A sample in a language, the line where it begins, and its output; none is no claim."""

    language: str
    line: int
    code: str
    output: str | None

    def check(self, printed: str) -> None:
        """Fail unless this is what the document says, where ``...`` stands for anything."""
        wanted = self.output or ""
        flags = doctest.ELLIPSIS
        if not doctest.OutputChecker().check_output(wanted, printed, flags):
            raise AssertionError(f"line {self.line}: expected\n{wanted}\ngot\n{printed}")


def samples_of(document: str) -> Iterator[Sample]:
    """Samples in the order of a Markdown document; blocks of text are the output of the last."""
    blocks = [
        (found[1], document.count("\n", 0, found.start()) + 1, found[2])
        for found in _BLOCK.finditer(document)
    ]
    for (language, line, code), following in zip(blocks, [*blocks[1:], None], strict=True):
        if language != "text":
            is_told = following is not None and following[0] == "text"
            yield Sample(language, line, code, following[2] if is_told and following else None)


class Runner:
    """Runs samples one after the other in a folder; Python ones share their names."""

    def __init__(self, folder: Path) -> None:
        self.names: dict[str, Any] = {}
        programs = folder / ".programs"
        place_vmesh(programs)
        self._folder = folder
        self._environment = {**os.environ, "PATH": f"{programs}{os.pathsep}{os.environ['PATH']}"}

    def run(self, sample: Sample) -> str:
        """What a sample prints, in the current folder."""
        if sample.language == "sh":
            done = subprocess.run(
                ["sh", "-ec", sample.code],
                cwd=self._folder,
                env=self._environment,
                capture_output=True,
                check=False,
            )
            assert done.returncode == 0, f"line {sample.line}: {done.stderr.decode()}"
            return done.stdout.decode()
        printed = io.StringIO()
        with redirect_stdout(printed):
            exec(compile(sample.code, f"line {sample.line}", "exec"), self.names)
        return printed.getvalue()
