"""Options of a command that set the limits on what it accepts."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import click

from vmesh.limits import DEFAULT_LIMITS, FREE_VERTICES, Limits

Command = TypeVar("Command", bound=Callable[..., Any])


def limit_options(command: Command) -> Command:
    """Give a command the limits on what it accepts."""
    for name, default, text in (
        (
            "--max-vertices-per-byte",
            DEFAULT_LIMITS.max_vertices_per_byte,
            f"Most vertices for a byte of coded mesh, beyond the first {FREE_VERTICES:,}.",
        ),
        ("--max-tiles", DEFAULT_LIMITS.max_tiles, "Most tiles of a mesh."),
        ("--max-vertices", DEFAULT_LIMITS.max_vertices, "Most vertices of a mesh."),
        ("--max-pixels", DEFAULT_LIMITS.max_pixels, "Most pixels of a picture."),
    ):
        option = click.option(
            name, type=click.IntRange(1), default=default, show_default=True, help=text
        )
        command = option(command)
    return command


def take_limits(options: dict[str, Any]) -> Limits:
    """Limits of a command's options, which lose them."""
    names = ("max_pixels", "max_vertices", "max_tiles", "max_vertices_per_byte")
    return Limits(**{name: options.pop(name) for name in names})
