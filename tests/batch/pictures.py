"""Small photographs for a batch, cut from a large one."""

from __future__ import annotations

from pathlib import Path

from PIL import Image

from vmesh.arrays import UInt8Array
from vmesh.batch.task import Recipe, Task
from vmesh.encoder.settings import Settings

SETTINGS = Settings(vertices=60, effort=1, threads=1)
RECIPE = Recipe(SETTINGS)


def write_pictures(folder: Path, photograph: UInt8Array, n_pictures: int) -> list[Path]:
    """Different pictures of 48 x 32 pixels."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = [folder / f"{n:02}.png" for n in range(n_pictures)]
    for n, path in enumerate(paths):
        Image.fromarray(photograph[5 * n : 5 * n + 32, 7 * n : 7 * n + 48]).save(path)
    return paths


def tasks_of(sources: list[Path], suffix: str = ".vmesh") -> list[Task]:
    """Tasks that write beside their sources."""
    return [Task(str(path), (str(path.with_suffix(suffix)),), RECIPE) for path in sources]
