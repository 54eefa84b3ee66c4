"""Sheets of an encoding: its stages side by side, or one of them alone."""

from __future__ import annotations

import numpy as np

from vmesh.inspection.layout import Layout
from vmesh.inspection.panels import enlargement_panels, figures_of, stage_panels
from vmesh.inspection.region import Region
from vmesh.inspection.sheet.items import Sheet, printable
from vmesh.inspection.stages import Inspection
from vmesh.inspection.views import DRAWINGS


def view_sheet(
    inspection: Inspection, show: str, region: Region | None = None, scale: float | None = None
) -> Sheet:
    """Sheet of one stage of `DRAWINGS` alone; region and scale as for :func:`stages_sheet`.

    Unless a scale is given, the whole picture is drawn at its own.
    """
    shown = _region(inspection, region)
    if scale is None:
        longest = max(inspection.original.shape[:2])
        scale = 1.0 if region is None else shown.good_scale(longest)
    view = shown.view(scale)
    inspection.limits.check_pixels(view.width, view.height)
    return Sheet(view.width, view.height, tuple(DRAWINGS[show](inspection, view)), show)


def stages_sheet(
    inspection: Inspection,
    title: str,
    region: Region | None = None,
    scale: float | None = None,
) -> Sheet:
    """Sheet of all stages of an encoding; or, for a region, of enlargements that stay sharp.

    Parameters
    ----------
    inspection : Inspection
    title : str
        Such as the name of the file.
    region : Region, optional
        The whole picture unless given.
    scale : float, optional
        Units of the sheet for a pixel; one that suits the screen unless given.

    Raises
    ------
    ValueError
        If the region is not within the picture, or the scale too large for it.
    LimitError
        If the sheet has more pixels than the inspection's limits allow.
    """
    shown = _region(inspection, region)
    factor = scale or shown.good_scale(max(inspection.original.shape[:2]))
    view = shown.view(factor)
    if region is None:
        panels = stage_panels(inspection)
    else:
        panels = enlargement_panels(inspection, region, is_enlarged=factor > 1)
        title = f"{title}: {region.width} x {region.height} pixels, {_times(factor)}"
    layout = Layout.of(view, len(panels))
    inspection.limits.check_pixels(layout.width, layout.height)
    items = [*layout.header(printable(title), figures_of(inspection))]
    for i, panel in enumerate(panels):
        items += layout.panel(inspection, shown, panel, i)
    return Sheet(layout.width, layout.height, tuple(items), printable(title))


def _region(inspection: Inspection, region: Region | None) -> Region:
    height, width = inspection.original.shape[:2]
    if region is None:
        return Region(0, 0, width, height)
    region.check_within(width, height)
    return region


def _times(scale: float) -> str:
    if scale == 1:
        return "at their own size"
    number = np.format_float_positional(scale, 3, fractional=False, trim="-")
    return f"{number} times as large"
