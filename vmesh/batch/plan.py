"""Plan of a batch: its tasks, and the sources that have all their outputs already."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from vmesh.batch.sources import Source
from vmesh.batch.targets import check_targets
from vmesh.batch.task import Outcome, Recipe, Task
from vmesh.codec.layout import FILE_SUFFIX


def make_plan(
    sources: Iterable[Source],
    output: str,
    suffixes: tuple[str, ...],
    recipe: Recipe,
    *,
    force: bool,
) -> tuple[list[Task], list[Outcome]]:
    """Tasks of some sources, and outcomes of those that need none.

    Outputs that are as new as their source are left as they are, unless `force` is given. If the
    mesh is one of them, the other outputs are made from it.

    Raises
    ------
    ValueError
        If two sources have an output in common, or if an output would replace a source.
    """
    wanted = [
        (source.path, [Path(output, source.name).with_suffix(suffix) for suffix in suffixes])
        for source in sources
    ]
    check_targets((str(path), map(str, targets)) for path, targets in wanted)
    tasks, skipped = [], []
    for path, targets in wanted:
        current = [] if force else [target for target in targets if _is_current(target, path)]
        missing = tuple(str(target) for target in targets if target not in current)
        made = next((str(target) for target in current if target.suffix == FILE_SUFFIX), None)
        if missing:
            tasks.append(Task(str(path), missing, recipe, made))
        else:
            skipped.append(Outcome(str(path), "skipped"))
    return tasks, skipped


def _is_current(target: Path, source: Path) -> bool:
    """Check of a target: true if it is there, and as new as its source."""
    try:
        return target.stat().st_mtime_ns >= source.stat().st_mtime_ns
    except OSError:
        return False
