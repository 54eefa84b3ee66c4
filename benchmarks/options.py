"""Options that the commands of the benchmarks share."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Final

import click

Option = Callable[[Any], Any]

_SHIPPED: Final = Path(__file__).parents[1] / "tests" / "images"

images_option: Final[Option] = click.option(
    "--images",
    "folder",
    type=click.Path(exists=True, file_okay=False, path_type=Path),
    default=_SHIPPED,
    help="Folder of photographs, .png or .jpg; those of the tests unless given.",
)
markdown_option: Final[Option] = click.option(
    "--markdown", is_flag=True, help="Print tables for GitHub."
)
effort_option: Final[Option] = click.option(
    "--effort", type=click.IntRange(1, 9), default=5, show_default=True, help="Of the encoder."
)


def limit_option(default: int | None = None) -> Option:
    """Number of the folder's photographs to measure on."""
    return click.option(
        "--limit",
        type=click.IntRange(min=1),
        default=default,
        show_default="all" if default is None else True,
        help="Only so many photographs of the folder, by name.",
    )


def repeat_option(default: int) -> Option:
    """Number of times that each action is timed."""
    return click.option(
        "--repeat",
        type=click.IntRange(min=1),
        default=default,
        show_default=True,
        help="Runs of each action that is timed.",
    )


def parts_option(names: Sequence[str]) -> Option:
    """Parts of the benchmark to run: all of `names` unless some are given."""
    return click.option(
        "--part",
        "parts",
        type=click.Choice(list(names)),
        multiple=True,
        default=tuple(names),
        help="Only this part; may be given more than once.",
    )
