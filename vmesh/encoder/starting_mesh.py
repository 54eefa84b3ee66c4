"""The starting mesh: a sample of a picture or of its tiles, thinned as far as its goal allows."""

from __future__ import annotations

from collections.abc import Callable
from math import sqrt
from typing import Final

from vmesh.encoder.draft import Draft, SampledDraft, dense_vertices, most_vertices
from vmesh.encoder.effort import EFFORTS
from vmesh.encoder.image import crop, peak_of
from vmesh.encoder.proposals import propose
from vmesh.encoder.rate_model import (
    SAMPLED_POWER,
    error_before_refinement,
    lambda_of,
    lambda_of_quality,
    staying_cost,
    vertices_for,
)
from vmesh.encoder.remeshing import Remesher
from vmesh.encoder.sampling import Samples
from vmesh.encoder.settings import DEFAULT_QUALITY, Settings
from vmesh.encoder.threads import Run, run_here
from vmesh.encoder.tiles.tiled_draft import TiledRemesher, TiledSamples
from vmesh.grid import Grid, Tile
from vmesh.kernels.remeshing import WeightedImage

# Thinning starts from at least so many times the vertices wanted.
_LEAST_CHOICE: Final = 3
# How often a picture is sampled in search of a lambda, and what factor from it is close enough.
_MIN_SAMPLINGS: Final = 2
_MAX_SAMPLINGS: Final = 12
_CLOSE: Final = 4.0
_CROWDED: Final = 0.4  # of the pixels are vertices


