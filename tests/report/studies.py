"""Studies of small pictures, which take a moment each."""

from __future__ import annotations

from typing import Any

from vmesh.arrays import SampleArray
from vmesh.mesh import Metadata
from vmesh.report.study import Study, study


def study_of(
    pixels: SampleArray,
    name: str = "photo.png",
    metadata: Metadata | None = None,
    **settings: Any,
) -> Study:
    """What a report says of a picture, at effort 1 unless another is given."""
    return study(pixels, name=name, metadata=metadata, **({"effort": 1} | settings))
