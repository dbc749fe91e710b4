"""Numbers of the law, worked out by hand from SEMANTICS 5."""

from typing import Any

from tests.tools.build import compared, spec_of, x, y
from tests.tools.each import each

from rvmon.language.checked.arithmetic import NumericOp
from rvmon.language.checked.formula import Arithmetic, Literal, Numeric, UpdateFunction, UpdateValue
from rvmon.testing.law.numbers import compare, number
from rvmon.testing.law.sample_words import word_of
from rvmon.testing.law.word import Truth
from rvmon.trace.sample import Sample

MOST, LEAST = 2**63 - 1, -(2**63)
ODD = 2**53 + 1
"""The least whole number that binary64 does not hold."""


def of(op: str, *args: Numeric | float) -> Numeric:
    return Arithmetic(
        NumericOp.of(op), tuple(Literal(a) if isinstance(a, int | float) else a for a in args)
    )


def told(*values: dict[str, Any]) -> Any:
    samples = [Sample(t, one) for t, one in enumerate(values)]
    return word_of(spec_of(), samples).letters[-1]


def value(expression: Numeric, *values: dict[str, Any]) -> Any:
    return number(expression, told(*values), {}, {})


@each(
    ("expression", "expected"),
    [
        (of("+", MOST, 1), None),
        (of("*", 2**31, 2**31), 2**62),
        (of("neg", LEAST), None),
        # What leaves int64 on the way is unknown, though the whole would not.
        (of("-", of("+", MOST, 1), 1), None),
        # Beside a real, and in quotients, roots and lengths, whole numbers are rounded first.
        (of("+", ODD, 0.0), 2.0**53),
        (of("max", ODD, 0.0), 2.0**53),
        (of("max", ODD, 0), ODD),
        (of("/", 7, 2), 3.5),
        (of("/", 7, 0), None),
        (of("sqrt", -1), None),
        (of("*", 1e200, 1e200), None),
        (of("hypot", 3, 4), 5.0),
    ],
)
def test_arithmetic(expression: Numeric, expected: Any) -> None:
    """Whole numbers stay whole, exact and within int64; reals are binary64."""
    found = value(expression, {"x": 0})
    assert (type(found), found) == (type(expected), expected)


def test_values_are_rounded_at_the_edge() -> None:
    """A real signal holds binary64, a whole one int64 or nothing."""
    assert (type(value(x, {"x": ODD})), value(x, {"x": ODD})) == (float, 2.0**53)
    assert value(x, {"x": 10**400}) is None
    assert value(y, {"y": ODD}) == ODD
    assert value(y, {"y": MOST + 1}) is None


def test_comparisons_are_exact() -> None:
    """A whole number beside a real is not rounded."""
    letter = told({"x": 2.0**53, "y": ODD})
    for op, expected in ((">", Truth.FALSE), ("<", Truth.TRUE), ("==", Truth.FALSE)):
        assert compare(compared(x, op, y), letter, {}) is expected


def test_differences_and_rates() -> None:
    """A difference of whole numbers is whole, a rate is a real, of seconds."""
    told_twice = ({"y": 1}, {"y": 4})
    delta, rate = (UpdateValue(f, "y") for f in (UpdateFunction.DELTA, UpdateFunction.RATE))
    assert value(delta, *told_twice) == 3
    assert (type(value(rate, *told_twice)), value(rate, *told_twice)) == (float, 3e9)
    assert value(delta, {"y": LEAST}, {"y": MOST}) is None
    assert value(rate, {"y": LEAST}, {"y": MOST}) is None
