"""Densities, colours and samplers of the comparison with the paper."""

from __future__ import annotations

from typing import Final, get_args

from vmesh.encoder.settings import ColorMode, Sampler

DENSITIES: Final = (0.01, 0.02, 0.04)  # vertices for each pixel
SAMPLERS: Final[tuple[Sampler, ...]] = get_args(Sampler)
COLORS: Final[tuple[ColorMode, ...]] = ("sampled", "fitted")
FINEST_STEP: Final = 1  # 8-bit colors, as the published figures have them
STEPS: Final = (FINEST_STEP, 8)
