"""Many cells of text as numbers at once, exactly."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

_DIGITS = 15
"""So many digits and their power of ten are exact doubles: the quotient is rounded once."""

_MOST = 19
"""So many digits fit in 64 bits without a sign: what 63 do not hold comes out negative."""

_POINT = np.uint8((ord(".") - ord("0")) % 256)

PLACES = {"s": 9, "ms": 6, "us": 3}
"""So many digits behind the point are whole ticks."""

_POWERS = 10.0 ** np.arange(_DIGITS + 1)


@dataclass(frozen=True, slots=True)
class Cells:
    """Cells of a text.

    Attributes:
        text: uint8[…], all of it.
        starts: int64[n], where each cell begins.
        ends: int64[n], behind its last character.
    """

    text: NDArray[np.uint8]
    starts: NDArray[np.int64]
    ends: NDArray[np.int64]


def whole_numbers(cells: Cells) -> NDArray[np.int64] | None:
    """The cells as integers; `None` if one is none, or is beyond 64 bits.

    >>> text = np.frombuffer(b"12,-7", np.uint8)
    >>> whole_numbers(Cells(text, np.array([0, 3]), np.array([2, 5]))).tolist()
    [12, -7]
    """
    read = _mantissas(cells, _MOST, _without_points)
    return None if read is None else read[0]


def decimals(cells: Cells) -> NDArray[np.float64] | None:
    """The cells as doubles; `None` if one is no plain decimal of at most 15 digits.

    >>> text = np.frombuffer(b"0.5,-12", np.uint8)
    >>> decimals(Cells(text, np.array([0, 4]), np.array([3, 7]))).tolist()
    [0.5, -12.0]
    """
    read = _mantissas(cells, _DIGITS, _reader(cells))
    if read is None:
        return None
    mantissa, behind = read
    made: NDArray[np.float64] = mantissa / _POWERS[behind]
    # An integer has no negative zero.
    minus = cells.text[cells.starts] == ord("-")
    return np.where(minus & (mantissa == 0), -0.0, made)


def instants(cells: Cells, unit: str) -> NDArray[np.int64] | None:
    """Cells of stamps as ticks; `None` if one is no plain number, or no whole number of ticks.

    Args:
        cells: decimal numbers, of `ns` whole ones.
        unit: `s`, `ms`, `us` or `ns`; of others, `None` is returned.

    >>> text = np.frombuffer(b"0.5,12", np.uint8)
    >>> instants(Cells(text, np.array([0, 4]), np.array([3, 6])), "s").tolist()
    [500000000, 12000000000]
    """
    if unit == "ns":
        return whole_numbers(cells)
    places = PLACES.get(unit)
    read = None if places is None else _mantissas(cells, _MOST, _reader(cells))
    if read is None or places is None:
        return None
    mantissa, behind = read
    if (behind > places).any():
        return None
    factor = 10 ** (places - behind)
    if (np.abs(mantissa) > (1 << 62) // factor).any():
        return None
    ticks: NDArray[np.int64] = mantissa * factor
    return ticks


def truth_values(cells: Cells) -> NDArray[np.bool_] | None:
    """The cells as truth values; `None` if one is neither 0 nor 1."""
    first = cells.text[cells.starts]
    if ((cells.ends - cells.starts) != 1).any() or ((first | 1) != ord("1")).any():
        return None
    ones: NDArray[np.bool_] = first == ord("1")
    return ones


def _mantissas(
    cells: Cells, most: int, reader: _Reader
) -> tuple[NDArray[np.int64], NDArray[Any]] | None:
    """The digits of each cell as an integer, and how many stand behind the point."""
    text, starts = cells.text, cells.starts
    first = text.take(starts)
    signed = (first == ord("-")) | (first == ord("+"))
    begins = starts + signed
    lengths = cells.ends - begins
    if not len(lengths) or lengths.min() < 1 or lengths.max() > most + 1:
        return None
    read = reader(cells, begins, lengths)
    if read is None:
        return None
    mantissa, behind, digits = read
    if digits.max() > most or mantissa.min() < 0:
        return None
    return np.where(first == ord("-"), -mantissa, mantissa), behind


_Read = tuple["NDArray[np.int64]", "NDArray[Any]", "NDArray[np.int64]"]
"""Mantissa, digits behind the point, digits."""

_Reader = Callable[[Cells, "NDArray[np.int64]", "NDArray[np.int64]"], _Read | None]
"""Reads cells, their signs left out; takes where they begin and how long they are."""


def _reader(cells: Cells) -> _Reader:
    return _with_points if (cells.text == ord(".")).any() else _without_points


def _without_points(
    cells: Cells, begins: NDArray[np.int64], lengths: NDArray[np.int64]
) -> _Read | None:
    if lengths.max() > _MOST:
        return None
    mantissa = np.zeros(len(begins), np.int64)
    shortest = int(lengths.min())
    for place in range(int(lengths.max())):
        at = cells.ends - (place + 1)
        digit = cells.text.take(at) - np.uint8(ord("0"))
        if place >= shortest:
            digit[at < begins] = 0
        if digit.max() > 9:
            return None
        mantissa += digit * np.int64(10**place)
    return mantissa, np.zeros(len(begins), np.int64), lengths


def _with_points(
    cells: Cells, begins: NDArray[np.int64], lengths: NDArray[np.int64]
) -> _Read | None:
    mantissa = np.zeros(len(begins), np.int64)
    behind = np.zeros(len(begins), np.int64)
    pointed = np.zeros(len(begins), bool)
    power = np.ones(len(begins), np.int64)
    for place in range(int(lengths.max())):
        at = cells.ends - (place + 1)
        digit = cells.text.take(at) - np.uint8(ord("0"))
        digit[at < begins] = 0
        point = digit == _POINT
        if (point & (pointed | (lengths == 1))).any():
            return None
        behind[point] = place
        pointed |= point
        digit[point] = 0
        if digit.max() > 9:
            return None
        mantissa += digit * power
        power *= np.where(point, 1, 10)
    return mantissa, behind, lengths - pointed
