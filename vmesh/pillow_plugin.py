"""A plug-in for Pillow: ``.vmesh`` files as images, opened, drawn at any size and saved.

It stands above `formats` and `encoder`, of which it needs both. Pillow finds no plug-ins by itself:
``vmesh.register()`` makes this one known, also to what reads through Pillow, as imageio.
"""

from __future__ import annotations

import io
import warnings
from dataclasses import fields
from difflib import get_close_matches
from math import ceil
from typing import IO, Any, Final

from PIL import Image, ImageFile

from vmesh.codec import layout
from vmesh.codec.container import read_ancillary
from vmesh.codec.metadata import read_metadata
from vmesh.codec.policy import Strict
from vmesh.color_lattice import rescale
from vmesh.encoder.settings import Settings
from vmesh.errors import FormatError, LimitError, VmeshError
from vmesh.formats.metadata.exif import EXIF_START
from vmesh.formats.picture.picture import picture_of
from vmesh.limits import DEFAULT_LIMITS, PLAIN_DEPTH
from vmesh.mesh import Metadata

FORMAT: Final = "VMESH"
MIME_TYPE: Final = "image/vnd.vmesh"

_MODES: Final = {1: "L", 3: "RGB", 4: "RGBA"}
_DEEP_GREY: Final = "I;16"
_MOST_SAMPLES: Final = 4  # per pixel and direction of a smaller picture
_METADATA_OPTIONS: Final = ("icc_profile", "exif", "xmp")
_LIKENESS: Final = 0.9  # of a misspelt setting, by difflib; "speed", of AVIF, is below
_START: Final = 4096  # bytes of a file that are read first


def register() -> None:
    """Let Pillow open ``.vmesh`` files, and save them with the encoder's settings."""
    Image.register_open(FORMAT, VmeshImageFile, layout.is_vmesh)
    Image.register_save(FORMAT, save)
    Image.register_extension(FORMAT, layout.FILE_SUFFIX)
    Image.register_mime(FORMAT, MIME_TYPE)


class VmeshImageFile(ImageFile.ImageFile):
    """A ``.vmesh`` file as an image: opening it reads its header and metadata, drawing the rest."""

    format = FORMAT
    format_description = "Photograph as a triangle mesh"

    def _open(self) -> None:
        """Take size, mode and metadata; what is damaged further on shows in `load`."""
        assert self.fp is not None
        start = self.fp.read(_START)
        try:
            header, _ = layout.read_header(start, Strict())
        except FormatError as error:
            raise SyntaxError(str(error)) from None
        is_deep_grey = header.n_components == 1 and header.depth > PLAIN_DEPTH
        self._mode = _DEEP_GREY if is_deep_grey else _MODES[header.n_components]
        self._canvas = self._size = header.width, header.height
        self._data = b""
        self._is_drawn = False
        self.info.update(_info_of(_metadata_of(start, self.fp)))

    def draft(
        self, mode: str | None, size: tuple[int, int] | None
    ) -> tuple[str, tuple[int, int, float, float]] | None:
        """Set the size to the smallest that has these proportions and covers `size`.

        Called by `thumbnail`, so that small pictures are drawn from the mesh as such.
        """
        if size is None or self._is_drawn:
            return None
        scale = max(wanted / side for wanted, side in zip(size, self._canvas, strict=True))
        if not 0 < scale < 1:
            return None
        self._set_scale(scale)
        return self.mode, (0, 0, *map(float, self.size))  # type: ignore[return-value]

    def load(self, scale: float | None = None) -> Any:
        """Draw the mesh, `scale` times as large as its canvas if it is given.

        Raises
        ------
        OSError
            If the file is damaged, or asks for more than :class:`vmesh.Limits` allow.
        """
        if scale is not None:
            self._set_scale(scale)
        if not self._is_drawn:
            try:
                pixels = _draw(self._whole(), self.size, self.mode)
            except VmeshError as error:
                raise OSError(str(error)) from None
            if self.fp is not None and self._exclusive_fp:
                self.fp.close()
            # As the plug-ins of other formats that are decoded in one go: Pillow copies samples.
            self.fp = io.BytesIO(pixels)
            self.tile = [ImageFile._Tile("raw", (0, 0, *self.size), 0, self.mode)]
            self._is_drawn = True
        return super().load()

    def _whole(self) -> bytes:
        """The bytes of the file, which stay at hand for another size."""
        if not self._data:
            assert self.fp is not None
            self.fp.seek(0)
            self._data = self.fp.read()
        return self._data

    def _set_scale(self, scale: float) -> None:
        """Set the size that is drawn next."""
        if not 0 < scale < float("inf"):
            raise ValueError(f"expected a scale above 0, got {scale}")
        width, height = self._canvas
        self._size = max(1, round(width * scale)), max(1, round(height * scale))
        self._is_drawn = False


