"""Metadata without what is nobody else's business."""

from __future__ import annotations

from typing import Literal

from vmesh.mesh import Metadata

Strip = Literal["none", "private", "all"]
"""What is left out of metadata; the ICC profile stays, since the colours mean nothing without."""


def stripped(metadata: Metadata, strip: Strip) -> Metadata:
    """Metadata without those that `strip` names.

    Parameters
    ----------
    metadata : Metadata
    strip : {"none", "private", "all"}
        Private are places, serial numbers, names of owners, makers' notes, thumbnails, histories
        of editing, and whatever is not known. All are all but the ICC profile.
    """
    if strip == "none":
        return metadata
    if strip == "all":
        return Metadata(icc=metadata.icc)
    from vmesh.formats.metadata.public_exif import public_exif
    from vmesh.formats.metadata.xmp import public_packet

    exif, xmp = public_exif(metadata.exif), public_packet(metadata.xmp)
    return Metadata(icc=metadata.icc, exif=exif, xmp=xmp)