def sampled_draft(image: WeightedImage, settings: Settings) -> Draft:
    """Draft of vertices where they are sampled, as many as the settings ask for.

    Where a quality takes most of the pixels, it is all of them less those that do not pay.
    """
    height, width = image.weights.shape
    most = most_vertices(width, height)

    def take(n_vertices: int) -> Samples:
        _, samples = propose(image, settings.with_goal(vertices=n_vertices))
        return samples

    wanted = _wanted_vertices(settings, width, height)
    draft = SampledDraft(image, take, wanted or max(4, width * height // 100))
    if wanted is None and settings.target_psnr is None:
        lambda_ = lambda_of_quality(quality_of(settings), peak_of(image.samples))
        _approach(draft, lambda_, most)
        if draft.n_vertices > _CROWDED * most:
            dense = dense_draft(image, None, settings, run_here)
            dense.thin(4, lambda: None, max_cost=staying_cost(lambda_))
            return dense
    return draft


def _approach(draft: SampledDraft, lambda_: float, most: int) -> None:
    """Sample as many vertices as make a bit worth about lambda, `most` at most."""
    low, high = 4, most
    for attempt in range(_MAX_SAMPLINGS):
        before, now = draft.n_vertices, lambda_of(draft)
        if attempt >= _MIN_SAMPLINGS and 1 / _CLOSE <= now / lambda_ <= _CLOSE:
            break
        if now > lambda_:
            low = max(low, before)
        else:
            high = min(high, before)
        wanted = round(before * (now / lambda_) ** (1 / SAMPLED_POWER))
        if attempt >= _MIN_SAMPLINGS and not low < wanted < high:
            # The power says little of a small picture, whose pixels soon all are vertices.
            wanted = round(sqrt(low * high))
        draft.resize(max(4, min(wanted, most)))
        if attempt >= _MIN_SAMPLINGS and high - low <= 1:
            break


def sampled_tiles(image: WeightedImage, grid: Grid, settings: Settings, run: Run) -> TiledSamples:
    """Draft of a picture in tiles, its vertices where they are sampled in each."""
    wanted = _wanted_vertices(settings, grid.width, grid.height)
    if wanted is not None:
        share = wanted / (grid.width * grid.height)
        settings = settings.with_goal(density=min(1.0, share))
    parts = run(lambda tile: sampled_draft(crop(image, tile), settings), grid.tiles())
    draft = TiledSamples(grid, list(parts), run)
    if wanted is not None or settings.target_psnr is not None:
        draft.balance()
    if wanted is not None:
        draft.resize(wanted)
    return draft


def thinned(
    image: WeightedImage, settings: Settings, report: Callable[[], None], run: Run
) -> Remesher:
    """Draft of the vertices that matter most in a dense sample of a picture."""
    height, width = image.weights.shape
    wanted = _wanted_vertices(settings, width, height)
    start = _start(width, height, settings)
    if wanted is not None:
        start = max(start, _LEAST_CHOICE * wanted)
    while True:
        start = max(4, min(start, width * height))
        draft = _proposed(image, settings, start, run)
        _thin(draft, settings, wanted, report)
        if _had_choice(draft) or start >= width * height:
            return draft
        start = 2 * _LEAST_CHOICE * draft.n_vertices


def thinned_tiles(
    image: WeightedImage, grid: Grid, settings: Settings, report: Callable[[], None], run: Run
) -> TiledRemesher:
    """Draft of the vertices that matter most in dense samples of tiles, all thinned alike."""

    def proposed(job: tuple[Tile, int]) -> Remesher:
        tile, start = job
        return _proposed(crop(image, tile), settings, start, run_here)

    tiles = list(grid.tiles())
    starts = [_start(tile.width, tile.height, settings) for tile in tiles]
    draft = TiledRemesher(grid, list(run(proposed, zip(tiles, starts, strict=True))), run)
    while True:
        _thin(draft, settings, _wanted_vertices(settings, grid.width, grid.height), report)
        denser = {}
        for i, (tile, part) in enumerate(zip(tiles, draft.parts, strict=True)):
            n_pixels = tile.width * tile.height
            if starts[i] < n_pixels and not _had_choice(part):
                starts[i] = denser[i] = min(2 * _LEAST_CHOICE * part.n_vertices, n_pixels)
        if not denser:
            return draft
        parts = run(proposed, [(tiles[i], start) for i, start in denser.items()])
        draft.replace(dict(zip(denser, parts, strict=True)))


def dense_draft(
    image: WeightedImage, grid: Grid | None, settings: Settings, run: Run
) -> Remesher | TiledRemesher:
    """Draft with a vertex at each pixel, which holds the picture without any error."""
    # A draft that is only thinned has no use for the effort, and 1 has none.
    effort = EFFORTS[max(2, settings.effort)]

    def dense(part: WeightedImage, run: Run) -> Remesher:
        height, width = part.weights.shape
        return Remesher(part, dense_vertices(width, height), effort, run)

    if grid is None:
        return dense(image, run)
    parts = run(lambda tile: dense(crop(image, tile), run_here), grid.tiles())
    return TiledRemesher(grid, list(parts), run, near=0)


def _start(width: int, height: int, settings: Settings) -> int:
    """Number of vertices that thinning starts from."""
    return max(4, round(EFFORTS[settings.effort].density * width * height))


def _proposed(image: WeightedImage, settings: Settings, n_vertices: int, run: Run) -> Remesher:
    """Draft of a dense sample of a picture, or of all its pixels."""
    height, width = image.weights.shape
    if n_vertices >= width * height:
        return Remesher(image, dense_vertices(width, height), EFFORTS[settings.effort], run)
    _, samples = propose(image, settings.with_goal(vertices=n_vertices))
    return Remesher(image, samples.vertices(), EFFORTS[settings.effort], run)


def _had_choice(draft: Remesher) -> bool:
    """True if there were enough vertices to choose from."""
    return _LEAST_CHOICE * draft.n_vertices <= draft.n_proposed


def _thin(
    draft: Remesher | TiledRemesher,
    settings: Settings,
    wanted: int | None,
    report: Callable[[], None],
) -> None:
    """Remove vertices down to the number wanted, or as many as lambda or the error allows."""
    if wanted is not None:
        draft.thin(wanted, report)
    elif settings.target_psnr is not None:
        allowed = draft.n_samples * draft.peak**2 / 10.0 ** (settings.target_psnr / 10.0)
        draft.thin(4, report, max_error=error_before_refinement(allowed))
    else:
        lambda_ = lambda_of_quality(quality_of(settings), draft.peak)
        draft.thin(4, report, max_cost=staying_cost(lambda_))


def _wanted_vertices(settings: Settings, width: int, height: int) -> int | None:
    """Number of vertices that the settings ask for, or that a file of their size may hold."""
    if settings.target_size is not None:
        return max(4, min(vertices_for(settings.target_size), width * height))
    return settings.n_vertices(width, height)


def quality_of(settings: Settings) -> int:
    """Quality that the settings ask for."""
    return DEFAULT_QUALITY if settings.quality is None else settings.quality
