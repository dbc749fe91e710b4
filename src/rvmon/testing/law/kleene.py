"""Kleene's three truth values, and the fourth of what is not there yet."""

from __future__ import annotations

from collections.abc import Iterable
from enum import IntEnum


class Truth(IntEnum):
    """The truth of a formula at a position."""

    FALSE = 0
    UNKNOWN = 1
    TRUE = 2
    UNBORN = 3
    """Of the present and past only: it speaks of signals that have had no value so far."""


_NEGATION = (Truth.TRUE, Truth.UNKNOWN, Truth.FALSE, Truth.UNBORN)
_FALSE_FIRST = (0, 1, 3, 2)
_TRUE_FIRST = (3, 1, 0, 2)
"""By truth, its place: of several, the first counts."""


def negation(value: Truth) -> Truth:
    """TRUE and FALSE exchanged.

    >>> negation(Truth.UNKNOWN).name
    'UNKNOWN'
    """
    return _NEGATION[value]


def conjunction(values: Iterable[Truth]) -> Truth:
    """FALSE if any is, else UNKNOWN if any is, else UNBORN if any is; of nothing TRUE.

    >>> conjunction([Truth.UNBORN, Truth.TRUE]).name
    'UNBORN'
    >>> conjunction([Truth.UNBORN, Truth.UNKNOWN]).name
    'UNKNOWN'
    """
    return min(values, key=_FALSE_FIRST.__getitem__, default=Truth.TRUE)


def disjunction(values: Iterable[Truth]) -> Truth:
    """TRUE if any is, else UNKNOWN if any is, else UNBORN if any is; of nothing FALSE."""
    return min(values, key=_TRUE_FIRST.__getitem__, default=Truth.FALSE)


def both(one: Truth, other: Truth) -> Truth:
    """The conjunction of two, as quickly as it goes."""
    return one if _FALSE_FIRST[one] <= _FALSE_FIRST[other] else other


def either(one: Truth, other: Truth) -> Truth:
    """The disjunction of two, as quickly as it goes."""
    return one if _TRUE_FIRST[one] <= _TRUE_FIRST[other] else other


def truth_of(value: bool) -> Truth:
    """TRUE or FALSE."""
    return Truth.TRUE if value else Truth.FALSE


def born_or_true(value: Truth) -> Truth:
    """TRUE in place of UNBORN."""
    return Truth.TRUE if value is Truth.UNBORN else value


def born_or_false(value: Truth) -> Truth:
    """FALSE in place of UNBORN."""
    return Truth.FALSE if value is Truth.UNBORN else value