def save(image: Image.Image, stream: IO[bytes], filename: str | bytes) -> None:
    """Encode an image; the options of `save` that :func:`vmesh.encode` has are its settings.

    The ICC profile, EXIF and XMP are the image's own unless the options ``icc_profile``, ``exif``
    and ``xmp`` give others. The EXIF orientation is applied. Options of other formats are passed
    over, as plug-ins of Pillow do; one that is nearly a setting's name is taken for a slip. A
    warning tells if the samples have no white that is known, and were spread over 16 bits.

    Raises
    ------
    TypeError
        If an option is a misspelt setting.
    """
    from vmesh.codec.writer import dumps
    from vmesh.encoder.pipeline import encode_with

    options = image.encoderinfo
    settings = _settings_of(options)
    picture = picture_of(_with_metadata(image, options), opened=image)
    for note in picture.notes:
        warnings.warn(f"{FORMAT}: {note}", stacklevel=3)
    stream.write(dumps(encode_with(picture.array, settings, metadata=picture.metadata)))


def _settings_of(options: dict[str, Any]) -> Settings:
    """Settings among the options of `save`."""
    names = [field.name for field in fields(Settings)]
    for option in options.keys() - {*names, *_METADATA_OPTIONS}:
        for name in get_close_matches(option, names, n=1, cutoff=_LIKENESS):
            raise TypeError(f"a .vmesh file takes no option {option!r}: did you mean {name!r}?")
    return Settings(**{name: options[name] for name in names if name in options})


def _with_metadata(image: Image.Image, options: dict[str, Any]) -> Image.Image:
    """The image with those metadata that the options of `save` give."""
    copy = image.copy()
    for name in ("icc_profile", "xmp"):
        if name in options:
            copy.info[name] = options[name] or b""
    if "exif" in options:
        exif = options["exif"] or b""
        copy.info["exif"] = exif.tobytes() if isinstance(exif, Image.Exif) else exif
    return copy


def _metadata_of(start: bytes, stream: IO[bytes]) -> Metadata:
    """Metadata of a file, of which a start is read; none if it is damaged: `load` says so."""
    try:
        try:
            ancillary = read_ancillary(start)
        except FormatError:  # they may be longer
            ancillary = read_ancillary(start + stream.read())
        return read_metadata(ancillary, DEFAULT_LIMITS, Strict())
    except (FormatError, LimitError):
        return Metadata()


def _info_of(metadata: Metadata) -> dict[str, bytes]:
    """Metadata by Pillow's names."""
    exif = EXIF_START + metadata.exif if metadata.exif else b""
    named = {"icc_profile": metadata.icc, "exif": exif, "xmp": metadata.xmp}
    return {name: block for name, block in named.items() if block}


def _draw(data: bytes, size: tuple[int, int], mode: str) -> bytes:
    """Samples of a file's picture at a size; smaller ones take means of several centres."""
    from vmesh.codec.reader import loads
    from vmesh.formats.raster.rendering import render

    mesh = loads(data)
    shrink = max(mesh.width / size[0], mesh.height / size[1])
    supersample = max(1, min(_MOST_SAMPLES, ceil(shrink)))
    pixels = render(mesh, width=size[0], height=size[1], supersample=supersample)
    samples = rescale(pixels, mesh.depth, 16 if mode == _DEEP_GREY else 8)
    return samples.astype(samples.dtype.newbyteorder("<")).tobytes()
