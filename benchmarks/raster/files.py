"""Files of one image by one encoder, and a search for the largest within a budget of bytes."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from PIL import Image

from vmesh.report.search import largest_within

_TRIES: Final = 6
_SLACK: Final = 0.002  # of the budget: a file that wastes no more is good enough


@dataclass(frozen=True, slots=True)
class File:
    """A file in memory, and the seconds that its encoding took."""

    data: bytes
    seconds: float


@dataclass(frozen=True, slots=True)
class Encoder:
    """One way of writing a codec's files, and how to find its largest file within a budget."""

    codec: str
    settings: str
    encode: Callable[[Image.Image, int], bytes]
    find: Callable[[Files, int], File | None]


class Files:
    """Files of one image by one encoder, each written once: numbers are levels or requests."""

    def __init__(self, encoder: Encoder, image: Image.Image) -> None:
        self.known: dict[int, File] = {}
        self._encoder = encoder
        self._image = image

    def at(self, number: int) -> File:
        """The file of a level or a request."""
        if number not in self.known:
            started = time.perf_counter()
            data = self._encoder.encode(self._image, number)
            self.known[number] = File(data, time.perf_counter() - started)
        return self.known[number]

    def largest_within(self, budget: int) -> File | None:
        """The largest file of at most `budget` bytes, None if there is none."""
        return self._encoder.find(self, budget)


def find_level(levels: range) -> Callable[[Files, int], File | None]:
    """A search for encoders whose files grow with a level, by about the same factor each."""

    def find(files: Files, budget: int) -> File | None:
        known = {level: _size(file) for level, file in files.known.items()}
        level = largest_within(budget, levels, lambda level: _size(files.at(level)), known)
        return None if level is None else files.at(level)

    return find


def find_request(files: Files, budget: int) -> File | None:
    """The largest file of an encoder that is asked for bytes and nearly meets the request."""
    fits = {request for request, file in files.known.items() if len(file.data) <= budget}
    best = max((files.known[request] for request in fits), key=_size, default=None)
    low = max(fits, default=0)
    high = min((request for request in files.known if request > low), default=2 * budget + 256)
    request = budget
    for _ in range(_TRIES):
        if best is not None and _size(best) >= budget * (1 - _SLACK):
            break
        if not low < request < high:
            request = (low + high) // 2
        if request in (0, low):
            break
        file = files.at(request)
        if _size(file) <= budget:
            low = request
            best = file if best is None else max(best, file, key=_size)
        else:
            high = request
        request += budget - _size(file)
    return best


def _size(file: File) -> int:
    return len(file.data)
