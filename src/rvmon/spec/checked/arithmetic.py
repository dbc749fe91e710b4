"""The operations on numbers: one entry for each, which checker, core and oracle read.

The oracle has readings of its own, of which this is to be found right.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum, StrEnum, auto


class UnitRule(Enum):
    """What becomes of the units of the arguments."""

    SAME = auto()
    PRODUCT = auto()
    QUOTIENT = auto()
    ROOT = auto()


@dataclass(frozen=True, slots=True)
class Operation:
    """What is to be known of an operation.

    Attributes:
        least: so many arguments at least.
        most: so many at most; `None`: any number, folded from the left.
        unit: of the result.
        apply: yields the result, of exact fractions too; an error of arithmetic is unknown.
        whole: whether the result of whole numbers is one.
        doc: its value in a few words.
    """

    least: int
    most: int | None
    unit: UnitRule
    apply: Callable[..., float]
    whole: bool
    doc: str


class NumericOp(StrEnum):
    """The operations by their signs, or the names of functions.

    >>> NumericOp.of("hypot").entry.apply(3, 4)
    5.0
    """

    entry: Operation

    def __new__(cls, sign: str, entry: Operation) -> NumericOp:
        """A member: the text that it is written as, with its entry."""
        made = str.__new__(cls, sign)
        made._value_ = sign
        made.entry = entry
        return made

    @classmethod
    def of(cls, sign: str) -> NumericOp:
        """The one that is written so."""
        return next(one for one in cls if one.value == sign)

    ADD = "+", Operation(2, 2, UnitRule.SAME, operator.add, True, "the sum")
    SUB = "-", Operation(2, 2, UnitRule.SAME, operator.sub, True, "a difference")
    MUL = "*", Operation(2, 2, UnitRule.PRODUCT, operator.mul, True, "the product")
    DIV = "/", Operation(2, 2, UnitRule.QUOTIENT, operator.truediv, False, "the quotient")
    NEG = "neg", Operation(1, 1, UnitRule.SAME, operator.neg, True, "the opposite")
    ABS = "abs", Operation(1, 1, UnitRule.SAME, abs, True, "the magnitude")
    MIN = "min", Operation(2, None, UnitRule.SAME, min, True, "the least")
    MAX = "max", Operation(2, None, UnitRule.SAME, max, True, "the greatest")
    SQRT = "sqrt", Operation(1, 1, UnitRule.ROOT, math.sqrt, False, "the square root")
    HYPOT = (
        "hypot",
        Operation(2, 2, UnitRule.SAME, math.hypot, False, "the length of a vector of two sides"),
    )

    @property
    def is_function(self) -> bool:
        """Whether it is called by its name in a specification."""
        return self.isalpha() and self is not NumericOp.NEG
