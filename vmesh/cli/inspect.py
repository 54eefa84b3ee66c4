"""``vmesh inspect``: the stages of an encoding as a picture."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import click

from vmesh.cli.limits import limit_options, take_limits
from vmesh.cli.options import encoder_options, quiet_option, take_settings
from vmesh.cli.progress import show_progress
from vmesh.cli.streams import STANDARD, check_suffix, read_photograph, write_output
from vmesh.formats.registry import FORMATS, RASTER_SUFFIXES, format_of

if TYPE_CHECKING:
    from vmesh.arrays import UInt8Array
    from vmesh.encoder.settings import Settings
    from vmesh.limits import Limits

VIEWS = ("salience", "points", "mesh", "render", "error", "sheet")


@click.command("inspect")
@click.argument("source", metavar="INPUT")
@click.argument("target", metavar="OUTPUT.png")
@click.option(
    "--show",
    type=click.Choice(VIEWS),
    default="sheet",
    show_default=True,
    help="Which stage; a sheet has all of them.",
)
@encoder_options
@limit_options
@quiet_option
def command(source: str, target: str, show: str, quiet: bool, **options: Any) -> None:
    """Draw the stages of the encoding of a photograph: the paper's Figure 4 for any picture."""
    settings, limits = take_settings(options), take_limits(options)
    check_suffix(target, RASTER_SUFFIXES)
    wanted = FORMATS[".png"] if target == STANDARD else format_of(target)
    with show_progress("inspecting", 3, quiet=quiet) as report:
        report("reading")
        picture = read_photograph(source, limits)
        report("encoding")
        drawn = draw(picture.array, settings, show, limits)
        report("writing")
        write_output(target, lambda stream: wanted.writer()(drawn, stream, wanted.raster_name))


def draw(array: UInt8Array, settings: Settings, show: str, limits: Limits) -> UInt8Array:
    """One view of an encoding, shape (h, w, 3), uint8."""
    import numpy as np

    from vmesh.encoder.image import as_image
    from vmesh.encoder.pipeline import encode, propose
    from vmesh.formats import figure
    from vmesh.formats.picture import flatten
    from vmesh.formats.raster import render
    from vmesh.metrics import psnr

    image = as_image(array)
    height, width = image.shape[:2]
    salience, samples = propose(image, settings)
    mesh = encode(array, **asdict(settings))
    limits.check_vertices(mesh.n_vertices)
    original, rendered = flatten(array), flatten(render(mesh, limits=limits), mesh.depth)

    def points() -> UInt8Array:
        vertices = mesh.vertices
        x, y = np.minimum(vertices // 2, [width - 1, height - 1]).T
        # Saturated class colours: what a sample's plane was, as in the paper's figures. Points that
        # have moved since have none.
        classes = samples.classes[y, x] * (settings.method == "blue-noise")
        planes = np.stack([classes >> i & 1 for i in range(3)], axis=1)
        colors = (planes * 220).astype(np.uint8)
        return figure.draw_points(vertices, mesh.unit, width, height, colors)

    views: dict[str, tuple[str, Callable[[], UInt8Array]]] = {
        "original": ("original", lambda: original),
        "salience": ("salience", lambda: figure.draw_salience(salience)),
        "points": (f"{mesh.n_vertices} points", points),
        "mesh": (f"{mesh.n_triangles} triangles", lambda: figure.draw_wireframe(mesh)),
        "render": (f"render, {psnr(original, rendered):.2f} dB", lambda: rendered),
        "error": ("error x 4", lambda: figure.draw_error(original, rendered)),
    }
    if show != "sheet":
        return views[show][1]()
    panels = [figure.Panel(view(), caption) for caption, view in views.values()]
    return figure.compose_sheet(panels, columns=3)
