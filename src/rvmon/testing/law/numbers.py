"""Numeric expressions and comparisons at a position."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Mapping, Sequence
from itertools import product
from typing import Any, assert_never

from rvmon.language.checked import formula as rv
from rvmon.language.checked.arithmetic import NumericOp
from rvmon.testing.law import word
from rvmon.trace.sample import Payload, Scalar
from rvmon.trace.schema import Kind
from rvmon.trace.time import TICKS_PER_SECOND, TIME_LIMIT


def compare(
    comparison: rv.Compare, letter: word.Letter, captured: Mapping[str, Scalar]
) -> word.Truth:
    """The truth of a comparison; over fields of an event `e` it means `e and comparison`.

    Of several occurrences (or pairs of occurrences of two events), one has to satisfy it.

    Source: SEMANTICS, section 1 (Unknown, Birth).
    """
    events = events_of(comparison.left, comparison.right)
    choices = product(*(letter.events[event].occurrences for event in events))

    def holds(choice: Sequence[word.Occurrence]) -> word.Truth:
        payloads = {e: o.payload for e, o in zip(events, choice, strict=True)}
        return compare_at(comparison, letter, payloads, captured)

    return word.disjunction(
        word.conjunction([*(occurrence.truth for occurrence in choice), holds(choice)])
        for choice in choices
    )


def compare_at(
    comparison: rv.Compare,
    letter: word.Letter,
    payloads: Mapping[str, Payload],
    captured: Mapping[str, Scalar],
) -> word.Truth:
    """The truth of a comparison for one occurrence of each event that it reads."""
    if not is_born(comparison, letter):
        return word.Truth.UNBORN
    left = number(comparison.left, letter, payloads, captured)
    right = number(comparison.right, letter, payloads, captured)
    if left is None or right is None:
        return word.Truth.UNKNOWN
    return word.truth_of(_related(comparison.op, left, right))


def is_born(comparison: rv.Compare, letter: word.Letter) -> bool:
    """Whether all signals of a comparison have had the values or updates that it reads."""
    return all(
        letter.signals[part.name].moved
        if isinstance(part, rv.UpdateValue)
        else letter.signals[part.name].born
        for part in rv.numbers_in(comparison.left, comparison.right)
        if isinstance(part, rv.SignalValue | rv.UpdateValue)
    )


def known_scalar(value: Scalar) -> Scalar:
    """The value, or `None` for NaN."""
    return None if isinstance(value, float) and math.isnan(value) else value


def events_of(*expressions: rv.Numeric) -> list[str]:
    """The events whose fields the expressions read, in order of name."""
    return sorted({field.event for field in rv.fields_in(*expressions)})


def number(
    expression: rv.Numeric,
    letter: word.Letter,
    payloads: Mapping[str, Payload],
    captured: Mapping[str, Scalar],
) -> Scalar:
    """The value of an expression at a position; `None` if it is unknown.

    Source: SEMANTICS, sections 2 and 5; decision record 1 (Updates, Arithmetic).
    """
    match expression:
        case rv.Literal(value=value):
            return value
        case rv.SignalValue(name=name):
            return letter.signals[name].value
        case rv.FieldValue(event=event, field=field):
            return known_scalar(payloads.get(event, {}).get(field))
        case rv.NowValue():
            return None if letter.since is None else letter.instant - letter.since
        case rv.Captured(name=name):
            return captured[name]
        case rv.UpdateValue(function=function, name=name):
            return _of_updates(function, name, letter)
        case rv.Arithmetic(op=op, args=args):
            values = (number(arg, letter, payloads, captured) for arg in args)
            return _calculate(op, list(values))
        case rv.WindowValue():
            raise AssertionError("windows are evaluated by `Past`")
        case _:
            assert_never(expression)


def _of_updates(function: rv.UpdateFunction, name: str, letter: word.Letter) -> Scalar:
    state = letter.signals[name]
    last, before = state.last, state.before
    if state.value is None or last is None or before is None or before.value is None:
        return None
    if function is rv.UpdateFunction.PREV:
        return before.value
    delta = _calculate(NumericOp.SUB, [last.value, before.value])
    if function is rv.UpdateFunction.DELTA:
        return delta
    scaled = _calculate(NumericOp.MUL, [delta, float(TICKS_PER_SECOND)])
    return _calculate(NumericOp.DIV, [scaled, last.t - before.t])


_OF_REALS = frozenset(
    {
        *(NumericOp.DIV, NumericOp.SQRT, NumericOp.HYPOT, NumericOp.POW, NumericOp.ATAN2),
        *(NumericOp.SIN, NumericOp.COS, NumericOp.TAN, NumericOp.ASIN, NumericOp.ACOS),
        *(NumericOp.EXP, NumericOp.LOG, NumericOp.LOG10),
        *(NumericOp.ANGLE_BETWEEN, NumericOp.DISTANCE_ON_EARTH),
    }
)
_OF_BITS: dict[NumericOp, Callable[[int, int], int | None]] = {
    NumericOp.BIT_AND: int.__and__,
    NumericOp.BIT_OR: int.__or__,
    NumericOp.BIT_XOR: int.__xor__,
    NumericOp.SHIFT_LEFT: lambda x, by: x * 2**by if 0 <= by < 64 else None,
    NumericOp.SHIFT_RIGHT: lambda x, by: x // 2**by if 0 <= by < 64 else None,
    NumericOp.BIT: lambda x, by: x // 2**by % 2 if 0 <= by < 64 else None,
}


def _calculate(op: NumericOp, args: list[Scalar]) -> Scalar:
    """The value of an operation: an int64 if all arguments are whole numbers, else a binary64.

    Division, roots and lengths are operations on reals. Next to a real, a whole number is rounded
    to a binary64 first; so is the difference in a `rate`, which is per second.

    Source: SEMANTICS, section 5.
    """
    known = [arg for arg in args if arg is not None and not isinstance(arg, str)]
    if len(known) < len(args):
        return None
    whole = op not in _OF_REALS and all(isinstance(arg, int) for arg in known)
    try:
        result = _result(op, known if whole else [float(arg) for arg in known])
    except (ArithmeticError, ValueError):
        return None
    if result is None:
        return None
    if whole and isinstance(result, int):
        return at_edge(result, Kind.INT)
    return float(result) if math.isfinite(result) else None


def as_ticks(seconds: float) -> int:
    """Seconds in ticks, rounded as stamps of data are, and clamped to the bounds of time.

    >>> as_ticks(0.3), as_ticks(2)
    (300000000, 2000000000)
    """
    ticks = seconds * TICKS_PER_SECOND
    return round(max(-TIME_LIMIT, min(ticks, TIME_LIMIT)))


_WHOLE = range(-(2**63), 2**63)


def at_edge(value: Scalar, kind: Kind) -> Scalar:
    """A value as a signal or field of a kind holds it; `None` if it cannot.

    Source: SEMANTICS, section 5.

    >>> at_edge(2**53 + 1, Kind.REAL), at_edge(2**63, Kind.INT)
    (9007199254740992.0, None)
    """
    if kind is Kind.INT and isinstance(value, int):
        return value if value in _WHOLE else None
    if kind is Kind.REAL and isinstance(value, int):
        try:
            return float(value)
        except OverflowError:
            return None
    return value


def _result(op: NumericOp, args: list[int | float]) -> int | float | None:
    if op in _OF_BITS:
        whole = [arg for arg in args if isinstance(arg, int)]
        return _OF_BITS[op](whole[0], whole[1]) if len(whole) == len(args) else None
    if op in _OF_REALS:
        return _of_reals(op, *args)
    return _OF_NUMBERS[op](*args)


def _rounded(x: float) -> float:
    """The nearest whole number, halves away from 0."""
    down = math.floor(abs(x))
    size = down + 1 if abs(x) - down >= 0.5 else down
    return -size if x < 0 else size


_OF_NUMBERS: dict[NumericOp, Callable[..., int | float]] = {
    NumericOp.ADD: operator.add, NumericOp.SUB: operator.sub, NumericOp.MUL: operator.mul,
    NumericOp.NEG: operator.neg, NumericOp.ABS: abs, NumericOp.MIN: min, NumericOp.MAX: max,
    NumericOp.FLOOR: math.floor, NumericOp.CEIL: math.ceil, NumericOp.ROUND: _rounded,
    NumericOp.SIGN: lambda x: (x > 0) - (x < 0), NumericOp.MOD: operator.mod,
    NumericOp.CLAMP: lambda x, low, high: min(max(x, low), high),
}  # fmt: skip


def _of_reals(op: NumericOp, x: float, y: float = 0.0, *more: float) -> float:
    match op:
        case NumericOp.DIV:
            return x / y
        case NumericOp.HYPOT:
            return math.hypot(x, y)
        case NumericOp.POW:
            return math.pow(x, y)
        case NumericOp.ATAN2:
            return math.atan2(x + 0.0, y + 0.0)  # `-0.0 + 0.0` is 0.0: zeros have no sign here
        case NumericOp.ANGLE_BETWEEN:
            between = math.remainder(y - x, more[0])
            return -between if between * 2 == -more[0] else between
        case NumericOp.DISTANCE_ON_EARTH:
            return _distance(x, y, *more)
        case _:
            found: float = getattr(math, op)(x)
            return found


def _distance(lat1: float, lon1: float, lat2: float, lon2: float) -> float:
    """The great-circle distance in metres, by the haversine formula; angles in radians."""
    north, east = math.sin((lat2 - lat1) / 2), math.sin((lon2 - lon1) / 2)
    share = north * north + math.cos(lat1) * math.cos(lat2) * (east * east)
    return 2 * 6371008.8 * math.asin(min(math.sqrt(share), 1.0))


_RELATIONS: dict[rv.CompareOp, Callable[[Any, Any], bool]] = {
    rv.CompareOp.EQ: operator.eq, rv.CompareOp.NE: operator.ne, rv.CompareOp.LT: operator.lt,
    rv.CompareOp.LE: operator.le, rv.CompareOp.GE: operator.ge, rv.CompareOp.GT: operator.gt,
}  # fmt: skip


def _related(op: rv.CompareOp, left: Scalar, right: Scalar) -> bool:
    if op not in (rv.CompareOp.EQ, rv.CompareOp.NE) and (
        isinstance(left, str) or isinstance(right, str)
    ):
        raise TypeError(f"`{left}` {op} `{right}`: labels have no order")
    return _RELATIONS[op](left, right)
