"""Pages and frames of a file: which one is the photograph."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from PIL import Image

from vmesh.arrays import BoolArray
from vmesh.errors import ImageError

# The further pictures of a phone's JPEG are smaller copies, maps of depth and of brightness.
_WITH_COMPANIONS: Final = ("JPEG", "MPO")
_TO_BACKGROUND, _TO_PREVIOUS = 2, 3  # ways to dispose of a frame of a GIF


def choose_largest(
    sizes: Sequence[tuple[int, int]], is_secondary: Sequence[bool], wanted: int | None
) -> tuple[int, tuple[str, ...]]:
    """Place of the page to read, from 0 on, and a note if others were left out.

    Parameters
    ----------
    sizes : sequence of (int, int)
        Width and height of each page.
    is_secondary : sequence of bool
        Pages that are smaller copies or masks of others.
    wanted : int, optional
        The page that the user asks for, from 1 on.

    Raises
    ------
    ImageError
        If there is none such.
    """
    n_pages = len(sizes)
    if wanted is not None:
        return _asked_for(wanted, n_pages, "page"), ()
    main = [n for n in range(n_pages) if not is_secondary[n]] or list(range(n_pages))
    index = max(main, key=lambda n: sizes[n][0] * sizes[n][1])
    if n_pages == 1:
        return index, ()
    return index, (f"it has {n_pages} pages; page {index + 1}, the largest, was read (--page)",)


def go_to_frame(image: Image.Image, wanted: int | None) -> tuple[Image.Image, tuple[str, ...]]:
    """The image at the frame to read, and a note if others were left out.

    Raises
    ------
    ImageError
        If there is no such frame.
    """
    if image.format == "ICO":
        return _icon(image, wanted)
    n_frames = _count_frames(image)
    if wanted is not None:
        index = _asked_for(wanted, n_frames, "frame" if is_animation(image) else "page")
        if index != image.tell():
            image.seek(index)
        return image, ()
    if n_frames == 1 or image.format in _WITH_COMPANIONS:
        return image, ()
    if not is_animation(image):
        main = image.tell() + 1
        return image, (f"it has {n_frames} pages; page {main}, the main one, was read (--page)",)
    if getattr(image, "default_image", False):
        left_out = "1 frame" if n_frames == 2 else f"{n_frames - 1} frames"
        return image, (
            f"its still picture was read, and the {left_out} of its animation left out (--page)",
        )
    return image, (f"it is an animation of {n_frames} frames; the first was read (--page)",)


def is_animation(image: Image.Image) -> bool:
    """True if the frames of a file follow each other in time."""
    return image.format in ("GIF", "PNG", "WEBP", "AVIF", "JXL")


def uncovered(image: Image.Image) -> BoolArray | None:
    """Pixels of a GIF's canvas that no frame has painted up to the present one.

    They are transparent in browsers, whatever background the file names. The frame is loaded.

    Returns
    -------
    ndarray or None
        Shape (h, w), bool; None if there are none.
    """
    present = image.tell()
    boxes, disposals = [], []
    for index in range(present + 1):
        image.seek(index)
        tiles = getattr(image, "tile", None)
        boxes.append(tiles[0].extents if tiles else (0, 0, *image.size))
        disposals.append(getattr(image, "disposal_method", 0))
        image.load()
    is_painted = np.zeros((image.height, image.width), dtype=bool)
    for index, ((left, top, right, bottom), disposal) in enumerate(
        zip(boxes, disposals, strict=True)
    ):
        place = is_painted[top:bottom, left:right]
        before = place.copy()
        place[:] = True
        if index < present and disposal in (_TO_BACKGROUND, _TO_PREVIOUS):
            place[:] = before if disposal == _TO_PREVIOUS else False
    return None if is_painted.all() else ~is_painted


def _count_frames(image: Image.Image) -> int:
    """Frames of a file; only the first where the rest makes no sense."""
    try:
        return int(getattr(image, "n_frames", 1))
    except MemoryError:
        raise
    except Exception:
        image.seek(0)
        return 1


def _asked_for(wanted: int, n_there: int, name: str) -> int:
    if wanted > n_there:
        there = f"1 {name}" if n_there == 1 else f"{n_there} {name}s"
        raise ImageError(f"{name} {wanted} was asked for, but the file has {there}")
    return wanted - 1


def _icon(image: Image.Image, wanted: int | None) -> tuple[Image.Image, tuple[str, ...]]:
    """A picture of an icon: the largest, and of several the one with the most colours."""
    icon = image.ico  # type: ignore[attr-defined]
    entries = sorted(icon.entry, key=lambda entry: int(entry.offset))
    if wanted is None:
        chosen = max(entries, key=lambda entry: (entry.square, entry.bpp))
    else:
        chosen = entries[_asked_for(wanted, len(entries), "page")]
    number = entries.index(chosen) + 1
    notes = (f"it has {len(entries)} pages; page {number}, the largest, was read (--page)",)
    picture = icon.frame(icon.entry.index(chosen))
    return picture, notes if wanted is None and len(entries) > 1 else ()
