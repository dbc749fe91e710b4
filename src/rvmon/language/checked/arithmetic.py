"""The operations on numbers: one entry each, which the checker and the core read.

The oracle has its own, independent evaluation, against which these entries are tested.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from enum import Enum, StrEnum

from msgspec import Struct

EARTH = 6_371_008.8
"""The mean radius of the Earth, m.

Source: Moritz, Geodetic Reference System 1980, Journal of Geodesy 74, 2000.
"""
MOST_SHIFT = 63  # the most bits by which a whole number can be shifted


def nearest_whole(x: float) -> float:
    """The nearest whole number; a half is rounded away from 0.

    >>> [nearest_whole(x) for x in (0.5, -0.5, 2.5, 0.49999999999999994)]
    [1, -1, 3, 0]
    """
    whole = math.trunc(x)
    return whole + sign(x) if abs(x - whole) * 2 >= 1 else whole


def sign(x: float) -> int:
    """1, 0 or −1."""
    return (x > 0) - (x < 0)


def clamp(x: float, low: float, high: float) -> float:
    """The value limited to at least `low` and then to at most `high`, which wins if below `low`."""
    return min(max(x, low), high)


def angle_between(a: float, b: float, turn: float = math.tau) -> float:
    """The angle by which to turn from a to b, the shorter way; a half turn is positive.

    >>> angle_between(170.0, -170.0, 360.0), angle_between(0.0, -180.0, 360.0)
    (20.0, 180.0)
    """
    between = math.remainder(b - a, turn)
    return -between if 2 * between == -turn else between


def distance_on_earth(lat1: float, lon1: float, lat2: float, lon2: float) -> float:
    """The distance in m along the surface of a sphere of the Earth's size; angles in rad.

    Source: Sinnott, Virtues of the Haversine, Sky and Telescope 68, 1984.

    >>> round(distance_on_earth(0.0, 0.0, math.pi / 2, 0.0))
    10007557
    """
    across = math.sin((lat2 - lat1) / 2)
    along = math.sin((lon2 - lon1) / 2)
    share = across * across + math.cos(lat1) * math.cos(lat2) * (along * along)
    return 2 * EARTH * math.asin(min(1.0, math.sqrt(share)))


def shifted_left(x: float, by: float) -> int:
    """A whole number shifted left; raises `ValueError` unless `by` is 0 to `MOST_SHIFT`."""
    return int(x) << _shift(by)


def shifted_right(x: float, by: float) -> int:
    """A whole number shifted right, rounded down; errors as `shifted_left`."""
    return int(x) >> _shift(by)


def bit(x: float, n: float) -> int:
    """Bit n of a whole number in two's complement, where bit 0 is the lowest.

    Errors as `shifted_left`.
    """
    return int(x) >> _shift(n) & 1


def _shift(by: float) -> int:
    if not 0 <= by <= MOST_SHIFT:
        raise ValueError(by)
    return int(by)


class UnitRule(Enum):
    """The units that an operation takes, and the unit of its result."""

    SAME = "numbers of one unit; the same unit"
    PRODUCT = "any units; their product"
    QUOTIENT = "any units; their quotient"
    ROOT = "a unit that has a root; that root"
    POWER = "plain numbers, or any unit and a constant whole exponent; the power"
    SIGN = "any unit; a plain number"
    PLAIN = "plain numbers; a plain number"
    OF_ANGLE = "an angle; a plain number"
    TO_ANGLE = "a plain number; an angle"
    DIRECTION = "numbers of one unit; an angle"
    TURN = "angles; an angle"
    PLACES = "angles; a length"
    BITS = "numbers of type `int`"


class Exactness(StrEnum):
    """How exactly a result is computed."""

    EXACT = "exact"
    ROUNDED = "rounded once"
    LIBRARY = "as the C library rounds it"


class Operation(Struct, frozen=True):
    """The entry of an operation: arity, units, evaluation, documentation."""

    least: int  # the least number of arguments
    most: int | None  # the greatest number; `None`: any, folded from the left
    unit: UnitRule
    # computes the result, also of exact fractions; an arithmetic error means unknown
    apply: Callable[..., float]
    whole: bool  # whether the result is whole if all arguments are
    doc: str  # its value in a few words
    exactness: Exactness = Exactness.ROUNDED  # for real arguments


def _exact(
    least: int, most: int | None, unit: UnitRule, apply: Callable[..., float], doc: str
) -> Operation:
    """An entry whose result is never rounded."""
    return Operation(least, most, unit, apply, True, doc, Exactness.EXACT)


def _library(count: int, unit: UnitRule, apply: Callable[..., float], doc: str) -> Operation:
    return Operation(count, count, unit, apply, False, doc, Exactness.LIBRARY)


class NumericOp(StrEnum):
    """The operations, by sign or function name.

    >>> NumericOp.of("hypot").entry.apply(3, 4)
    5.0
    """

    entry: Operation

    def __new__(cls, sign: str, entry: Operation) -> NumericOp:
        """A member: its sign or name, with its entry."""
        member = str.__new__(cls, sign)
        member._value_ = sign
        member.entry = entry
        return member

    @classmethod
    def of(cls, sign: str) -> NumericOp:
        """The operation with a sign or name."""
        return next(op for op in cls if op.value == sign)

    ADD = "+", Operation(2, 2, UnitRule.SAME, operator.add, True, "the sum")
    SUB = "-", Operation(2, 2, UnitRule.SAME, operator.sub, True, "a difference")
    MUL = "*", Operation(2, 2, UnitRule.PRODUCT, operator.mul, True, "the product")
    DIV = "/", Operation(2, 2, UnitRule.QUOTIENT, operator.truediv, False, "the quotient")
    NEG = "neg", _exact(1, 1, UnitRule.SAME, operator.neg, "the opposite")
    ABS = "abs", _exact(1, 1, UnitRule.SAME, abs, "the magnitude")
    MIN = "min", _exact(2, None, UnitRule.SAME, min, "the least")
    MAX = "max", _exact(2, None, UnitRule.SAME, max, "the greatest")
    SQRT = "sqrt", Operation(1, 1, UnitRule.ROOT, math.sqrt, False, "the square root")
    HYPOT = "hypot", Operation(
        2, 2, UnitRule.SAME, math.hypot, False, "the length of the vector (x, y)",
    )  # fmt: skip
    FLOOR = "floor", _exact(
        1, 1, UnitRule.SAME, math.floor, "the greatest whole number not above x, in its unit",
    )  # fmt: skip
    CEIL = "ceil", _exact(
        1, 1, UnitRule.SAME, math.ceil, "the least whole number not below x, in its unit",
    )  # fmt: skip
    ROUND = "round", _exact(
        1, 1, UnitRule.SAME, nearest_whole, "the nearest whole number, halves away from 0",
    )  # fmt: skip
    SIGN = "sign", _exact(1, 1, UnitRule.SIGN, sign, "1, 0 or −1")
    MOD = "mod", Operation(
        2, 2, UnitRule.SAME, operator.mod, True, "the remainder of x / y, with the sign of y",
    )  # fmt: skip
    CLAMP = ("clamp", _exact(3, 3, UnitRule.SAME, clamp, "x, at least y, and then at most z"))
    SIN = "sin", _library(1, UnitRule.OF_ANGLE, math.sin, "the sine of an angle")
    COS = "cos", _library(1, UnitRule.OF_ANGLE, math.cos, "the cosine of an angle")
    TAN = "tan", _library(1, UnitRule.OF_ANGLE, math.tan, "the tangent of an angle")
    ASIN = "asin", _library(1, UnitRule.TO_ANGLE, math.asin, "the angle of a sine")
    ACOS = "acos", _library(1, UnitRule.TO_ANGLE, math.acos, "the angle of a cosine")
    ATAN2 = "atan2", _library(2, UnitRule.DIRECTION, math.atan2, "the direction of (y, x)")
    EXP = "exp", _library(1, UnitRule.PLAIN, math.exp, "e to the power of x")
    LOG = "log", _library(1, UnitRule.PLAIN, math.log, "the natural logarithm")
    LOG10 = "log10", _library(1, UnitRule.PLAIN, math.log10, "the decimal logarithm")
    POW = "pow", _library(2, UnitRule.POWER, math.pow, "x to the power of y")
    ANGLE_BETWEEN = "angle_between", Operation(
        2, 2, UnitRule.TURN, angle_between, False,
        "the turn from x to y, the shorter way: above −180°, up to 180°",
    )  # fmt: skip
    DISTANCE_ON_EARTH = "distance_on_earth", _library(
        4, UnitRule.PLACES, distance_on_earth,
        "the distance from (latitude, longitude) to (latitude, longitude), on a sphere",
    )  # fmt: skip
    BIT_AND = "bit_and", _exact(2, 2, UnitRule.BITS, operator.and_, "the bits set in both")
    BIT_OR = "bit_or", _exact(2, 2, UnitRule.BITS, operator.or_, "the bits set in at least one")
    BIT_XOR = "bit_xor", _exact(2, 2, UnitRule.BITS, operator.xor, "the bits set in exactly one")
    SHIFT_LEFT = "shift_left", _exact(
        2, 2, UnitRule.BITS, shifted_left, "x shifted left by y bits",
    )  # fmt: skip
    SHIFT_RIGHT = "shift_right", _exact(
        2, 2, UnitRule.BITS, shifted_right, "x shifted right by y bits",
    )  # fmt: skip
    BIT = ("bit", _exact(2, 2, UnitRule.BITS, bit, "bit y of x is set; the lowest is bit 0"))

    @property
    def is_function(self) -> bool:
        """Whether it is called by its name in a specification."""
        return self.isidentifier() and self is not NumericOp.NEG
