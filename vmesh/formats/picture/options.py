"""Options of reading a photograph."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True, slots=True)
class PictureOptions:
    """Choices of a user about reading a photograph.

    Parameters
    ----------
    page : int, optional
        Page of a file with several pages, or frame of an animation, from 1 on. Of pages the largest
        is read unless this says another; of an animation the first frame.
    allow_truncated : bool
        Read what there is of a file that was cut off; the rest is grey.
    to_srgb : bool
        Convert colours to sRGB, and leave their profile out.
    """

    page: int | None = None
    allow_truncated: bool = False
    to_srgb: bool = False

    def __post_init__(self) -> None:
        if self.page is not None and self.page < 1:
            raise ValueError(f"expected a page of 1 or more, got {self.page}")


DEFAULT_OPTIONS: Final = PictureOptions()
