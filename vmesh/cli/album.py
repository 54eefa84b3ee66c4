"""An album: one output that is made of any number of inputs."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Any

from vmesh.batch.targets import check_targets
from vmesh.cli.failures import FAILURES, end_with
from vmesh.cli.jobs import Job, Making, find_inputs, is_one_output
from vmesh.cli.streams import STANDARD
from vmesh.errors import describe, shown
from vmesh.files import times_of
from vmesh.mesh import Mesh

Pages = Iterator[tuple[str, Mesh]]


@dataclass(frozen=True, slots=True)
class Album:
    """Inputs of an album, and its output.

    Parameters
    ----------
    sources : sequence of str
        Paths, in the order of the pages.
    job : Job
        Whose source is the first of them.
    """

    sources: Sequence[str]
    job: Job

    def make(self, read: Callable[[str, str], Mesh], write: Callable[[Pages, Job], object]) -> None:
        """Write the pages as they are read; those that fail are told at the end, with status 1.

        Parameters
        ----------
        read : callable
            Gets the path of an input, and which of how many it is, such as " 2/5".
        write : callable
            Gets titles and meshes, of which there is one at least, and the job.
        """
        self.job.check()
        failed: list[tuple[str, str]] = []
        pages = self._pages(read, failed)
        if first := next(pages, None):
            write(chain([first], pages), self.job)
        end_with(failed)

    def _pages(self, read: Callable[[str, str], Mesh], failed: list[tuple[str, str]]) -> Pages:
        for number, source in enumerate(self.sources, 1):
            try:
                mesh = read(source, f" {number}/{len(self.sources)}")
            except FAILURES as error:
                failed.append((source, describe(error)))
                continue
            yield shown(Path(source).stem), mesh


def take_album(options: dict[str, Any], making: Making) -> Album | None:
    """Album that a command's arguments ask for, else None: several inputs, or a folder, and a name.

    The options lose what :func:`vmesh.cli.jobs.job_arguments` gave if there is one.

    Raises
    ------
    click.UsageError
        If standard input is one of many.
    OSError, ValueError
        If a folder cannot be read, if there is nothing in any, or if the output is an input.
    """
    paths: tuple[str, ...] = options["paths"]
    output: str | None = options["output"]
    if output is None and len(paths) > 2 and is_one_output(paths[-1], making):
        *inputs, output = paths
    else:
        inputs = list(paths)
    if output is None or not is_one_output(output, making):
        return None
    if len(inputs) < 2 and not Path(inputs[0]).is_dir():
        return None
    sources = [str(source.path) for source in find_inputs(inputs, output, making.inputs)]
    if output != STANDARD:
        check_targets([(sources[0], [output]), *((source, []) for source in sources[1:])])
    times = None
    if options["preserve"]:
        known = [times for times in map(times_of, sources) if times]
        times = max(known, key=lambda each: each[1], default=None)
    job = Job(sources[0], output, options["overwrite"], times=times)
    for name in ("paths", "output", "preserve", "overwrite"):
        del options[name]
    return Album(sources, job)
