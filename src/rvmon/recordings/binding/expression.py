"""Values in bindings: expressions of the language over the fields of a message."""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction
from functools import partial
from typing import Any

import numpy as np

from rvmon.diagnostics import Source
from rvmon.errors import RvmonError
from rvmon.language.checked.arithmetic import NumericOp
from rvmon.language.checked.functions import FUNCTIONS
from rvmon.language.checked.operators import BinaryOp, UnaryOp
from rvmon.language.syntax import expressions
from rvmon.language.syntax.parse import parse_expression
from rvmon.recordings.messages.fields import field_of
from rvmon.texts import did_you_mean
from rvmon.trace.schema import TURNS, Applied, Constant, Elements, Field, Term


def yaw(x: float, y: float, z: float, w: float) -> float:
    """The rotation about the vertical axis of a quaternion of length 1, in radians.

    >>> round(yaw(0, 0, 0.7071067811865476, 0.7071067811865476), 9)
    1.570796327
    """
    return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


def roll(x: float, y: float, z: float, w: float) -> float:
    """The rotation about the axis that points forwards, of a quaternion of length 1, in radians.

    >>> round(roll(0.7071067811865476, 0, 0, 0.7071067811865476), 9)
    1.570796327
    """
    return math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))


def pitch(x: float, y: float, z: float, w: float) -> float:
    """The rotation about the axis that points left, of a quaternion of length 1, in radians.

    It is positive with the nose down.

    >>> round(pitch(0, 0.25881904510252074, 0, 0.9659258262890683), 9)
    0.523598776
    """
    return math.asin(max(-1.0, min(1.0, 2 * (w * y - x * z))))


_TURNS = dict(zip(TURNS, (yaw, pitch, roll), strict=True))


def number(text: str | float) -> float | None:
    """The number that a text holds; `None` (unknown) if it holds none.

    >>> number("41.5"), number("n/a")
    (41.5, None)
    """
    try:
        return float(text)
    except ValueError:
        return None


def least(values: Iterable[float]) -> float | None:
    """The least of the numbers that are not NaN; `None` if there are none.

    >>> least([2.0, float("nan"), 1.5]), least([])
    (1.5, None)
    """
    return min(_known(values), default=None)


def greatest(values: Iterable[float]) -> float | None:
    """The greatest of the numbers that are not NaN; `None` if there are none."""
    return max(_known(values), default=None)


def _known(values: Iterable[float]) -> list[float]:
    listed = values.tolist() if isinstance(values, np.ndarray) else values
    return [value for value in listed if value == value]


def compared(
    values: Iterable[float], *, holds: Callable[[float, float], bool], limit: float, decisive: bool
) -> bool | None:
    """Whether a comparison holds for any element (`decisive=True`), or for all (`decisive=False`).

    Returns:
        `decisive` if one known element gives it; else `None` (unknown) if an
        element is NaN, and `not decisive` if none is.

    >>> [compared([2.0, 0.1], holds=operator.lt, limit=0.3, decisive=one) for one in (True, False)]
    [True, False]
    """
    known = _known(values)
    if any(holds(value, limit) == decisive for value in known):
        return decisive
    return (not decisive) if len(known) == len(list(values)) else None


CONNECTIVES: Mapping[BinaryOp, Callable[[float, float], bool]] = {
    BinaryOp.AND: lambda first, second: bool(first) and bool(second),
    BinaryOp.OR: lambda first, second: bool(first) or bool(second),
    BinaryOp.XOR: operator.ne,
}
"""The connectives that a value may use."""

_WORDS = frozenset({"and", "or", "xor", "not", "true", "false"})

# Names in backticks, and paths of fields; a name before a parenthesis is a function.
_PATH = re.compile(r"`[^`]*`|(?<![\w.])[^\W\d]\w*(?:\.[^\W\d]\w*|\[[^\[\]`]*\])*(?!\w*\()")

_OF_ARRAYS: Mapping[str, Callable[..., Any]] = {"min": least, "max": greatest}

_OF_ELEMENTS = {"any": True, "all": False}  # the result for one element that decides for all

_ROTATION = ("x", "y", "z", "w")


