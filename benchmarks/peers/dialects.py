"""Formulas of the common fragment in each peer's own language.

A translation keeps the truth at every tick: what a peer reads otherwise than SEMANTICS 2 is put to
it in other words, and what it cannot say is refused. Bounds are in ticks, the peer's unit of time
is one tick; a proposition is a column of the trace (`spelling`), `true` a column that is always 1.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

from tests.tools.common_fragment import (
    EVER,
    UntranslatableError,
    both,
    either,
    to_core,
)

from rvmon.spec.checked.formula import (
    Binary,
    BinaryOp,
    BoundAtom,
    Compare,
    CompareOp,
    Constant,
    EventAtom,
    Formula,
    Interval,
    Literal,
    ProbeAtom,
    SignalAtom,
    SignalValue,
    Unary,
    UnaryOp,
)

ALWAYS_ONE = "one"
"""The column that is 1 at every row."""


@dataclass(frozen=True, slots=True)
class Dialect:
    """How a peer writes formulas.

    Attributes:
        name: of the peer and its time model.
        proposition: how a Boolean column is read.
        comparison: how a numeric column is compared with a number; `None`: it is not.
        connectives: templates of `not`, `and`, `or`.
        unary: by operator the template, with `{bound}` and `{0}`.
        binary: by operator the template, with `{bound}`, `{0}` and `{1}`.
        bound: how the interval is written; a high end of `None` only if `unbounded`.
        unbounded: whether intervals from above 0 to infinity can be written.
        ever: whether operators without an interval can be written.
        point: whether `[0, 0]` can be written.
        split: whether `U` and `S` from above 0 are to be expressed by those from 0 on.
        weakened: whether `U` and `S` from 0 on are written with the right operand or-ed to the
            left, as the peer wants the left one also at the instant of the right one.
    """

    name: str
    proposition: Callable[[str], str]
    comparison: Callable[[str, str, str], str] | None
    connectives: tuple[str, str, str]
    unary: Mapping[UnaryOp, str] = field(default_factory=dict)
    binary: Mapping[BinaryOp, str] = field(default_factory=dict)
    bound: Callable[[int, int | None], str] = lambda low, high: f"[{low}:{high}]"
    unbounded: bool = False
    ever: bool = True
    point: bool = True
    split: bool = False
    weakened: bool = False


def translate(formula: Formula, dialect: Dialect) -> str:
    """The formula as text of the dialect.

    Raises:
        UntranslatableError: the peer cannot say it.
    """
    return _say(to_core(formula), dialect)


def spelling(name: str) -> str:
    """The column of a proposition or number: no word of any peer's language begins like this."""
    return "v_" + name.replace(".", "_")


def _say(formula: Formula, dialect: Dialect) -> str:
    negation, conjunction, disjunction = dialect.connectives
    match formula:
        case Constant(value=value):
            one = dialect.proposition(spelling(ALWAYS_ONE))
            return one if value else negation.format(one)
        case SignalAtom(name=name) | EventAtom(name=name):
            return dialect.proposition(spelling(name))
        case BoundAtom(bound=bound):
            return dialect.proposition(spelling(bound.value))
        case Compare():
            return _comparison(formula, dialect)
        case ProbeAtom():
            raise UntranslatableError(f"{dialect.name} knows nothing of updates")
        case Unary(op=UnaryOp.NOT, operand=operand):
            return negation.format(_say(operand, dialect))
        case Binary(op=BinaryOp.AND, left=left, right=right):
            return conjunction.format(_say(left, dialect), _say(right, dialect))
        case Binary(op=BinaryOp.OR, left=left, right=right):
            return disjunction.format(_say(left, dialect), _say(right, dialect))
        case Unary():
            return _unary(formula, dialect)
        case Binary():
            return _binary(formula, dialect)


def _comparison(formula: Compare, dialect: Dialect) -> str:
    match formula:
        case Compare(left=SignalValue(name=name), right=Literal(value=int() | float() as value)):
            if dialect.comparison is None:
                raise UntranslatableError(f"{dialect.name} knows no numbers")
            if formula.op in (CompareOp.EQ, CompareOp.NE):
                raise UntranslatableError("equality has no robustness above 0")
            return dialect.comparison(spelling(name), formula.op.value, f"{value}")
        case _:
            raise UntranslatableError(f"{dialect.name} compares a signal with a number only")


def _unary(formula: Unary, dialect: Dialect) -> str:
    op, operand = formula.op, formula.operand
    template = dialect.unary.get(op)
    if template is None:
        raise UntranslatableError(f"{dialect.name} has no {op.name.lower()}")
    if op in (UnaryOp.NEXT, UnaryOp.PREVIOUS):
        return template.format(_say(operand, dialect), bound="")
    window = formula.interval or EVER
    if window == Interval(0, 0) and not dialect.point:
        return _say(operand, dialect)
    if _needs_split(window, dialect):
        now = Unary(op, Unary(op, operand, EVER), Interval(window.low, window.low))
        return _say(now, dialect)
    return template.format(_say(operand, dialect), bound=_bound(window, dialect))


def _binary(formula: Binary, dialect: Dialect) -> str:
    op, left, right = formula.op, formula.left, formula.right
    template = dialect.binary.get(op)
    if template is None:
        raise UntranslatableError(f"{dialect.name} has no {op.name.lower()}")
    window = formula.interval or EVER
    if window == Interval(0, 0) and not dialect.point:
        return _say(right, dialect)
    if window.low > 0 and (dialect.split or _needs_split(window, dialect)):
        return _say(_opened(formula, window), dialect)
    if dialect.weakened:
        # From 0 on, an earlier witness is in the window too: φ U ψ = (φ | ψ) U ψ.
        left = either(left, right)
    return template.format(_say(left, dialect), _say(right, dialect), bound=_bound(window, dialect))


