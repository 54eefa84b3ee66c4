"""Rate-distortion plots as SVG for a page, by matplotlib: the extra ``vmesh[plot]``."""

from __future__ import annotations

import io
import logging
import math
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

from vmesh.errors import VmeshError
from vmesh.report.rivals import Curve

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Told apart without colours too: by their markers.
_STYLES: Final = (("#06c", "o", 2.5), ("#c50", "s", 1.2), ("#271", "^", 1.2), ("#82a", "D", 1.2))
_INCHES: Final = (5.2, 3.4)
# Text stays text, in the page's own fonts where it has those.
_OWN_STYLE: Final = {"svg.fonttype": "none", "font.size": 10, "savefig.transparent": True}
# Names of figures, axes and so on, which would be given twice in a page with several plots.
_NAMES: Final = re.compile(r' id="[\w.]+_\d+"')
_SILENCE: Final = logging.NullHandler()


def check_matplotlib() -> None:
    """Refuse to go on where there is nothing to draw plots with.

    Raises
    ------
    VmeshError
        If matplotlib is not installed.
    """
    try:
        import matplotlib.figure  # noqa: F401
    except ImportError:
        raise VmeshError("the plots of a report need matplotlib: pip install matplotlib") from None
    logging.getLogger("matplotlib").addHandler(_SILENCE)  # it tells of its cache of fonts


def plot_curves(curves: Sequence[Curve], salt: str) -> str:
    """PSNR over bytes, a line for each codec that has points: an ``<svg>`` element.

    `salt` tells the plots of a page apart: what one defines, another has by another name.
    """
    from matplotlib import style
    from matplotlib.figure import Figure

    # What the user has chosen for other figures is no part of the page.
    with style.context(["default", {**_OWN_STYLE, "svg.hashsalt": salt}]):
        figure = Figure(figsize=_INCHES, layout="constrained")
        axes = figure.add_subplot()
        for curve, look in zip(curves, _STYLES, strict=True):
            if curve.points:
                _draw(axes, curve, look)
        _label(axes, [point.n_bytes for point in curves[0].points])
        if not any(math.isfinite(point.psnr) for curve in curves for point in curve.points):
            axes.set_yticks([])
        stream = io.StringIO()
        figure.savefig(stream, format="svg", metadata={"Date": None, "Creator": None})
    text = stream.getvalue()
    return _NAMES.sub("", text[text.index("<svg") :])


def _draw(axes: Axes, curve: Curve, look: tuple[str, str, float]) -> None:
    """The line of a codec; a picture that comes back exactly has no place on it."""
    finite = [point for point in curve.points if math.isfinite(point.psnr)]
    color, marker, width = look
    sizes, decibels = [point.n_bytes for point in finite], [point.psnr for point in finite]
    axes.plot(sizes, decibels, color=color, marker=marker, linewidth=width, label=curve.codec)


def _label(axes: Axes, sizes: Sequence[int]) -> None:
    """Label the axes: bytes by their logarithm, at the sizes that were measured."""
    axes.set_xscale("log")
    axes.set_xticks(sizes, [f"{size:,}" for size in sizes])
    axes.set_xticks([], minor=True)
    axes.set_xlabel("bytes of the file")
    axes.set_ylabel("PSNR over RGB, dB")
    axes.grid(color="#8884")
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False)
