"""Inputs and outputs of commands: files, standard input and standard output."""

from __future__ import annotations

import errno
import io
import os
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, Final

import click

from vmesh.codec.layout import FILE_SUFFIX, is_vmesh
from vmesh.errors import FormatError, ImageError, LimitError, PartialFileWarning, shown
from vmesh.files import Times, atomic_output

if TYPE_CHECKING:
    from vmesh.arrays import Float64Array
    from vmesh.formats.picture.options import PictureOptions
    from vmesh.formats.picture.picture import Picture
    from vmesh.limits import Limits
    from vmesh.mesh import Mesh

STANDARD = "-"
STANDARD_OUTPUT: Final = "standard output"


def read_input(path: str) -> bytes:
    """Bytes of a file or of standard input."""
    try:
        if path != STANDARD:
            return Path(path).read_bytes()
        if sys.stdin is None:
            raise OSError("standard input is closed")
        return sys.stdin.buffer.read()
    except OSError as error:
        if error.filename is None and error.errno is not None:
            error.filename = "standard input" if path == STANDARD else path
        raise


def write_output(
    path: str,
    write: Callable[[BinaryIO], object],
    *,
    replace: bool = True,
    times: Times | None = None,
) -> None:
    """Let `write` fill a file, which takes its name when it is whole, or standard output."""
    if path == STANDARD:
        if sys.stdout is None:
            raise OSError("standard output is closed")
        buffer = io.BytesIO()
        write(buffer)
        with _standard_output():
            sys.stdout.buffer.write(buffer.getvalue())
            sys.stdout.buffer.flush()
        return
    with atomic_output(path, replace=replace, times=times) as stream:
        write(stream)


def tell(text: str, *, is_line: bool = True) -> None:
    """Print what a command was asked for on standard output."""
    with _standard_output():
        click.echo("\n".join(map(shown, text.split("\n"))), nl=is_line)


def remark(text: str) -> None:
    """Print a line on standard error, beside what a command was asked for."""
    click.echo(f"vmesh: {shown(text)}", err=True)


@contextmanager
def _standard_output() -> Iterator[None]:
    """Errors of the system in the block name standard output."""
    try:
        yield
    except OSError as error:
        error.filename = STANDARD_OUTPUT
        raise


def check_suffix(path: str, suffixes: tuple[str, ...]) -> None:
    """Refuse an output whose name does not end in one of `suffixes`."""
    if path != STANDARD and Path(path).suffix.lower() not in suffixes:
        raise click.UsageError(f"{shown(path)}: expected a name that ends in {', '.join(suffixes)}")


def make_folder(path: str) -> None:
    """Make a folder, or refuse one that cannot be written."""
    Path(path).mkdir(parents=True, exist_ok=True)
    check_folder(path)


def check_folder(path: str) -> None:
    """Refuse a folder that cannot be written, before time is spent on what it should hold."""
    Path(path).stat()
    if not os.access(path, os.W_OK | os.X_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), path)


def read_mesh(path: str, limits: Limits, *, allow_partial: bool = False) -> Mesh:
    """Mesh of a .vmesh file; if it may be partial, a line on standard error says that it is."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", PartialFileWarning)
        mesh = _mesh_of(read_input(path), path, limits, allow_partial=allow_partial)
    for warning in caught:
        remark(f"{path}: {warning.message}")
    return mesh


def read_photograph(path: str, options: PictureOptions, limits: Limits) -> Picture:
    """The photograph in an image file; its notes are told on standard error."""
    data = read_input(path)
    if is_vmesh(data):
        raise ImageError(f"{shown(path)}: this is a .vmesh file, a photograph is needed")
    return _photograph_of(data, path, options, limits)


def read_mesh_or_photograph(path: str, options: PictureOptions, limits: Limits) -> Mesh | Picture:
    """Mesh or photograph in a file, by its content; a name that ends in .vmesh promises a mesh."""
    data = read_input(path)
    if is_vmesh(data) or Path(path).suffix.lower() == FILE_SUFFIX:
        return _mesh_of(data, path, limits)
    return _photograph_of(data, path, options, limits)


def read_weights(mask: str | None, photograph: Picture, limits: Limits) -> Float64Array | None:
    """Weights of a photograph's pixels by the mask in an image file; None without one."""
    if mask is None:
        return None
    from vmesh.formats.picture.mask import read_mask

    height, width = photograph.array.shape[:2]
    try:
        return read_mask(io.BytesIO(read_input(mask)), width, height, limits=limits)
    except (ImageError, LimitError) as error:
        raise type(error)(f"{shown(mask)}: {error}") from None


def _mesh_of(data: bytes, path: str, limits: Limits, *, allow_partial: bool = False) -> Mesh:
    from vmesh.codec.reader import loads

    try:
        return loads(data, limits=limits, allow_partial=allow_partial)
    except FormatError as error:
        raise FormatError(error.code, f"{shown(path)}: {error.message}", error.offset) from None
    except LimitError as error:
        raise LimitError(f"{shown(path)}: {error}") from None


def _photograph_of(data: bytes, path: str, options: PictureOptions, limits: Limits) -> Picture:
    from vmesh.formats.picture.picture import read_picture

    if not data:
        raise ImageError(f"{shown(path)}: the file is empty")
    try:
        picture = read_picture(io.BytesIO(data), options=options, limits=limits)
    except (ImageError, LimitError) as error:
        raise type(error)(f"{shown(path)}: {error}") from None
    for note in picture.notes:
        remark(f"{path}: {note}")
    return picture
