"""Efforts: how long a mesh is worked on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True, slots=True)
class Effort:
    """Settings of an effort: how long a mesh is worked on.

    Parameters
    ----------
    density : float
        Vertices per pixel that thinning starts from.
    max_rounds : int
        Most rounds of refinement.
    least_gain : float
        Share of the error that a round of refinement has to save for another one to follow.
    share_decay : float
        Factor of the share of the vertices that are exchanged, from round to round.
    n_reports : int
        About how often refinement reports progress.
    """

    density: float
    max_rounds: int
    least_gain: float
    share_decay: float
    n_reports: int = 1


EFFORTS: Final = {
    2: Effort(density=0.04, max_rounds=1, least_gain=0.0, share_decay=1.0, n_reports=2),
    3: Effort(density=0.05, max_rounds=2, least_gain=0.0, share_decay=0.7, n_reports=3),
    4: Effort(density=0.06, max_rounds=3, least_gain=0.0, share_decay=0.8, n_reports=4),
    5: Effort(density=0.045, max_rounds=16, least_gain=0.06, share_decay=0.85, n_reports=5),
    6: Effort(density=0.10, max_rounds=20, least_gain=0.04, share_decay=0.9, n_reports=7),
    7: Effort(density=0.15, max_rounds=30, least_gain=0.015, share_decay=0.93, n_reports=10),
    8: Effort(density=0.25, max_rounds=32, least_gain=0.004, share_decay=0.96, n_reports=20),
    9: Effort(density=0.25, max_rounds=64, least_gain=0.0, share_decay=0.98, n_reports=50),
}
"""Settings by effort; effort 1 leaves the vertices where they are sampled."""
