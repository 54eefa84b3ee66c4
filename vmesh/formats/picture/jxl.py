"""Sizes of JPEG XL pictures, which its plug-in for Pillow does not tell before it decodes them."""

from __future__ import annotations

from typing import Final

from vmesh.errors import ImageError

_CODESTREAM: Final = b"\xff\x0a"
_BOXES: Final = (b"jxlc", b"jxlp")  # a codestream in one piece, or the first of several
_PIECE_NUMBER: Final = 4
_BITS: Final = (9, 13, 18, 30)
# Width to height, by ISO/IEC 18181-1, section "Image dimensions".
_RATIOS: Final = ((1, 1), (12, 10), (4, 3), (3, 2), (16, 9), (5, 4), (2, 1))
_HEADER: Final = 16  # bytes, more than a size takes


def size_of_jxl(data: bytes) -> tuple[int, int]:
    """Width and height of a picture, as its header has them.

    Raises
    ------
    ImageError
        If there is no header.
    """
    start = data if data.startswith(_CODESTREAM) else _codestream(data)
    if len(start) < len(_CODESTREAM) + 2:
        raise ImageError("the image is damaged: there is no picture in this JPEG XL file")
    bits = int.from_bytes(start[len(_CODESTREAM) : _HEADER], "little")

    def take(n: int) -> int:
        nonlocal bits
        value = bits & ((1 << n) - 1)
        bits >>= n
        return value

    is_small = take(1)

    def side() -> int:
        return (1 + take(5)) * 8 if is_small else 1 + take(_BITS[take(2)])

    height = side()
    ratio = take(3)
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
