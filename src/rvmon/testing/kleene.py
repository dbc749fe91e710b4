"""Kleene's three truth values."""

from __future__ import annotations

from collections.abc import Iterable
from enum import IntEnum


class Truth(IntEnum):
    """Ordered, so that `and` is the least and `or` the greatest of its operands."""

    FALSE = 0
    UNKNOWN = 1
    TRUE = 2


_NEGATION = (Truth.TRUE, Truth.UNKNOWN, Truth.FALSE)


def negation(value: Truth) -> Truth:
    """TRUE and FALSE exchanged.

    >>> negation(Truth.UNKNOWN).name
    'UNKNOWN'
    """
    return _NEGATION[value]


def conjunction(values: Iterable[Truth]) -> Truth:
    """TRUE if all are, FALSE if any is; of nothing TRUE."""
    return min(values, default=Truth.TRUE)


def disjunction(values: Iterable[Truth]) -> Truth:
    """TRUE if any is, FALSE if all are; of nothing FALSE."""
    return max(values, default=Truth.FALSE)


def truth_of(value: bool) -> Truth:
    """TRUE or FALSE."""
    return Truth.TRUE if value else Truth.FALSE
