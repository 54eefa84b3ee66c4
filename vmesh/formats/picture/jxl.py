"""Headers of JPEG XL pictures: what its plug-in for Pillow does not tell before it decodes them.

References
----------
ISO/IEC 18181-1:2024, JPEG XL image coding system, Part 1: Core coding system, image headers.
"""

from __future__ import annotations

from typing import Final

from vmesh.errors import ImageError

_CODESTREAM: Final = b"\xff\x0a"
_BOXES: Final = (b"jxlc", b"jxlp")  # a codestream in one piece, or the first of several
_PIECE_NUMBER: Final = 4
_BITS: Final = (9, 13, 18, 30)
_RATIOS: Final = ((1, 1), (12, 10), (4, 3), (3, 2), (16, 9), (5, 4), (2, 1))
_PLAIN_DEPTH: Final = 8
_FLOAT_DEPTH: Final = 16
_HEADER: Final = 16  # bytes, more than a size takes


def size_of_jxl(data: bytes) -> tuple[int, int]:
    """Width and height of a picture, as its header has them.

    Raises
    ------
    ImageError
        If there is no header.
    """
    return _read_size(_header(data))


def depth_of_jxl(data: bytes) -> int:
    """Bits of a sample, as the header has them; 8 where it says more than we follow."""
    bits = _header(data)
    _read_size(bits)
    is_plain = bits.take(1)
    if is_plain:
        return _PLAIN_DEPTH
    has_more = bits.take(1)
    if has_more:
        bits.take(3)  # orientation
        if bits.take(3):  # another size, a preview, an animation
            return _PLAIN_DEPTH
    is_float = bits.take(1)
    choice = bits.take(2)
    return _FLOAT_DEPTH if is_float else (8, 10, 12, 1 + bits.take(6))[choice]


class _Bits:
    """Bits of a header, the lowest of a byte first."""

    def __init__(self, data: bytes) -> None:
        self._left = int.from_bytes(data, "little")

    def take(self, n: int) -> int:
        value = self._left & ((1 << n) - 1)
        self._left >>= n
        return value


def _header(data: bytes) -> _Bits:
    start = data if data.startswith(_CODESTREAM) else _codestream(data)
    if len(start) < len(_CODESTREAM) + 2:
        raise ImageError("the image is damaged: there is no picture in this JPEG XL file")
    return _Bits(start[len(_CODESTREAM) : _HEADER])


def _read_size(bits: _Bits) -> tuple[int, int]:
    is_small = bits.take(1)

    def side() -> int:
        return (1 + bits.take(5)) * 8 if is_small else 1 + bits.take(_BITS[bits.take(2)])

    height = side()
    ratio = bits.take(3)
    if ratio == 0:
        return side(), height
    across, down = _RATIOS[ratio - 1]
    return height * across // down, height


def _codestream(data: bytes) -> bytes:
    """The start of the codestream in a container, empty if there is none."""
    at = 0
    while at + 8 <= len(data):
        length, kind, start = (
            int.from_bytes(data[at : at + 4], "big"),
            data[at + 4 : at + 8],
            at + 8,
        )
        if length == 1:
            length, start = int.from_bytes(data[at + 8 : at + 16], "big"), at + 16
        if kind in _BOXES:
            start += _PIECE_NUMBER if kind == b"jxlp" else 0
            return data[start : start + _HEADER]
        if length < start - at:
            break
        at += length
    return b""
