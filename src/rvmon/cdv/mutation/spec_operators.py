"""The mutation operators of requirements, on checked formulas: one table.

Sources, by the letters that the table cites:

* **BOY** Black, Okun, Yesha 2000, Mutation Operators for Specifications.
* **ALN** Aichernig, Lorber, Ničković 2013, Time for Mutants: Model-Based Mutation Testing with
  Timed Automata.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

from rvmon.spec.checked.formula import (
    Amount,
    Binary,
    BinaryOp,
    Compare,
    CompareOp,
    EventAtom,
    Formula,
    Interval,
    Literal,
    Numeric,
    ProbeAtom,
    SignalAtom,
    Unary,
    UnaryOp,
)
from rvmon.spec.print.printer import format_duration
from rvmon.trace.time import TICKS_PER_UNIT


@dataclass(frozen=True, slots=True)
class SpecOperator:
    """A kind of change of a formula.

    Attributes:
        name: in words.
        literature: what the literature calls it, and where; empty: it is ours.
        changes: of a formula, at its outermost operator.
    """

    name: str
    literature: str
    changes: Callable[[Formula], Iterator[Formula]]


_CONNECTIVES = {
    BinaryOp.AND: BinaryOp.OR,
    BinaryOp.OR: BinaryOp.AND,
    BinaryOp.IMPLIES: BinaryOp.AND,
}
_TEMPORAL = {
    UnaryOp.EVENTUALLY: UnaryOp.ALWAYS,
    UnaryOp.ALWAYS: UnaryOp.EVENTUALLY,
    UnaryOp.ONCE: UnaryOp.HISTORICALLY,
    UnaryOp.HISTORICALLY: UnaryOp.ONCE,
}
_BOUNDARIES = {
    CompareOp.LT: CompareOp.LE,
    CompareOp.LE: CompareOp.LT,
    CompareOp.GT: CompareOp.GE,
    CompareOp.GE: CompareOp.GT,
    CompareOp.EQ: CompareOp.NE,
    CompareOp.NE: CompareOp.EQ,
}


def _connective(formula: Formula) -> Iterator[Formula]:
    match formula:
        case Binary(op=op) if op in _CONNECTIVES:
            yield replace(formula, op=_CONNECTIVES[op])


def _dropped_operand(formula: Formula) -> Iterator[Formula]:
    match formula:
        case Binary(op=op, left=left, right=right) if op in _CONNECTIVES:
            yield left
            yield right


def _dropped_not(formula: Formula) -> Iterator[Formula]:
    match formula:
        case Unary(op=UnaryOp.NOT, operand=operand):
            yield operand


def _negated(formula: Formula) -> Iterator[Formula]:
    match formula:
        case SignalAtom() | EventAtom() | ProbeAtom():
            yield Unary(UnaryOp.NOT, formula)


def _comparison(formula: Formula) -> Iterator[Formula]:
    match formula:
        case Compare(op=op, right=Literal(value=bool() | str())) if op not in _EQUALITIES:
            return
        case Compare(op=op):
            yield replace(formula, op=_BOUNDARIES[op])


_EQUALITIES = (CompareOp.EQ, CompareOp.NE)


def _threshold(formula: Formula) -> Iterator[Formula]:
    match formula:
        case Compare(left=left, right=right):
            for other in _moved(right):
                yield replace(formula, right=other)
            for other in _moved(left):
                yield replace(formula, left=other)


def _moved(numeric: Numeric) -> Iterator[Numeric]:
    match numeric:
        case Literal(value=bool() | str()):
            return
        case Literal(value=int() as value):
            yield replace(numeric, value=value + 1)
            yield replace(numeric, value=value - 1)
        case Literal(value=float() as value):
            step = abs(value) / 10 or 0.1
            yield replace(numeric, value=float(f"{value + step:.12g}"))
            yield replace(numeric, value=float(f"{value - step:.12g}"))


def _temporal(formula: Formula) -> Iterator[Formula]:
    match formula:
        case Unary(op=op) if op in _TEMPORAL:
            yield replace(formula, op=_TEMPORAL[op])


def _bound(formula: Formula) -> Iterator[Formula]:
    """One unit more and less: of that in which the bound is a whole number."""
    match formula:
        case (
            Unary(interval=Interval(low=low, high=high))
            | Binary(interval=Interval(low=low, high=high))
        ):
            if high is not None:
                for other in (high + _unit(high), high - _unit(high)):
                    if other >= low:
                        yield replace(formula, interval=Interval(low, other))
            if low:
                for other in (low + _unit(low), low - _unit(low)):
                    if high is None or other <= high:
                        yield replace(formula, interval=Interval(other, high))


def _unit(ticks: int) -> int:
    return TICKS_PER_UNIT[format_duration(ticks).split()[1]]


def _no_deadline(formula: Formula) -> Iterator[Formula]:
    match formula:
        case Unary(op=op, interval=Interval(low=low, high=int())) if op in _TEMPORAL:
            yield replace(formula, interval=Interval(low))


SPEC_OPERATORS = (
    SpecOperator("connective", "LRO, logical operator reference (BOY)", _connective),
    SpecOperator("dropped operand", "MCO, missing condition (BOY)", _dropped_operand),
    SpecOperator("dropped not", "ENO, expression negation (BOY)", _dropped_not),
    SpecOperator("negated", "SNO, simple expression negation (BOY)", _negated),
    SpecOperator("comparison", "RRO, relational operator reference (BOY)", _comparison),
    SpecOperator("threshold", "", _threshold),
    SpecOperator("temporal operator", "", _temporal),
    SpecOperator("bound", "change of a guard's constant (ALN)", _bound),
    SpecOperator("no deadline", "guard dropped (ALN)", _no_deadline),
)
"""In the order in which they are applied."""


def changes(formula: Formula) -> Iterator[tuple[str, Formula]]:
    """All changes of a formula: the operator's name, and the whole formula with it.

    >>> from rvmon.spec.print.printer import format_formula
    >>> within = Unary(UnaryOp.EVENTUALLY, EventAtom("released"), Interval(0, 3 * 10**9))
    >>> [format_formula(changed) for name, changed in changes(within) if name == "bound"]
    ['within 4 s released', 'within 2 s released']
    """
    for operator in SPEC_OPERATORS:
        for changed in operator.changes(formula):
            yield operator.name, changed
    match formula:
        case Unary(operand=operand) | Amount(operand=operand):
            for name, changed in changes(operand):
                yield name, replace(formula, operand=changed)
        case Binary(left=left, right=right):
            for name, changed in changes(left):
                yield name, replace(formula, left=changed)
            for name, changed in changes(right):
                yield name, replace(formula, right=changed)
