"""What a caller asks of an SVG drawing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

Mode = Literal["gradient", "exact", "auto", "flat"]


@dataclass(frozen=True, slots=True)
class Style:
    """How a mesh is drawn; as for :func:`vmesh.formats.svg.write_svg`.

    Raises
    ------
    ValueError
        If an option is none of these, or has no meaning in the mode.
    """

    mode: Mode = "gradient"
    tolerance: float = 4.0
    merge: float = 0.0

    def __post_init__(self) -> None:
        known = get_args(Mode)
        if self.mode not in known:
            raise ValueError(f"expected mode to be one of {', '.join(known)}, got {self.mode!r}")
        if not 0 < self.tolerance <= 255:
            raise ValueError(
                f"expected a tolerance above 0, of at most 255 levels, got {self.tolerance}"
            )
        if not 0 <= self.merge < np.inf:
            raise ValueError(f"expected a finite error of 0 or more to merge by, got {self.merge}")
        if self.merge and self.mode != "gradient":
            raise ValueError(f"regions are merged in mode gradient only, got mode {self.mode}")