def _opened(formula: Binary, window: Interval) -> Formula:
    """`φ U[a,b] ψ` as φ on the first a ticks, then `φ U[0,b-a] ψ`; the mirror image for S."""
    rest = Interval(0, None if window.high is None else window.high - window.low)
    at = Interval(window.low, window.low)
    before = Interval(0, window.low - 1)
    inner = Binary(formula.op, formula.left, formula.right, rest)
    if formula.op is BinaryOp.UNTIL:
        always, eventually = UnaryOp.ALWAYS, UnaryOp.EVENTUALLY
    else:
        always, eventually = UnaryOp.HISTORICALLY, UnaryOp.ONCE
    return both(Unary(always, formula.left, before), Unary(eventually, inner, at))


def _needs_split(window: Interval, dialect: Dialect) -> bool:
    return window.high is None and window.low > 0 and not dialect.unbounded


def _bound(window: Interval, dialect: Dialect) -> str:
    if window == EVER:
        if not dialect.ever:
            raise UntranslatableError(f"{dialect.name} wants bounded intervals")
        return ""
    return dialect.bound(window.low, window.high)


def _reelay_bound(low: int, high: int | None) -> str:
    return f"[{low}:{'' if high is None else high}]"


_REELAY_PAST = {
    UnaryOp.ONCE: "(once{bound}({0}))",
    UnaryOp.HISTORICALLY: "(historically{bound}({0}))",
}
_REELAY_WORDS = ("(not({0}))", "(({0}) and ({1}))", "(({0}) or ({1}))")
_REELAY_SINCE = {BinaryOp.SINCE: "(({0}) since{bound} ({1}))"}


def _record(name: str) -> str:
    return f"{{{name}}}"


def _record_half(name: str) -> str:
    return f"{{{name} > 0.5}}"


def _record_compare(name: str, op: str, value: str) -> str:
    return f"{{{name} {op} {value}}}"


def _half(name: str) -> str:
    return f"({name} > 0.5)"


def _plain_compare(name: str, op: str, value: str) -> str:
    return f"({name} {op} {value})"


REELAY_DISCRETE = Dialect(
    "reelay, discrete",
    _record,
    _record_compare,
    _REELAY_WORDS,
    {**_REELAY_PAST, UnaryOp.PREVIOUS: "(pre({0}))"},
    _REELAY_SINCE,
    _reelay_bound,
    unbounded=True,
    point=False,
)
REELAY_ROBUSTNESS = replace(
    REELAY_DISCRETE, name="reelay, discrete robustness", proposition=_record_half, split=True
)
REELAY_DENSE = Dialect(
    "reelay, dense",
    _record,
    _record_compare,
    _REELAY_WORDS,
    _REELAY_PAST,
    _REELAY_SINCE,
    _reelay_bound,
    unbounded=True,
    point=False,
    split=True,
    weakened=True,
)
REELAY_DENSE_ROBUSTNESS = replace(
    REELAY_DENSE, name="reelay, dense robustness", proposition=_record_half
)

_STL_UNARY = {
    UnaryOp.EVENTUALLY: "(eventually{bound}({0}))",
    UnaryOp.ALWAYS: "(always{bound}({0}))",
    UnaryOp.ONCE: "(once{bound}({0}))",
    UnaryOp.HISTORICALLY: "(historically{bound}({0}))",
}
_STL_BINARY = {
    BinaryOp.UNTIL: "(({0}) until{bound} ({1}))",
    BinaryOp.SINCE: "(({0}) since{bound} ({1}))",
}
_STL_WORDS = ("(not({0}))", "(({0}) and ({1}))", "(({0}) or ({1}))")

RTAMT_DISCRETE = Dialect(
    "rtamt, discrete",
    _half,
    _plain_compare,
    _STL_WORDS,
    {**_STL_UNARY, UnaryOp.NEXT: "(s_next({0}))", UnaryOp.PREVIOUS: "(s_prev({0}))"},
    _STL_BINARY,
)
RTAMT_DENSE = Dialect(
    "rtamt, dense",
    _half,
    _plain_compare,
    _STL_WORDS,
    _STL_UNARY,
    _STL_BINARY,
    split=True,
    weakened=True,
)

MSTLO = Dialect(
    "mstlo",
    _half,
    _plain_compare,
    ("(!({0}))", "(({0}) and ({1}))", "(({0}) or ({1}))"),
    {UnaryOp.EVENTUALLY: "(F{bound}({0}))", UnaryOp.ALWAYS: "(G{bound}({0}))"},
    {BinaryOp.UNTIL: "(({0}) U{bound} ({1}))"},
    lambda low, high: f"[{low}, {high}]",
    ever=False,
    split=True,
    weakened=True,
)

SENTIL = Dialect(
    "sentil",
    _half,
    _plain_compare,
    _STL_WORDS,
    {**_STL_UNARY, UnaryOp.NEXT: "(next({0}))"},
    _STL_BINARY,
    lambda low, high: f"[{low}, {'inf' if high is None else high}]",
    unbounded=True,
    split=True,
)
"""The instant of the right operand of an `until` is not the left one's, as in ours."""
