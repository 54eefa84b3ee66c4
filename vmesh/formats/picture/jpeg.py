"""Scans of JPEG files: whether all of a picture's coefficients are announced.

References
----------
ITU-T T.81 | ISO/IEC 10918-1, Digital compression and coding of continuous-tone still images, 1992,
annexes B and G.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

_START: Final = b"\xff\xd8\xff"
_SCAN: Final = 0xDA
_PROGRESSIVE: Final = (0xC2, 0xC6, 0xCA, 0xCE)
_FRAMES: Final = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}
_ALONE: Final = frozenset((0x01, *range(0xD0, 0xDA)))  # markers without a segment
_N_COEFFICIENTS: Final = 64


def is_jpeg(data: bytes) -> bool:
    """True of a JPEG file, by its start."""
    return data.startswith(_START)


def has_first_scan(data: bytes) -> bool:
    """True if a second scan of a progressive picture begins: the first one covers all of it."""
    kinds = [kind for kind, _ in _segments(data)]
    return kinds.count(_SCAN) > 1 and not _FRAMES.isdisjoint(kinds) and _is_progressive(kinds)


def has_all_scans(data: bytes) -> bool:
    """True if scans of all coefficients of all components begin, with all of their bits."""
    wanted: set[tuple[int, int]] = set()
    kinds = [kind for kind, _ in _segments(data)]
    n_coefficients = _N_COEFFICIENTS if _is_progressive(kinds) else 1
    for kind, content in _segments(data):
        if kind in _FRAMES and len(content) >= 6:
            components = content[6 : 6 + 3 * content[5] : 3]
            wanted = {(c, k) for c in components for k in range(n_coefficients)}
        elif kind == _SCAN and content:
            components = content[1 : 1 + 2 * content[0] : 2]
            first, last, bits = content[1 + 2 * content[0] :][:3].ljust(3, b"\0")
            if bits & 15 == 0:
                wanted -= {(c, k) for c in components for k in range(first, last + 1)}
    return not wanted


def _is_progressive(kinds: list[int]) -> bool:
    return any(kind in _PROGRESSIVE for kind in kinds)


def _segments(data: bytes) -> Iterator[tuple[int, bytes]]:
    """Markers with the contents of their segments; coded samples are passed over."""
    at = 2
    while True:
        at = data.find(b"\xff", at)
        if at < 0 or at + 1 >= len(data):
            return
        kind = data[at + 1]
        if kind in (0, 0xFF) or kind in _ALONE:
            at += 1 if kind == 0xFF else 2
            continue
        length = int.from_bytes(data[at + 2 : at + 4], "big")
        yield kind, data[at + 4 : at + 2 + length]
        at += 2 + max(2, length)
