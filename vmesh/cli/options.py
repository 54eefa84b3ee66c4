"""Options that several commands share."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields
from typing import Any, TypeVar, get_args

import click

from vmesh.encoder.settings import (
    DEFAULT_EFFORT,
    DEFAULT_QUALITY,
    MAX_COLOR_STEP,
    MAX_EFFORT,
    MAX_QUALITY,
    MAX_TILE,
    MIN_TILE,
    ColorMode,
    Diffusion,
    Method,
    Sampler,
    Settings,
)
from vmesh.formats.metadata.privacy import Strip
from vmesh.formats.picture.options import PictureOptions

Command = TypeVar("Command", bound=Callable[..., Any])
Callback = Callable[[click.Context, click.Parameter, str | None], str | None]

_MESH_OPTIONS = (
    click.option(
        "-q",
        "--quality",
        type=click.IntRange(0, MAX_QUALITY),
        help=f"Quality, {DEFAULT_QUALITY} unless another goal is given.",
    ),
    click.option(
        "--target-size",
        type=click.IntRange(1),
        metavar="BYTES",
        help="Size of the file: never above it, within 2 % below.",
    ),
    click.option(
        "--target-psnr",
        type=click.FloatRange(0, 99, min_open=True),
        metavar="DB",
        help="PSNR of the mesh: at least this, within 0.1 dB above.",
    ),
    click.option("--vertices", type=click.IntRange(4, 1 << 31), help="Number of vertices."),
    click.option(
        "--density",
        type=click.FloatRange(0, 1, min_open=True),
        help="Vertices per pixel instead of their number, such as 0.02.",
    ),
    click.option(
        "-e",
        "--effort",
        type=click.IntRange(1, MAX_EFFORT),
        default=DEFAULT_EFFORT,
        show_default=True,
        help="More time for a better mesh of the same size.",
    ),
    click.option(
        "--method",
        type=click.Choice(get_args(Method)),
        default="adaptive",
        show_default=True,
        help="How vertices are found.",
    ),
    click.option(
        "--gamma",
        type=click.FloatRange(0, 10, min_open=True),
        default=1.0,
        show_default=True,
        help="Exponent of the salience; a smaller one gives more points.",
    ),
    click.option(
        "--sampler",
        type=click.Choice(get_args(Sampler)),
        default="multiclass",
        show_default=True,
        help="Colour planes sampled together or each for itself.",
    ),
    click.option(
        "--diffusion",
        type=click.Choice(get_args(Diffusion)),
        default="zhou-fang",
        show_default=True,
        help="Coefficients of the error diffusion.",
    ),
    click.option(
        "--colors",
        type=click.Choice(get_args(ColorMode)),
        default="fitted",
        show_default=True,
        help="Vertex colours by least squares, or those of single pixels.",
    ),
    click.option(
        "--color-step",
        type=click.IntRange(1, MAX_COLOR_STEP),
        help="Rounding of the vertex colours, 1 for none; follows from the error unless given.",
    ),
    click.option(
        "--tile",
        type=click.IntRange(MIN_TILE, MAX_TILE),
        metavar="PIXELS",
        help=f"Side of tiles that are encoded each for itself, {MIN_TILE} to {MAX_TILE}.",
    ),
    click.option(
        "--seed", type=click.IntRange(0), default=0, show_default=True, help="Random seed."
    ),
)
_THREADS_OPTION = click.option(
    "-j",
    "--threads",
    type=click.IntRange(1),
    help="Most threads at once; the result does not depend on it.",
)


_PICTURE_OPTIONS = (
    click.option(
        "--page",
        type=click.IntRange(1),
        help="Page, or frame, of a file with several; unless given, the largest page or the first "
        "frame.",
    ),
    click.option(
        "--allow-truncated",
        is_flag=True,
        help="Read what there is of a photograph that was cut off.",
    ),
    click.option(
        "--to-srgb",
        is_flag=True,
        help="Convert the photograph's colours to sRGB, and leave its profile out.",
    ),
)


def encoder_options(command: Command) -> Command:
    """Give a command the settings of the encoder."""
    return mesh_options(_THREADS_OPTION(command))


def mesh_options(command: Command) -> Command:
    """Give a command the settings of the encoder that decide on the mesh."""
    for option in reversed(_MESH_OPTIONS):
        command = option(command)
    return command


def take_settings(options: dict[str, Any]) -> Settings:
    """Encoder settings of a command's options, which lose them."""
    chosen = {item.name: options.pop(item.name) for item in fields(Settings)}
    try:
        return Settings(**chosen)
    except ValueError as error:
        raise click.UsageError(str(error)) from None


def picture_options(command: Command) -> Command:
    """Give a command the options of reading a photograph."""
    for option in reversed(_PICTURE_OPTIONS):
        command = option(command)
    return command


def take_picture_options(options: dict[str, Any]) -> PictureOptions:
    """Options of reading photographs among a command's options, which lose them."""
    return PictureOptions(**{item.name: options.pop(item.name) for item in fields(PictureOptions)})


def strip_option(default: str) -> Callable[[Command], Command]:
    """Option that says which metadata are left out; `default` is for the help."""
    return click.option(
        "--strip",
        type=click.Choice(get_args(Strip)),
        help="Metadata to leave out: private are places, serial numbers and makers' notes; all "
        f"are all but the colour profile. Unless given, {default}.",
    )


mask_option = click.option(
    "--mask",
    metavar="PICTURE",
    help="Grey picture of any size, stretched over the photograph: the whiter, the more an error "
    "counts there.",
)
quiet_option = click.option("--quiet", is_flag=True, help="No progress on a terminal.")
json_option = click.option("--json", "as_json", is_flag=True, help="Print figures as JSON.")


def checked_by(check: Callable[[str], object]) -> Callback:
    """Callback for an option's text: a usage error if `check` raises a ValueError."""

    def callback(_: click.Context, __: click.Parameter, value: str | None) -> str | None:
        if value is not None:
            try:
                check(value)
            except ValueError as error:
                raise click.BadParameter(str(error)) from None
        return value

    return callback
