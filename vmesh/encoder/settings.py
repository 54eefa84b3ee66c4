"""Settings of an encoding, which a caller chooses."""

from __future__ import annotations

from dataclasses import dataclass, replace
from operator import index
from typing import Final, Literal, get_args

from vmesh.limits import MAX_DEPTH, MAX_TILE_SIDE

Method = Literal["adaptive", "blue-noise"]
Sampler = Literal["multiclass", "channels"]
Diffusion = Literal["zhou-fang", "ostromoukhov"]
ColorMode = Literal["fitted", "sampled"]

MAX_QUALITY: Final = 100
MAX_EFFORT: Final = 9
MAX_COLOR_STEP: Final = (1 << MAX_DEPTH) - 1
MIN_TILE: Final = 32
MAX_TILE: Final = MAX_TILE_SIDE >> 1  # a pixel is two lattice units wide
DEFAULT_QUALITY: Final = 75
DEFAULT_EFFORT: Final = 5

_CHOICES: Final = {
    "method": get_args(Method),
    "sampler": get_args(Sampler),
    "diffusion": get_args(Diffusion),
    "colors": get_args(ColorMode),
}
GOALS: Final = ("quality", "target_size", "target_psnr", "vertices", "density")


@dataclass(frozen=True, slots=True)
class Settings:
    """Settings of an encoding: the keywords of :func:`vmesh.encode`, with the same defaults.

    Raises
    ------
    ValueError, TypeError
        If one is out of its range, or two of them do not go together.
    """

    method: Method = "adaptive"
    quality: int | None = None
    target_size: int | None = None
    target_psnr: float | None = None
    vertices: int | None = None
    density: float | None = None
    effort: int = DEFAULT_EFFORT
    gamma: float = 1.0
    sampler: Sampler = "multiclass"
    diffusion: Diffusion = "zhou-fang"
    colors: ColorMode = "fitted"
    color_step: int | None = None
    tile: int | None = None
    seed: int = 0
    threads: int | None = None

    def __post_init__(self) -> None:
        for name, choices in _CHOICES.items():
            if getattr(self, name) not in choices:
                raise ValueError(
                    f"expected {name} to be one of {', '.join(choices)}, "
                    f"got {getattr(self, name)!r}"
                )
        for name in (
            "quality",
            "target_size",
            "vertices",
            "effort",
            "color_step",
            "tile",
            "seed",
            "threads",
        ):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, index(getattr(self, name)))
        self._check_ranges()
        self._check_goals()

    def _check_ranges(self) -> None:
        if not 0.0 < self.gamma <= 10.0:
            raise ValueError(f"expected a gamma above 0 and up to 10, got {self.gamma}")
        if self.quality is not None and not 0 <= self.quality <= MAX_QUALITY:
            raise ValueError(f"expected a quality of 0 to {MAX_QUALITY}, got {self.quality}")
        if self.target_size is not None and self.target_size < 1:
            raise ValueError(f"expected a target_size of 1 byte or more, got {self.target_size}")
        if self.target_psnr is not None and not 0.0 < self.target_psnr <= 99.0:
            raise ValueError(
                f"expected a target_psnr above 0 and up to 99 decibels, got {self.target_psnr}"
            )
        if self.vertices is not None and self.vertices < 4:
            raise ValueError(f"expected at least 4 vertices, got {self.vertices}")
        if self.density is not None and not 0.0 < self.density <= 1.0:
            raise ValueError(f"expected a density above 0 and up to 1, got {self.density}")
        if not 1 <= self.effort <= MAX_EFFORT:
            raise ValueError(f"expected an effort of 1 to {MAX_EFFORT}, got {self.effort}")
        if self.color_step is not None and not 1 <= self.color_step <= MAX_COLOR_STEP:
            raise ValueError(
                f"expected a color step of 1 to {MAX_COLOR_STEP}, got {self.color_step}"
            )
        if self.tile is not None and not MIN_TILE <= self.tile <= MAX_TILE:
            raise ValueError(
                f"expected a tile of {MIN_TILE} to {MAX_TILE} pixels a side, got {self.tile}"
            )
        if self.threads is not None and self.threads < 1:
            raise ValueError(f"expected 1 thread or more, got {self.threads}")
        if self.seed < 0:
            raise ValueError(f"expected a seed of 0 or more, got {self.seed}")

    def _check_goals(self) -> None:
        given = [name for name in GOALS if getattr(self, name) is not None]
        if len(given) > 1:
            raise ValueError(f"expected one of {' and '.join(given)}, not both")
        if self.method == "blue-noise" and given and given[0] not in ("vertices", "density"):
            raise ValueError(f"expected method adaptive with {given[0]}, got blue-noise")
        if self.method == "blue-noise" and self.tile is not None:
            raise ValueError("expected method adaptive with tile, got blue-noise")
        if self.method == "adaptive" and self.colors == "sampled":
            raise ValueError("expected method blue-noise with sampled colors, got adaptive")

    def n_vertices(self, width: int, height: int) -> int | None:
        """Number of vertices wanted for a picture of this size, None if something else decides."""
        if self.density is not None:
            return max(4, round(self.density * width * height))
        return self.vertices

    def with_goal(
        self,
        *,
        quality: int | None = None,
        target_size: int | None = None,
        target_psnr: float | None = None,
        vertices: int | None = None,
        density: float | None = None,
    ) -> Settings:
        """Settings with another goal, or none."""
        return replace(
            self,
            quality=quality,
            target_size=target_size,
            target_psnr=target_psnr,
            vertices=vertices,
            density=density,
        )
