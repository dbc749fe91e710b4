"""Numbers at which comparisons turn: what to feed to see both sides of each."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import pairwise
from typing import assert_never

from rvmon.logic.formula import Factory, Sense
from rvmon.logic.state_formula import FALSE, TRUE, UNKNOWN, Leaf, operands
from rvmon.monitor.watching import Positions, known_truths
from rvmon.spec.checked.formula import (
    Arithmetic,
    Captured,
    Compare,
    FieldValue,
    Literal,
    NowValue,
    Numeric,
    SignalValue,
    UpdateValue,
)
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.trace.sample import Sample, Scalar, Value, calculated

Variable = SignalValue | FieldValue

LARGEST = 1e15
"""Roots beyond this are taken for artefacts of rounding."""


def turning_values(
    variable: Variable, comparisons: Iterable[Compare], *, whole: bool
) -> list[float]:
    """Values at, between and beside those at which a comparison turns, greatest first.

    Args:
        variable: a signal or field; in a comparison with others, they are taken to be 0.
        comparisons: all those that may read it.
        whole: whether its values are whole numbers.

    >>> from rvmon.spec.checked.formula import CompareOp
    >>> limit = Compare(CompareOp.LT, SignalValue("x"), Literal(0.5, "m"))
    >>> turning_values(SignalValue("x"), [limit], whole=False)
    [0.6, 0.5, 0.4]
    """
    roots = {
        root for leaf in comparisons if _reads(leaf, variable) for root in _roots(leaf, variable)
    }
    if whole:
        near = {round(root) for root in roots}
        return sorted({n + d for n in near for d in (-1, 0, 1)} or {0, 1}, reverse=True)
    ordered = sorted(roots)
    if not ordered:
        return [0.0, 1.0]
    between = [(low + high) / 2 for low, high in pairwise(ordered)]
    beside = [ordered[0] - _stride(ordered[0]), ordered[-1] + _stride(ordered[-1])]
    return sorted({_tidy(value) for value in (*ordered, *between, *beside)}, reverse=True)


def is_solved(comparison: Compare) -> bool:
    """Whether `turning_values` of its only variable surely shows all its truths."""
    match comparison:
        case Compare(left=SignalValue() | FieldValue(), right=Literal()):
            return True
        case Compare(left=Literal(), right=SignalValue() | FieldValue()):
            return True
        case _:
            return False


def _stride(value: float) -> float:
    """A step away from a value that people see: a tenth of it, or more."""
    return 1.0 if value == 0 else 10.0 ** math.floor(math.log10(abs(value)))


def _tidy(value: float) -> float:
    return float(f"{value:.12g}")


def _reads(leaf: Compare, variable: Variable) -> bool:
    return any(
        part == variable
        or (
            isinstance(part, UpdateValue)
            and isinstance(variable, SignalValue)
            and part.name == variable.name
        )
        for side in (leaf.left, leaf.right)
        for part in operands(side)
    )


def _roots(leaf: Compare, variable: Variable) -> Iterator[float]:
    """Where both sides are equal; exact where they are straight on each side of 0."""
    for first, second in ((1.0, 2.0), (-1.0, -2.0)):
        one, two = _difference(leaf, variable, first), _difference(leaf, variable, second)
        if one is None or two is None or one == two:
            continue
        root = first - one * (second - first) / (two - one)
        if math.isfinite(root) and abs(root) < LARGEST:
            yield _tidy(root)


def _difference(leaf: Compare, variable: Variable, value: float) -> float | None:
    left, right = (_with(side, variable, value) for side in (leaf.left, leaf.right))
    if isinstance(left, int | float) and isinstance(right, int | float):
        return float(left) - float(right)
    return None


def _with(numeric: Numeric, variable: Variable, value: float) -> Scalar:
    """An expression with the variable at a value, and all others at 0; `None`: there is none."""
    match numeric:
        case Literal(value=constant):
            return constant
        case SignalValue() | FieldValue() | Captured() | NowValue():
            return value if numeric == variable else 0.0
        case UpdateValue(name=name):
            same = isinstance(variable, SignalValue) and variable.name == name
            return value if same else 0.0
        case Arithmetic(op=op, args=args):
            return calculated(op.entry.apply, *(_with(arg, variable, value) for arg in args))
        case _:
            assert_never(numeric)


def truths_tried(
    spec: CheckedSpec, leaves: Sequence[Leaf], tried: Sequence[Mapping[str, Value]]
) -> list[tuple[int, ...]]:
    r"""The truths of leaves for each of some choices of values.

    Args:
        spec: declares what is read.
        leaves: of present values: signals, events and comparisons of these.
        tried: in each is all that the leaves read.

    Cost: one pass in C.

    >>> from rvmon import loads
    >>> from rvmon.spec.checked.formula import SignalAtom
    >>> spec = loads("signal p : bool\nrequirement R\n always p").checked
    >>> truths_tried(spec, [SignalAtom("p")], [{"p": True}, {"p": None}, {"p": False}])
    [(2,), (1,), (0,)]
    """
    if not leaves or not tried:
        return [()] * len(tried)
    factory = Factory()
    cores = [factory.literal(factory.leaf(leaf), Sense.TRUE) for leaf in leaves]
    # One position each: of the clock, of samples, or a tick.
    gap = spec.gap or 1
    samples = [Sample(place * gap, values) for place, values in enumerate(tried)]
    found = known_truths(spec, cores, samples, samples[-1].t, None, {})
    columns = [_column(one.true, one.false, len(tried)) for one in found]
    return list(zip(*columns, strict=True))


def _column(true: Positions, false: Positions, count: int) -> list[int]:
    """Truths by position."""
    column = [UNKNOWN] * count
    for truth, ranges in (TRUE, true), (FALSE, false):
        for first, last in ranges:
            for place in range(max(first, 0), min(last, count - 1) + 1):
                column[place] = truth
    return column
