"""Pages of TIFF files: which one is the photograph, and samples of any depth.

Pillow reads what has up to 8 bits a sample. Deeper samples, of which it keeps 8 bits or none, and
those of files that were cut off are read by `tifffile`, a strip or tile at a time, with the
decompressors of `imagecodecs`.

References
----------
TIFF, Revision 6.0, Adobe Developers Association, 1992.
"""

from __future__ import annotations

import io
import logging
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from math import prod
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np
import numpy.typing as npt
from PIL import Image

from vmesh.arrays import SampleArray
from vmesh.errors import ImageError, LimitError
from vmesh.formats.picture.samples import (
    as_rgba,
    from_numbers,
    from_unsigned,
    without_premultiplication,
)
from vmesh.limits import Limits

if TYPE_CHECKING:
    from tifffile import TiffFile, TiffPage

_STARTS: Final = (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")
# Tags that say how samples are stored, or that are kept elsewhere, as the profile is.
STRUCTURE: Final = frozenset(
    (
        *(*range(254, 260), 262, 266, 273, *range(277, 282), 284, 292, 293, 317),
        *(*range(320, 326), 330, 332, *range(336, 344), 347, *range(512, 522), *range(529, 533)),
        *(700, 33723, 34377, 34675),
    )
)
_BACK_TO_FRONT, _GREY, _RGB = 0, 1, 2  # kinds of colours, tag PhotometricInterpretation
_UNSIGNED: Final = (1, 4)  # tag SampleFormat: integers, or not said
_ASSOCIATED, _UNASSOCIATED = 1, 2  # tag ExtraSamples: alpha
_REDUCED, _MASK = 1, 4  # bits of the tag NewSubfileType
_NO_COMPRESSION, _LZW, _PACKBITS, _DEFLATE = 1, 5, 32773, (8, 32946)
_LONGEST_RUN: Final = 129  # bytes of PackBits
_JPEG: Final = (6, 7, 34892, 33007)
_MOST_SAMPLES: Final = 32  # of a pixel
_MOST_PAGES: Final = 10_000
_MOST_BYTES: Final = 8  # of a strip or tile, for each pixel that a picture may have

# What cameras write that is no picture yet: colours in mosaics, and compressions of their own.
_MOSAICS: Final = (32803, 34892)
_RAW_COMPRESSIONS: Final = (34713, 32767, 32769, 32770, 65000, 65535)
_BITS_PER_SAMPLE, _DNG_VERSION, _ICC, _XMP = 258, 50706, 34675, 700


@dataclass(frozen=True, slots=True)
class Page:
    """A page of a TIFF file.

    Parameters
    ----------
    index : int
        From 0 on.
    size : tuple of int
        Width and height.
    is_secondary : bool
        True of a smaller copy, and of a mask.
    needs_samples : bool
        True if Pillow would lose bits of it.
    is_cut : bool
        True if the file ends before its samples do.
    """

    index: int
    size: tuple[int, int]
    is_secondary: bool
    needs_samples: bool
    is_cut: bool


def is_tiff(data: bytes) -> bool:
    """True of a TIFF file, by its start."""
    return data.startswith(_STARTS)


def read_pages(data: bytes) -> list[Page]:
    """Pages of a file, in its order.

    Raises
    ------
    ImageError
        If there are none, or it is a raw file of a camera.
    """
    with _opened(data) as file:
        pages = [
            Page(
                index,
                (page.imagewidth, page.imagelength),
                bool(int(page.subfiletype) & (_REDUCED | _MASK)),
                _is_deep(page) and int(page.photometric or 0) in (_BACK_TO_FRONT, _GREY, _RGB),
                _is_cut(page, len(data)),
            )
            for index, page in _pages_of(file)
        ]
        if not pages:
            raise ImageError(
                "the image is damaged: its list of pages is missing, as in a TIFF file that was "
                "cut off; nothing of it can be read"
            )
        if data[8:10] == b"CR" or any(_is_raw(page) for _, page in _pages_of(file)):
            raise ImageError(
                "this is a raw file of a camera, which has to be developed first; "
                "export a JPEG, PNG or TIFF"
            )
        return pages


def read_samples(
    data: bytes, index: int, limits: Limits, *, allow_missing: bool
) -> tuple[SampleArray, tuple[str, ...], float]:
    """Samples of a page, which is not turned upright, with notes and the share that is there.

    Returns
    -------
    samples : ndarray
        uint8 or uint16, shape (h, w), (h, w, 3) or (h, w, 4).
    notes : tuple of str
    share : float
        Of the strips or tiles, from 0 to 1.

    Raises
    ------
    ImageError
        If samples of this kind are not read, or damaged, or missing and may not be.
    LimitError
        If a strip or tile would take too much memory.
    """
    with _opened(data) as file:
        page = dict(_pages_of(file))[index]
        _check(page, limits)
        values, share = _read_values(data, page, allow_missing=allow_missing)
        return *_colors_of(values, page), share


def carrier_of(data: bytes, index: int) -> Image.Image:
    """An image with the metadata of a page, but none of its pixels."""
    carrier = Image.new("L", (1, 1))
    with _opened(data) as file:
        page = dict(_pages_of(file))[index]
        for tag, name in ((_ICC, "icc_profile"), (_XMP, "xmp")):
            value = page.tags.valueof(tag)
            if isinstance(value, bytes):
                carrier.info[name] = value
        exif = Image.Exif()
        exif.endian, exif.bigtiff = file.byteorder, file.is_bigtiff
        try:
            exif.load_from_fp(io.BytesIO(data), page.offset)
            for tag in exif.keys() & STRUCTURE:
                del exif[tag]
            carrier.info["exif"] = exif.tobytes()
        except Exception:  # a block that makes no sense is not worth the picture
            return carrier
    return carrier


@contextmanager
def _opened(data: bytes) -> Iterator[TiffFile]:
    """A file in memory; errors of the reader, which are of many kinds, say that it is damaged."""
    import tifffile

    # What it logs about damaged files is told by our own errors.
    logging.getLogger("tifffile").addHandler(_SILENT)
    try:
        with tifffile.TiffFile(io.BytesIO(data)) as file:
            yield file
    except (ImageError, LimitError, MemoryError):
        raise
    except Exception as error:
        raise ImageError(f"the image is damaged: {error}") from None


_SILENT: Final = logging.NullHandler()


def _pages_of(file: TiffFile) -> Iterator[tuple[int, TiffPage]]:
    """Pages that can be made sense of, with their places."""
    for index in range(_MOST_PAGES):
        try:
            page = file.pages[index]
        except IndexError:
            return
        except (ValueError, KeyError, TypeError, OSError):
            continue
        yield index, page  # type: ignore[misc]


def _is_deep(page: TiffPage) -> bool:
    """True if samples are no unsigned integers of up to 8 bits."""
    bits = page.bitspersample
    return page.sampleformat not in _UNSIGNED or not isinstance(bits, int) or bits > 8


def _is_cut(page: TiffPage, n_bytes: int) -> bool:
    return any(
        offset + count > n_bytes
        for offset, count in zip(page.dataoffsets, page.databytecounts, strict=False)
    )


def _is_raw(page: TiffPage) -> bool:
    """True of a page as cameras write it, or with such a page below it."""
    if _DNG_VERSION in page.tags:
        return True
    below = list(page.pages or ())[:8]
    return any(
        int(candidate.photometric or 0) in _MOSAICS
        or int(candidate.compression) in _RAW_COMPRESSIONS
        for candidate in (page, *below)
        if hasattr(candidate, "photometric")
    )


def _check(page: TiffPage, limits: Limits) -> None:
    """Refuse what is not read, or would take too much memory."""
    kind, n_samples = int(page.photometric or 0), page.samplesperpixel
    if kind not in (_BACK_TO_FRONT, _GREY, _RGB) or page.dtype is None or page.imagedepth != 1:
        raise ImageError(
            f"unsupported: TIFF samples of {page.bitspersample} bits, format "
            f"{_name(page.sampleformat)}, colours {_name(page.photometric)}"
        )
    if n_samples > 1 and _BITS_PER_SAMPLE not in page.tags:
        raise ImageError("the image is damaged: it does not say how many bits its samples have")
    if page.dtype.kind not in "uifb":
        raise ImageError(f"unsupported: TIFF samples of type {page.dtype}")
    if n_samples > _MOST_SAMPLES or (kind == _RGB and n_samples < 3):
        raise ImageError(f"unsupported: TIFF pixels of {n_samples} samples")
    sides = (page.tilewidth, page.tilelength) if page.is_tiled else _strip_size(page)
    if page.is_tiled and page.tiledepth != 1:
        raise ImageError("unsupported: TIFF tiles of volumes")
    if prod(sides) * n_samples * page.dtype.itemsize > _MOST_BYTES * limits.max_pixels:
        raise LimitError(
            f"a strip or tile of {sides[0]} x {sides[1]} pixels takes more than "
            f"{_MOST_BYTES} bytes for each of the {limits.max_pixels} pixels of the limit"
        )


def _strip_size(page: TiffPage) -> tuple[int, int]:
    return page.imagewidth, min(page.rowsperstrip, page.imagelength)


def _name(value: Any) -> str:
    return str(getattr(value, "name", value)).lower()


def _read_values(
    data: bytes, page: TiffPage, *, allow_missing: bool
) -> tuple[npt.NDArray[Any], float]:
    """Samples as they are stored, shape (h, w, c), and the share of strips or tiles read."""
    n_samples, height, width = page.samplesperpixel, page.imagelength, page.imagewidth
    assert page.dtype is not None
    values = np.zeros((height, width, n_samples), dtype=page.dtype)
    if page.dtype.kind == "u" and not page.extrasamples:
        values[:] = 1 << (int(page.bitspersample) - 1)  # grey
    n_segments = prod(page.chunked)
    share = 0.0
    for index in range(n_segments):
        segment = _read_segment(data, page, index, allow_missing=allow_missing)
        pixels, (plane, _, row, column, _) = segment.pixels, segment.place
        n_rows, n_columns = min(segment.n_rows, height - row), min(pixels.shape[1], width - column)
        place = values[row : row + n_rows, column : column + n_columns]
        if page.planarconfig == 1:
            place[:] = pixels[:n_rows, :n_columns]
        else:
            place[:, :, plane] = pixels[:n_rows, :n_columns, 0]
        share += segment.n_rows / len(pixels) / n_segments
    return values, min(1.0, round(share, 6))


class _Segment(NamedTuple):
    """A strip or tile: pixels of shape (rows, columns, c), their place, and the rows there are."""

    pixels: npt.NDArray[Any]
    place: tuple[int, ...]
    n_rows: int


def _read_segment(data: bytes, page: TiffPage, index: int, *, allow_missing: bool) -> _Segment:
    """Pixels of a strip or tile; of one that is missing, none."""
    tables: dict[str, Any] = {}
    if int(page.compression) in _JPEG:
        tables = {"jpegtables": page.jpegtables, "jpegheader": page.jpegheader}
    is_listed = index < min(len(page.dataoffsets), len(page.databytecounts))
    start, count = (page.dataoffsets[index], page.databytecounts[index]) if is_listed else (0, 0)
    piece = data[start : start + count]
    _, place, shape = page.decode(None, index)
    n_rows = shape[1]
    if is_listed and count == 0:  # a file may leave out what is all empty
        return _Segment(np.zeros(shape[1:], dtype=page.dtype), place, n_rows)
    try:
        if len(piece) < max(1, count):
            if not allow_missing:
                raise EOFError("the file ends before its samples do")
            piece, n_rows = _completed(piece, page, shape[1:])
        pixels, place, _ = page.decode(piece, index, **tables)
    except MemoryError:
        raise
    except Exception as error:
        if allow_missing:
            return _Segment(np.zeros(shape[1:], dtype=page.dtype), place, 0)
        raise ImageError(f"the image is damaged: {error}") from None
    if pixels is None:
        raise ImageError("the image is damaged: a strip or tile of it is empty")
    return _Segment(pixels[0], place, n_rows)


def _completed(piece: bytes, page: TiffPage, shape: tuple[int, ...]) -> tuple[bytes, int]:
    """The start of a strip or tile with zeros behind it, coded as it was, and its whole rows."""
    import imagecodecs

    n_bytes = -(-shape[1] * shape[2] * int(page.bitspersample) // 8)
    codecs: dict[int, tuple[Callable[[bytes], Any], Callable[[bytes], Any]]] = {
        _NO_COMPRESSION: (bytes, bytes),
        _LZW: (imagecodecs.lzw_decode, imagecodecs.lzw_encode),
        _PACKBITS: (_unpack_start, imagecodecs.packbits_encode),
        **dict.fromkeys(_DEFLATE, (_inflate_start, zlib.compress)),
    }
    decode, encode = codecs[int(page.compression)]
    start = bytes(decode(piece))[: shape[0] * n_bytes]
    return bytes(encode(start.ljust(shape[0] * n_bytes, b"\0"))), len(start) // n_bytes


def _unpack_start(piece: bytes) -> bytes:
    """Unpack a piece of PackBits, whose last run may be cut off."""
    import imagecodecs

    for n_left_out in range(min(len(piece), _LONGEST_RUN) + 1):
        try:
            return bytes(imagecodecs.packbits_decode(piece[: len(piece) - n_left_out]))
        except imagecodecs.PackbitsError:
            continue
    return b""


def _inflate_start(piece: bytes) -> bytes:
    return zlib.decompressobj().decompress(piece)


def _colors_of(values: npt.NDArray[Any], page: TiffPage) -> tuple[SampleArray, tuple[str, ...]]:
    """Grey, RGB or RGBA of samples as they are stored."""
    kind = int(page.photometric or 0)
    n_colors = 3 if kind == _RGB else 1
    # Four samples that nothing is said of are taken for RGBA, as programs of old meant them.
    extras = tuple(int(extra) for extra in page.extrasamples)
    if not extras and values.shape[2] == n_colors + 1:
        extras = (_UNASSOCIATED,)
    has_alpha = bool(extras) and extras[0] in (_ASSOCIATED, _UNASSOCIATED)
    colors = values[:, :, :n_colors]
    notes: tuple[str, ...] = ()
    if _is_plain(page):
        samples = from_unsigned(colors, int(page.bitspersample))
    else:
        samples, notes = from_numbers(colors)
    white = np.iinfo(samples.dtype).max
    if kind == _BACK_TO_FRONT:
        samples = white - samples
    if not has_alpha:
        return (samples if n_colors == 3 else samples[:, :, 0]), notes
    alpha = _alpha_of(values[:, :, n_colors : n_colors + 1], page)
    samples = np.concatenate((samples, alpha.astype(samples.dtype)), axis=2)
    if n_colors == 1:
        samples = as_rgba(samples)
    if extras[0] == _ASSOCIATED:
        samples = without_premultiplication(samples)
    return samples, notes


def _is_plain(page: TiffPage) -> bool:
    """True if samples are unsigned integers of up to 16 bits, whose white is known."""
    return page.sampleformat in _UNSIGNED and int(page.bitspersample) <= 16


def _alpha_of(values: npt.NDArray[Any], page: TiffPage) -> SampleArray:
    """Alpha, opaque at the largest value of its type, and at 1 in floats."""
    if _is_plain(page):
        return from_unsigned(values, int(page.bitspersample))
    largest = 1.0 if values.dtype.kind == "f" else float(np.iinfo(values.dtype).max)
    shares = np.clip(np.nan_to_num(values.astype(np.float64) / largest), 0, 1)
    return np.rint(shares * 65_535).astype(np.uint16)
