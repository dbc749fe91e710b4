"""CTL properties (SEMANTICS 4) as data."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from rvmon.diagnostics import Span
from rvmon.language.checked.formula import BinaryOp, Formula, Interval, UnaryOp


@dataclass(frozen=True, slots=True)
class StateAtom:
    """A formula about one instant, without path quantifiers, over the names of the spec."""

    formula: Formula
    span: Span | None = None


@dataclass(frozen=True, slots=True)
class ModelAtom:
    """A proposition that reads clocks or locations of a model; its text as written."""

    text: str
    span: Span | None = None


@dataclass(frozen=True, slots=True)
class StateNot:
    """The negation of a state formula with path quantifiers."""

    operand: StateFormula
    span: Span | None = None


@dataclass(frozen=True, slots=True)
class StateBinary:
    """A connective of state formulas, one of them at least with path quantifiers."""

    op: BinaryOp
    left: StateFormula
    right: StateFormula
    span: Span | None = None


@dataclass(frozen=True, slots=True)
class PathUnary:
    """On all (`universal`) or some paths: next, eventually, always.

    Attributes:
        universal: whether the quantifier is `A`.
        op: `NEXT`, `EVENTUALLY` or `ALWAYS`.
        operand: the formula that holds there.
        interval: of durations; `None` exactly for `NEXT`.
        span: its place in the text.
    """

    universal: bool
    op: UnaryOp
    operand: StateFormula
    interval: Interval | None = None
    span: Span | None = None


@dataclass(frozen=True, slots=True)
class PathBinary:
    """On all (`universal`) or some paths: `U`, `W`, `R` or `M` with an interval."""

    universal: bool
    op: BinaryOp
    left: StateFormula
    right: StateFormula
    interval: Interval
    span: Span | None = None


StateFormula = StateAtom | ModelAtom | StateNot | StateBinary | PathUnary | PathBinary


def state_formulas(formula: StateFormula) -> Iterator[StateFormula]:
    """The formula and all below it, from the outside in, left to right."""
    yield formula
    match formula:
        case StateNot(operand=operand) | PathUnary(operand=operand):
            yield from state_formulas(operand)
        case StateBinary(left=left, right=right) | PathBinary(left=left, right=right):
            yield from state_formulas(left)
            yield from state_formulas(right)


@dataclass(frozen=True, slots=True)
class Property:
    """A CTL property; `p --> q` is `AG (p -> AF q)`."""

    id: str
    text: str
    formula: StateFormula
    span: Span | None = None
