"""Durations and intervals in whole ticks."""

from __future__ import annotations

from fractions import Fraction

from rvmon.diagnostics.span import Span
from rvmon.spec.check.values import Quantity, Value
from rvmon.spec.checked.formula import Interval
from rvmon.spec.rules import time as rules
from rvmon.spec.rules.rule import Refusal
from rvmon.trace.time import TICKS_PER_SECOND, TIME_LIMIT

_SECOND = (("s", 1),)


def ticks_of(value: Value, span: Span) -> int:
    """A constant with a unit of time, exactly; 0 needs no unit.

    Raises:
        Refusal: it is no such constant, no whole number of ticks, negative, or too long.
    """
    if not isinstance(value, Quantity) or value.constant is None:
        raise Refusal(rules.no_duration(span))
    if value.unit.dimension != _SECOND and value.constant != 0:
        raise Refusal(rules.no_duration(span, plain=not value.unit.symbol))
    ticks: Fraction = value.constant * value.unit.factor * TICKS_PER_SECOND
    if ticks.denominator != 1:
        raise Refusal(rules.part_of_tick(span))
    if ticks < 0:
        raise Refusal(rules.negative(span))
    if ticks >= TIME_LIMIT:
        raise Refusal(rules.too_long(span))
    return int(ticks)


def closed_interval(
    low: int, high: int | None, *, low_open: bool, high_open: bool, span: Span
) -> Interval:
    """The closed interval of ticks with these ends.

    Raises:
        Refusal: no tick lies in it.

    >>> from rvmon.diagnostics.span import Source
    >>> closed_interval(2, 5, low_open=True, high_open=False, span=Span(Source("", ""), 0, 0))
    Interval(low=3, high=5)
    """
    first = low + low_open
    last = None if high is None else high - high_open
    if last is not None and last < first:
        raise Refusal(rules.empty(span))
    return Interval(first, last)
