"""What a caller can choose about an encoding."""

from __future__ import annotations

from dataclasses import dataclass, replace
from operator import index
from typing import Any, Final, Literal, get_args

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
    """Settings of an encoding.

    Of `quality`, `target_size`, `target_psnr`, `vertices` and `density` one at most is given.
    Without any, the quality is 75 ("adaptive"), or gamma decides ("blue-noise").

    Parameters
    ----------
    method : {"adaptive", "blue-noise"}
        How vertices are found: sampled densely, thinned to those that matter most and moved to
        where they serve best; or sampled from the salience and left there.
    quality : int, optional
        0 to 100: the error that a bit has to save, the same for every picture ("adaptive").
    target_size : int, optional
        Bytes of the file, met from below within 2 % ("adaptive").
    target_psnr : float, optional
        Decibels over all samples, met from above within 0.1 dB ("adaptive").
    vertices : int, optional
        Vertices wanted, met exactly, or within 2 % ("blue-noise", and effort 1).
    density : float, optional
        Vertices wanted per pixel, above 0 and up to 1.
    effort : int
        1 to 9: time for a better mesh of the same size ("adaptive"). 1 leaves the vertices where
        they were sampled.
    gamma : float
        Exponent of the salience, above 0; a smaller value gives more points.
    sampler : {"multiclass", "channels"}
        Colour planes sampled together, no two on one pixel, or each for itself.
    diffusion : {"zhou-fang", "ostromoukhov"}
        Coefficients of the error diffusion.
    colors : {"fitted", "sampled"}
        Vertex colours by least squares over all pixels, or those of the vertices' pixels
        ("blue-noise").
    color_step : int, optional
        Step of the luma lattice in sample units, 1 (no rounding) to the largest sample; the other
        components' steps follow from it. It follows from the error unless given.
    tile : int, optional
        Side in pixels, 32 to 2048, of tiles that the mesh is made of: each is worked on, and held
        in the file, as a picture of its own ("adaptive"). Its corners are vertices always. A
        picture that fits one tile has none.
    seed : int
        Start of the random thresholds.
    threads : int, optional
        Most threads at once, of which the mesh does not depend; as many as there are processors
        unless given.
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

    def with_goal(self, **goal: float) -> Settings:
        """The settings with another goal, or none."""
        changes: dict[str, Any] = {**dict.fromkeys(GOALS), **goal}
        return replace(self, **changes)
