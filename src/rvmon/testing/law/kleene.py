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
    return _first(values, (Truth.FALSE, Truth.UNKNOWN, Truth.UNBORN), Truth.TRUE)


def disjunction(values: Iterable[Truth]) -> Truth:
    """TRUE if any is, else UNKNOWN if any is, else UNBORN if any is; of nothing FALSE."""
    return _first(values, (Truth.TRUE, Truth.UNKNOWN, Truth.UNBORN), Truth.FALSE)


def _first(values: Iterable[Truth], order: Iterable[Truth], default: Truth) -> Truth:
    seen = set(values)
    for value in order:
        if value in seen:
            return value
    return default


def truth_of(value: bool) -> Truth:
    """TRUE or FALSE."""
    return Truth.TRUE if value else Truth.FALSE


def born_or_true(value: Truth) -> Truth:
    """TRUE in place of UNBORN."""
    return Truth.TRUE if value is Truth.UNBORN else value


def born_or_false(value: Truth) -> Truth:
    """FALSE in place of UNBORN."""
    return Truth.FALSE if value is Truth.UNBORN else value
