"""Names of outputs: none for two sources, and none that is a source itself."""

from __future__ import annotations

import os
import stat
from collections.abc import Hashable, Iterable
from pathlib import Path

from vmesh.errors import shown


def check_targets(wanted: Iterable[tuple[str, Iterable[str]]]) -> None:
    """Refuse outputs that two sources share, or that are a source, by whatever name.

    Parameters
    ----------
    wanted : iterable of (str, iterable of str)
        Paths of sources, and of the outputs of each.

    Raises
    ------
    ValueError
        If there is such an output.
    """
    pairs = [(source, tuple(targets)) for source, targets in wanted]
    makers: dict[str, str] = {}
    for source, targets in pairs:
        for target in targets:
            other = makers.setdefault(os.path.realpath(target), source)
            if other is not source:
                raise ValueError(
                    f"{shown(other)} and {shown(source)} would both be written to {shown(target)}"
                )
    replaced: dict[Hashable, str] = {}
    for target, maker in makers.items():
        replaced.update(dict.fromkeys(_identities(target), maker))
    for source, _ in pairs:
        for identity in _identities(source):
            if identity in replaced:
                maker = replaced[identity]
                which = f"{shown(source)}, which is a source too" if maker != source else "itself"
                raise ValueError(f"an output of {shown(maker)} would replace {which}")


def _identities(path: str) -> list[Hashable]:
    """Names that two paths have in common if they are the same file: links count as what they are.

    A device or a pipe is not replaced by what is written to it, and has none.
    """
    named = Path(path)
    try:
        status = named.stat()
    except OSError:
        return [os.path.realpath(named)]
    if not stat.S_ISREG(status.st_mode):
        return []
    return [os.path.realpath(named), (status.st_dev, status.st_ino)]
