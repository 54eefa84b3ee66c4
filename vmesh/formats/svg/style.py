"""The style of an SVG drawing: the options of a caller, checked."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

Mode = Literal["gradient", "exact", "auto", "flat"]
Seams = Literal["crisp", "trapping"]


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
        # Screening is no sum where smooth edges of split and whole triangles meet.
        if self.seams == "trapping" and self.mode == "auto":
            raise ValueError("mode auto needs crisp edges: no trapping")

    @property
    def n_stages(self) -> int:
        """Number of progress reports of a drawing without alpha, at most."""
        n_layers = 3 if self.mode in ("exact", "auto") else 1
        return 1 + 2 * n_layers