def term_of(text: str) -> Term:
    """Parse a value.

    Args:
        text: an expression without units and temporal operators. Names in it, also `ranges[0]`, are
            fields of the message. `yaw(q)`, `pitch(q)` and `roll(q)` are the rotations of a
            quaternion, `min(ranges)` and `max(ranges)` the extremes of an array, `any(ranges < 1)`
            and `all(ranges < 1)` compare its elements, `number(text)` reads a text.

    Raises:
        RvmonError: the text is no such expression.

    >>> term_of("twist.linear.x")
    Field(path=('twist', 'linear', 'x'))
    >>> term_of("ranges[0] - 1").args
    (Field(path=('ranges', 0)), Constant(value=1))
    """
    # Quote all names, as fields may be named like keywords of the language.
    quoted = _PATH.sub(
        lambda found: found[0] if found[0] in _WORDS or found[0][0] == "`" else f"`{found[0]}`",
        text,
    )
    expression, wrong = parse_expression(Source("value", quoted))
    if expression is None:
        first = wrong[0]
        raise RvmonError(f"{first.message}{f': {first.help}' if first.help else ''}")
    return _term(expression)


def _term(expression: expressions.Expression) -> Term:
    match expression:
        case expressions.Group(inner=inner):
            return _term(inner)
        case expressions.Truth(value=value):
            return Constant(value)
        case expressions.Number(value=value, unit=unit):
            return _number(value, unit)
        case expressions.Name(text=text):
            field = field_of(text)
            if field is None:
                raise RvmonError(f"`{text}` is not a field: write `pose.position.x`, `ranges[0]`")
            return field
        case expressions.Operation(op=op, args=args):
            return Applied(op.entry.apply, tuple(map(_term, args)), op.value)
        case expressions.Comparison(op=op, left=left, right=right):
            return Applied(op.holds, (_term(left), _term(right)), op.value)
        case expressions.Infix(op=op, left=left, right=right) if op in CONNECTIVES:
            return Applied(CONNECTIVES[op], (_term(left), _term(right)), op.value)
        case expressions.Prefix(op=UnaryOp.NOT, operand=operand):
            return Applied(operator.not_, (_term(operand),), "not")
        case expressions.Call(function=function, args=args):
            return _applied(function.text, args)
    raise RvmonError(
        f"`{expression.span.text}` refers to more than one message: put it into the specification"
    )


def _number(value: Fraction | None, unit: str) -> Constant:
    if unit:
        raise RvmonError(
            f"a number in a value has no unit (`{unit}`): give that of the result, as `unit`"
        )
    try:
        number = 0 if value is None else value
        return Constant(int(number) if number.denominator == 1 else float(number))
    except OverflowError:
        raise RvmonError("a number is too large") from None


def _applied(name: str, args: Sequence[expressions.Expression]) -> Term:
    terms = tuple(map(_term, args))
    if name in TURNS:
        if len(terms) != 1 or not isinstance(terms[0], Field):
            message = f"`{name}` takes a field that is a quaternion: `{name}(pose.orientation)`"
            raise RvmonError(message)
        quaternion = terms[0].path
        return Applied(_TURNS[name], tuple(Field((*quaternion, one)) for one in _ROTATION), name)
    if name == "number":
        if len(terms) != 1 or not isinstance(terms[0], Field):
            raise RvmonError("`number` takes a field that is a text: `number(values[Load].value)`")
        return Applied(number, terms, name)
    if name in _OF_ARRAYS and len(terms) == 1 and isinstance(terms[0], Field):
        return Applied(_OF_ARRAYS[name], (Elements(terms[0]),), name)
    if name in _OF_ELEMENTS:
        match args, terms:
            case (
                [expressions.Comparison(op=op)],
                [Applied(args=(Field() as array, Constant() as of))],
            ):
                decisive = _OF_ELEMENTS[name]
                holds = partial(compared, holds=op.holds, limit=of.value, decisive=decisive)
                return Applied(holds, (Elements(array),), name)
        raise RvmonError(f"`{name}` compares an array with a number: `{name}(ranges < 0.3)`")
    known = {op.value: op for op in NumericOp if op.is_function}
    if name not in known:
        names = [*known, "number", *_OF_ELEMENTS, *TURNS]
        meant = did_you_mean(name, names, f"there are {', '.join(names)}")
        raise RvmonError(f"no function `{name}` in a value: {meant}")
    wanted = len(FUNCTIONS[name].arguments)
    if len(terms) < wanted or (len(terms) > wanted and not FUNCTIONS[name].more):
        raise RvmonError(f"`{name}` takes {wanted} numbers, not {len(terms)}")
    return Applied(known[name].entry.apply, terms, name)
