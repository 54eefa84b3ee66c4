"""Samples of any type -> grey, RGB or RGBA of 8 or 16 bits.

The rule: unsigned integers of up to 16 bits are what they are, with white at the largest that their
bits hold. Floats within 0 to 1 are too. All other samples (signed integers, those of 32 and 64
bits, and floats beyond) have no white that is known: from their lowest value to their highest they
are spread over 16 bits, and the user is told. Of samples that are no numbers, black is made; the
infinite take the value of the nearest end.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from vmesh.arrays import BoolArray, SampleArray, UInt16Array
from vmesh.color_lattice import rescale

_WHITE: Final = 65_535
_BLOCK: Final = 1 << 20  # samples that are converted at once

_Values = npt.NDArray[Any]


def from_unsigned(values: _Values, n_bits: int) -> SampleArray:
    """Unsigned samples of 1 to 16 bits: uint8 for up to 8, else uint16 spread over 16 bits."""
    if n_bits in (8, 16):
        return values.astype(np.uint8 if n_bits == 8 else np.uint16)
    if n_bits > 8:
        return rescale(np.minimum(values, (1 << n_bits) - 1).astype(np.uint16), n_bits, 16)
    largest = (1 << n_bits) - 1
    return ((values.astype(np.uint16) * 255 + largest // 2) // largest).astype(np.uint8)


def from_numbers(values: _Values) -> tuple[UInt16Array, tuple[str, ...]]:
    """Samples of any other type as 16 bits, with notes about what became of them.

    Parameters
    ----------
    values : ndarray
        Any shape, integers or floats.
    """
    is_float = values.dtype.kind == "f"
    low, high, n_odd = _extent(values)
    notes = []
    if n_odd:
        notes.append(f"{n_odd} of its samples are no numbers, or infinite: they are black or white")
    if is_float and low >= 0 and high <= 1:
        low, high = 0.0, 1.0
    else:
        kind = "floats beyond 0 to 1" if is_float else f"integers of type {values.dtype.name}"
        notes.insert(0, f"its samples are {kind}: from {low:g}, now black, to {high:g}, now white")
    spread = np.empty(values.shape, dtype=np.uint16)
    scale = _WHITE / (high - low) if high > low else 0.0
    flat, target = values.reshape(-1), spread.reshape(-1)
    for block in _blocks(values.size):
        numbers = flat[block].astype(np.float64)
        if is_float:
            numbers = np.nan_to_num(numbers, nan=low, posinf=high, neginf=low)
        target[block] = np.rint((numbers - low) * scale)
    return spread, tuple(notes)


def without_premultiplication(samples: SampleArray) -> SampleArray:
    """RGBA whose colours are no longer multiplied by alpha, shape (h, w, 4)."""
    white = np.iinfo(samples.dtype).max
    straight = samples.copy()
    for row in range(len(samples)):
        alpha = np.maximum(samples[row, :, 3:].astype(np.int64), 1)
        colors = samples[row, :, :3].astype(np.int64)
        straight[row, :, :3] = np.minimum((colors * white + alpha // 2) // alpha, white)
    return straight


def as_rgba(samples: SampleArray) -> SampleArray:
    """Grey with alpha, shape (h, w, 2), as RGBA."""
    return samples[:, :, [0, 0, 0, 1]]


def with_alpha(samples: SampleArray, is_visible: BoolArray) -> SampleArray:
    """Grey or RGB, shape (h, w) or (h, w, 3), as RGBA with an alpha of all or nothing."""
    if samples.ndim == 2:
        samples = samples[:, :, None]
    rgba = np.empty((*samples.shape[:2], 4), dtype=samples.dtype)
    rgba[:, :, :3] = samples[:, :, :3]
    rgba[:, :, 3] = np.where(is_visible, np.iinfo(samples.dtype).max, 0)
    return rgba


def with_key(samples: SampleArray, key: tuple[int, ...], n_bits: int) -> SampleArray:
    """Grey or RGB with alpha 0 where its colour is a key, of as many bits as the file has."""
    scaled = from_unsigned(np.array(key), n_bits)
    if samples.ndim == 2:
        return with_alpha(samples, samples != scaled[0])
    return with_alpha(samples, (samples[:, :, :3] != scaled).any(axis=2))


def _extent(values: _Values) -> tuple[float, float, int]:
    """The lowest and the highest finite value, and how many are not finite."""
    low, high, n_odd = np.inf, -np.inf, 0
    flat = values.reshape(-1)
    for block in _blocks(values.size):
        numbers = flat[block]
        if numbers.dtype.kind == "f":
            finite = numbers[np.isfinite(numbers)]
            n_odd += len(numbers) - len(finite)
            numbers = finite
        if len(numbers):
            low, high = min(low, float(numbers.min())), max(high, float(numbers.max()))
    return (low, high, n_odd) if low <= high else (0.0, 0.0, n_odd)


def _blocks(n: int) -> Iterator[slice]:
    return (slice(at, at + _BLOCK) for at in range(0, n, _BLOCK))
