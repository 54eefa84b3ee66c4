"""The style of an SVG drawing: the options of a caller, checked."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Final, Literal, get_args

import numpy as np

Mode = Literal["gradient", "exact", "auto", "flat"]
Seams = Literal["crisp", "trapping"]

_PREFIX: Final = re.compile(r"[A-Za-z_][A-Za-z0-9_-]{0,63}")


@dataclass(frozen=True, slots=True)
class Style:
    """Options of a drawing, as of :func:`vmesh.formats.svg.document.write_svg`.

    Raises
    ------
    ValueError
        If an option is none of these, or has no meaning in the mode.
    """

    mode: Mode = "gradient"
    tolerance: float = 4.0
    merge: float = 0.0
    seams: Seams = "crisp"
    id_prefix: str | None = None

    def __post_init__(self) -> None:
        for name, kinds in (("mode", Mode), ("seams", Seams)):
            known, found = get_args(kinds), getattr(self, name)
            if found not in known:
                raise ValueError(f"expected {name} to be one of {', '.join(known)}, got {found!r}")
        if not 0 < self.tolerance <= 255:
            raise ValueError(
                f"expected a tolerance above 0, of at most 255 levels, got {self.tolerance}"
            )
        if not 0 <= self.merge < np.inf:
            raise ValueError(f"expected a finite error of 0 or more to merge by, got {self.merge}")
        if self.merge and self.mode != "gradient":
            raise ValueError(f"regions are merged in mode gradient only, got mode {self.mode}")
        # Layers are no sum where smooth edges of split and whole triangles meet.
        if self.seams == "trapping" and self.mode == "auto":
            raise ValueError("mode auto needs crisp edges: no trapping")
        if self.id_prefix is not None:
            check_id_prefix(self.id_prefix)

    @property
    def n_stages(self) -> int:
        """Number of progress reports of a drawing without alpha, at most."""
        n_layers = 3 if self.mode in ("exact", "auto") else 1
        return 1 + 2 * n_layers


def check_id_prefix(prefix: str) -> None:
    """Raise :class:`ValueError` unless ids of XML and of CSS may begin with this text."""
    if not _PREFIX.fullmatch(prefix):
        raise ValueError(
            "expected ids to begin with a letter or _, and at most 63 letters, digits, _ and - "
            f"after it, got {prefix!r}"
        )
