"""Metadata without what is nobody else's business."""

from __future__ import annotations

from typing import Literal

from vmesh.mesh import Metadata

Strip = Literal["none", "private", "all"]
"""What is left out of metadata; the ICC profile stays, since the colours mean nothing without."""


def stripped(metadata: Metadata, strip: Strip) -> Metadata:
    """Metadata without those that `strip` names."""
    if strip == "none":
        return metadata
    return Metadata(icc=metadata.icc)
