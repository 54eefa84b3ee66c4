"""Several meshes -> one PDF document, a page each."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator

from vmesh.files import atomic_output
from vmesh.formats.metadata.description import Description
from vmesh.formats.metadata.privacy import Strip, stripped
from vmesh.formats.pdf.document import Backend, write_album
from vmesh.formats.pdf.page_size import Layout, Orientation
from vmesh.limits import DEFAULT_LIMITS, Limits
from vmesh.mesh import Mesh


def export_album(
    meshes: Iterable[Mesh],
    path: str | os.PathLike[str],
    *,
    titles: Iterable[str] | None = None,
    backend: Backend = "native",
    page_width: str | None = None,
    page_size: str | None = None,
    orientation: Orientation | None = None,
    margin: str | None = None,
    strip: Strip | None = None,
    limits: Limits = DEFAULT_LIMITS,
) -> None:
    """Write meshes as a PDF document with a page for each, and an outline of their titles.

    Pages are written one by one as `meshes` gives them: an iterator need not hold more than one.

    Parameters
    ----------
    meshes : iterable of Mesh
    path : path
        Replaced only when the new file is complete.
    titles : iterable of str, optional
        A title for each page; unless given, those in the pictures' EXIF, else numbers.
    backend : {"native", "cairo"}
        What writes the file.
    page_width : str, optional
        Width of each page, such as "210mm".
    page_size : str, optional
        Paper of all pages, such as "A4", "letter" or "210x297mm", on which each picture is in the
        middle, as large as it fits.
    orientation : {"portrait", "landscape"}, optional
        How the paper stands; else one of a name stands as each picture.
    margin : str, optional
        Room around each picture, such as "10mm".
    strip : {"none", "private", "all"}, optional
        Metadata that are left out, "private" unless given.
    limits : Limits
        Limits on each mesh.

    Raises
    ------
    ValueError
        If there are no meshes, not as many titles as meshes, or an option makes no sense.
    LimitError
        If a mesh is more than `limits` allow.
    VmeshError
        If cairo is asked for and not installed.
    """
    layout = Layout(page_width, page_size, orientation, margin)
    pages = (
        (title, mesh.replaced(metadata=stripped(mesh.metadata, strip or "private")))
        for title, mesh in _titled(meshes, titles)
    )
    with atomic_output(path) as stream:
        write_album(pages, stream, backend=backend, layout=layout, limits=limits)


def _titled(meshes: Iterable[Mesh], titles: Iterable[str] | None) -> Iterator[tuple[str, Mesh]]:
    """Meshes with their titles."""
    if titles is None:
        for number, mesh in enumerate(meshes, 1):
            yield Description.of(mesh.metadata).title or str(number), mesh
        return
    left = iter(titles)
    for mesh in meshes:
        title = next(left, None)
        if title is None:
            raise ValueError("expected a title for each mesh, there are fewer")
        yield title, mesh
    if next(left, None) is not None:
        raise ValueError("expected a title for each mesh, there are more")
