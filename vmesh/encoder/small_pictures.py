"""Small pictures by quality: the best of a fixed set of meshes, for what a bit is worth.

How many vertices and levels a quality buys follows from averages over many pixels. A picture of a
few hundred pixels has no averages: one vertex more may be worse than one less. But its meshes take
no time, so a whole ladder of them is made, from four vertices to one at each pixel in steps of 1,
and the quality only decides which is taken: that with the least D + lambda R. Of two qualities the
higher one, whose lambda is smaller, then never has the larger error, nor the smaller file: adding

    D1 + lambda1 R1 <= D2 + lambda1 R2   and   D2 + lambda2 R2 <= D1 + lambda2 R1

gives (lambda1 - lambda2) (R1 - R2) <= 0.

References
----------
Y. Shoham, A. Gersho, "Efficient bit allocation for an arbitrary set of quantizers", IEEE
Transactions on Acoustics, Speech, and Signal Processing 36(9), 1988, theorem 1.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Final

from vmesh.codec.writer import dumps
from vmesh.encoder.draft import Draft
from vmesh.encoder.image import SMALL, is_small, peak_of
from vmesh.encoder.mesh_builder import MeshBuilder
from vmesh.encoder.rate_control import measure_error
from vmesh.encoder.rate_model import lambda_of_quality, lambda_of_small_picture, staying_cost
from vmesh.encoder.settings import GOALS, Settings
from vmesh.encoder.starting_mesh import dense_draft, quality_of
from vmesh.encoder.threads import Run
from vmesh.kernels.remeshing import WeightedImage
from vmesh.mesh import Mesh

# Qualities whose meshes are made the ordinary way; and those whose price of a vertex says which
# vertices stay where there is one at each pixel.
_RUNGS: Final = (75, 20, 45, 60, 90)
_DENSE_RUNGS: Final = (160, 140, 120, 110, 100, 90, 75)


def takes_rungs(image: WeightedImage, settings: Settings) -> bool:
    """True for a small picture whose goal is a quality."""
    others = (getattr(settings, name) for name in GOALS if name != "quality")
    return is_small(image) and all(goal is None for goal in others)


def best_of_rungs(
    builder: MeshBuilder, settings: Settings, draft: Callable[[Settings], Draft], run: Run
) -> Mesh:
    """The mesh of a small picture whose squared error and bits weigh least at a quality.

    Parameters
    ----------
    builder : MeshBuilder
    settings : Settings
        Without a goal other than the quality.
    draft : callable
        Draft by settings.
    run : callable
        Runs jobs that do not depend on each other.
    """
    image = builder.image
    lambda_ = lambda_of_small_picture(
        quality_of(settings), peak_of(image.samples), image.weights.size / SMALL
    )

    def weight(mesh: Mesh) -> float:
        return measure_error(image, mesh) + lambda_ * 8 * len(dumps(mesh))

    return min(_rungs(builder, settings, draft, run), key=weight)


def _rungs(
    builder: MeshBuilder, settings: Settings, draft: Callable[[Settings], Draft], run: Run
) -> Iterator[Mesh]:
    """Meshes of a picture, the same for every quality."""
    for quality in _RUNGS:
        yield builder.build(draft(settings.with_goal(quality=quality)))
    dense = dense_draft(builder.image, builder.grid, settings, run)
    yield builder.finest(builder.fit(dense))
    peak = peak_of(builder.image.samples)
    for quality in _DENSE_RUNGS:
        cost = staying_cost(lambda_of_quality(quality, peak))
        dense.thin(4, lambda: None, max_cost=cost)
        fit = builder.fit(dense)
        yield builder.finest(fit)
        yield builder.build(dense)
