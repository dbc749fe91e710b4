"""Translate formulas of the common fragment into each peer's language, using `dialects.toml`.

A translation keeps the truth at every tick. If a peer reads an operator differently from
SEMANTICS 2, another formula with the same meaning is used; what the peer cannot express is refused.
Bounds are in ticks, the peer's unit of time. A proposition is a column of the trace (`spelling`),
`true` a column that is always 1.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields
from pathlib import Path

from msgspec import structs
from tests.tools.common_fragment import EVER, UntranslatableError, both, either, to_core

from rvmon.language.checked import formula as rv

ALWAYS_ONE = "one"
"""The column that is 1 at every row."""


@dataclass(frozen=True, slots=True)
class Dialect:
    """The syntax of formulas of a peer."""

    name: str  # of the peer and its time model
    # the template of each operator: `{0}` and `{1}` for operands, `{bound}` for the window
    operators: Mapping[rv.UnaryOp | rv.BinaryOp, str]
    proposition: str = "({} > 0.5)"  # for a Boolean column
    # of a numeric column with a number; empty: not supported
    comparison: str = "({} {} {})"
    bound: str = "[{}:{}]"  # for a window
    # for a missing upper bound; `None`: only windows from 0 can be unbounded
    endless: str | None = None
    ever: bool = True  # whether operators without a window are supported
    point: bool = True  # whether `[0, 0]` is supported
    split: bool = False  # whether `U` and `S` from above 0 are expressed by those from 0
    # whether the right operand of `U` and `S` from 0 is or-ed to the left one, because the peer
    # requires the left one also at the instant of the right one
    weakened: bool = False


def translate(formula: rv.Formula, dialect: str) -> str:
    """The formula as text of a dialect of `dialects.toml`.

    Raises:
        UntranslatableError: the peer cannot express it.
    """
    return _say(to_core(formula), DIALECTS[dialect])


def spelling(name: str) -> str:
    """The column of a proposition or number; no keyword of any peer starts with this prefix."""
    return f"v_{name}"


def _say(formula: rv.Formula, dialect: Dialect) -> str:
    match formula:
        case rv.Constant(value=value):
            one = dialect.proposition.format(spelling(ALWAYS_ONE))
            return one if value else dialect.operators[rv.UnaryOp.NOT].format(one)
        case rv.SignalAtom(name=name) | rv.EventAtom(name=name):
            return dialect.proposition.format(spelling(name))
        case rv.BoundAtom(bound=bound):
            return dialect.proposition.format(spelling(bound.value))
        case rv.Compare(
            op=op, left=rv.SignalValue(name=name), right=rv.Literal(value=int() | float() as x)
        ):
            if not dialect.comparison:
                raise UntranslatableError(f"{dialect.name} knows no numbers")
            if op in (rv.CompareOp.EQ, rv.CompareOp.NE):
                raise UntranslatableError("equality has no robustness above 0")
            return dialect.comparison.format(spelling(name), op.value, x)
        case rv.Unary() | rv.Binary():
            return _operator(formula, dialect)
        case _:
            raise UntranslatableError(f"{dialect.name} compares signals with numbers only")


def _operator(formula: rv.Unary | rv.Binary, dialect: Dialect) -> str:
    template = dialect.operators.get(formula.op)
    if template is None:
        raise UntranslatableError(f"{dialect.name} has no {formula.op.name.lower()}")
    operands = [formula.operand] if isinstance(formula, rv.Unary) else [formula.left, formula.right]
    bound = ""
    if "{bound}" in template:
        window = formula.interval or EVER
        if window == rv.Interval(0, 0) and not dialect.point:
            return _say(operands[-1], dialect)
        is_endless = window.high is None and dialect.endless is None
        if window.low > 0 and (is_endless or (dialect.split and len(operands) == 2)):
            return _say(_opened(formula, window), dialect)
        if dialect.weakened and len(operands) == 2:
            # From 0 on, an earlier witness is in the window too: φ U ψ = (φ | ψ) U ψ.
            operands[0] = either(*operands)
        if window != EVER:
            high = dialect.endless if window.high is None else window.high
            bound = dialect.bound.format(window.low, high)
        elif not dialect.ever:
            raise UntranslatableError(f"{dialect.name} wants bounded intervals")
    return template.format(*(_say(one, dialect) for one in operands), bound=bound)


def _opened(formula: rv.Unary | rv.Binary, window: rv.Interval) -> rv.Formula:
    """A window that starts at a as one that starts at 0, shifted by a ticks.

    `φ U[a,b] ψ` is φ on the first a ticks, then `φ U[0,b-a] ψ`; `S` is the mirror image.
    """
    rest = rv.Interval(0, None if window.high is None else window.high - window.low)
    at, before = rv.Interval(window.low, window.low), rv.Interval(0, window.low - 1)
    inner = structs.replace(formula, interval=rest)
    if isinstance(formula, rv.Unary):
        return rv.Unary(formula.op, inner, at)
    if formula.op is rv.BinaryOp.UNTIL:
        always, eventually = rv.UnaryOp.ALWAYS, rv.UnaryOp.EVENTUALLY
    else:
        always, eventually = rv.UnaryOp.HISTORICALLY, rv.UnaryOp.ONCE
    return both(rv.Unary(always, formula.left, before), rv.Unary(eventually, inner, at))


def _dialects() -> Iterator[tuple[str, Dialect]]:
    """The dialects of `dialects.toml` by name."""
    tables = tomllib.loads(Path(__file__).with_suffix(".toml").read_text("utf-8"))
    own = {one.name for one in fields(Dialect)}
    for key, table in tables.items():
        table |= {**tables.get(table.get("like", ""), {}), **table}
        if "name" in table:
            words = ((op, op.name.lower()) for op in (*rv.UnaryOp, *rv.BinaryOp))
            operators = {op: table[word] for op, word in words if word in table}
            told = {name: one for name, one in table.items() if name in own}
            yield key, Dialect(operators=operators, **told)


DIALECTS = dict(_dialects())
