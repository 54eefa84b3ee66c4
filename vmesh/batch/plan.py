"""Plan of a batch: its tasks, and the sources that need none."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path

from vmesh.batch.journal import Journal, Origin
from vmesh.batch.sources import Source
from vmesh.batch.targets import check_targets
from vmesh.batch.task import Outcome, Recipe, Task
from vmesh.codec.layout import FILE_SUFFIX
from vmesh.errors import describe
from vmesh.files import check_replaceable, times_of


@dataclass(frozen=True, slots=True)
class Rules:
    """Rules about the outputs of a batch.

    Parameters
    ----------
    force : bool
        Whether outputs are made that are up to date.
    overwrite : bool, optional
        Whether outputs that are not up to date are replaced: also those that are write-protected,
        or none. Unless given, those that are not protected.
    preserve : bool
        Whether outputs get the times of their sources.
    """

    force: bool = False
    overwrite: bool | None = None
    preserve: bool = False


@dataclass(frozen=True, slots=True)
class Plan:
    """Plan of a batch.

    Parameters
    ----------
    tasks : list of Task
    settled : list of Outcome
        Outcomes of sources that need no task: all their outputs are there, or must not be replaced.
    origins : dict
        Origins of the outputs that will be made, by their paths.
    adopted : dict
        Origins of outputs that are there and up to date by their time, as far as that says.
    """

    tasks: list[Task]
    settled: list[Outcome]
    origins: dict[Path, Origin]
    adopted: dict[Path, Origin]


def make_plan(
    sources: Iterable[Source],
    output: str,
    suffixes: tuple[str, ...],
    recipe: Recipe,
    journal: Journal,
    rules: Rules,
) -> Plan:
    """Plan of what is to be made of some sources.

    Outputs that are up to date are left as they are: those that were made of their source as it is
    now, in its size and its time, by this recipe; where that is not known, those that are as new as
    their source. If the mesh is one of them, the other outputs are made from it.

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
    plan = Plan([], [], {}, {})
    for path, targets in wanted:
        origin = _origin(path, recipe)
        current = [
            target for target in targets if not rules.force and _is_current(target, origin, journal)
        ]
        if origin is not None:
            unknown = [target for target in current if journal.origin(target) is None]
            plan.adopted.update(dict.fromkeys(unknown, replace(origin, recipe="")))
        missing = [target for target in targets if target not in current]
        if rules.overwrite is False:
            missing = [target for target in missing if not target.exists()]
        try:
            for target in missing:
                check_replaceable(target, overwrite=rules.overwrite, is_named=True)
        except OSError as error:
            plan.settled.append(Outcome(str(path), "failed", error=describe(error)))
            continue
        if not missing:
            plan.settled.append(Outcome(str(path), "skipped"))
            continue
        if origin is not None:
            plan.origins.update(dict.fromkeys(missing, origin))
        mesh = next((str(target) for target in current if target.suffix == FILE_SUFFIX), None)
        plan.tasks.append(
            Task(
                str(path),
                tuple(map(str, missing)),
                recipe,
                mesh,
                replace=rules.overwrite is not False,
                times=times_of(path) if rules.preserve else None,
            )
        )
    return plan


def _origin(source: Path, recipe: Recipe) -> Origin | None:
    """Origin of the outputs of a source; None if it is not there."""
    try:
        status = source.stat()
    except OSError:
        return None
    is_mesh = source.suffix.lower() == FILE_SUFFIX
    return Origin(status.st_size, status.st_mtime_ns, recipe.digest(of_mesh=is_mesh))


def _is_current(target: Path, origin: Origin | None, journal: Journal) -> bool:
    """Check of a target: true if it is there, and what its source is now to make."""
    if origin is None:
        return False
    try:
        mtime_ns = target.stat().st_mtime_ns
    except OSError:
        return False
    known = journal.origin(target)
    return mtime_ns >= origin.mtime_ns if known is None else known.is_of(origin)
