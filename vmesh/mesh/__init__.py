"""The mesh and the metadata that travel with it.

``mesh`` is the type itself, with ``checks`` of what it holds; ``canonical_order`` is the order of
files, ``areas`` are those of triangles, ``placement`` is how an affine map moves a canvas.
"""

from __future__ import annotations

from vmesh.mesh.mesh import Mesh
from vmesh.mesh.metadata import Metadata

__all__ = ["Mesh", "Metadata"]
