"""What a caller can choose about an encoding."""

from __future__ import annotations

from dataclasses import dataclass
from operator import index
from typing import Final, Literal, get_args

from vmesh.color_lattice import MAX_STEP

Method = Literal["blue-noise", "adaptive"]
Sampler = Literal["multiclass", "channels"]
Diffusion = Literal["zhou-fang", "ostromoukhov"]
ColorMode = Literal["fitted", "sampled"]

_ADAPTIVE_DENSITY: Final = 0.02
# Vertices per pixel that thinning starts from: a blue-noise sample as dense as this ends within
# 0.1 dB of starting from every pixel.
_START_DENSITY: Final = 0.25

_CHOICES: Final = {
    "method": get_args(Method),
    "sampler": get_args(Sampler),
    "diffusion": get_args(Diffusion),
    "colors": get_args(ColorMode),
}


@dataclass(frozen=True, slots=True)
class Settings:
    """Settings of an encoding.

    Parameters
    ----------
    method : {"blue-noise", "adaptive"}
        How vertices are found: sampled from the salience, or sampled densely and thinned down to
        those that matter most.
    gamma : float
        Exponent of the salience, above 0; a smaller value gives more points.
    vertices : int, optional
        Vertices wanted, met within 2 % ("blue-noise") or exactly ("adaptive").
    density : float, optional
        Vertices wanted per pixel, above 0 and up to 1; not together with `vertices`. Without
        either, `gamma` alone decides ("blue-noise"), or it is 0.02 ("adaptive").
    sampler : {"multiclass", "channels"}
        Colour planes sampled together, no two on one pixel, or each for itself.
    diffusion : {"zhou-fang", "ostromoukhov"}
        Coefficients of the error diffusion.
    colors : {"fitted", "sampled"}
        Vertex colours by least squares over all pixels, or those of the vertices' pixels.
    color_step : int
        Step of the luma lattice in sample units, 1 (no rounding) to 255; the other components'
        steps follow from it.
    seed : int
        Start of the random thresholds.
    """

    method: Method = "blue-noise"
    gamma: float = 1.0
    vertices: int | None = None
    density: float | None = None
    sampler: Sampler = "multiclass"
    diffusion: Diffusion = "zhou-fang"
    colors: ColorMode = "fitted"
    color_step: int = 8
    seed: int = 0

    def __post_init__(self) -> None:
        for name, choices in _CHOICES.items():
            if getattr(self, name) not in choices:
                raise ValueError(
                    f"expected {name} to be one of {', '.join(choices)}, "
                    f"got {getattr(self, name)!r}"
                )
        for name in ("vertices", "color_step", "seed"):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, index(getattr(self, name)))
        if not 0.0 < self.gamma <= 10.0:
            raise ValueError(f"expected a gamma above 0 and up to 10, got {self.gamma}")
        if self.vertices is not None and self.density is not None:
            raise ValueError("expected a number of vertices or a density, not both")
        if self.vertices is not None and self.vertices < 4:
            raise ValueError(f"expected at least 4 vertices, got {self.vertices}")
        if self.density is not None and not 0.0 < self.density <= 1.0:
            raise ValueError(f"expected a density above 0 and up to 1, got {self.density}")
        if not 1 <= self.color_step <= MAX_STEP:
            raise ValueError(f"expected a color step of 1 to {MAX_STEP}, got {self.color_step}")
        if self.seed < 0:
            raise ValueError(f"expected a seed of 0 or more, got {self.seed}")

    def n_vertices(self, width: int, height: int) -> int | None:
        """Number of vertices wanted for a picture of this size, None to let gamma decide."""
        density = self.density
        if self.method == "adaptive" and self.vertices is None and density is None:
            density = _ADAPTIVE_DENSITY
        if density is not None:
            return max(4, round(density * width * height))
        return self.vertices

    def n_points(self, width: int, height: int) -> int | None:
        """Number of points to sample: the vertices wanted, or the many that are thinned to them."""
        wanted = self.n_vertices(width, height)
        if self.method == "adaptive" and wanted is not None:
            return max(wanted, round(_START_DENSITY * width * height))
        return wanted
