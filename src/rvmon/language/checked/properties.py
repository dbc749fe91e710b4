"""CTL properties (SEMANTICS 4), cover goals, coverpoints and crosses, as data."""

from __future__ import annotations

from collections.abc import Iterator
from enum import StrEnum

from msgspec import Struct

from rvmon.diagnostics import Span
from rvmon.language.checked.formula import BinaryOp, Formula, Interval, UnaryOp


class StateAtom(Struct, frozen=True):
    """A formula about one instant, without path quantifiers, over the names of the spec."""

    formula: Formula
    span: Span | None = None


class ModelAtom(Struct, frozen=True):
    """A proposition that reads clocks or locations of a model, as its text."""

    text: str
    span: Span | None = None


class StateNot(Struct, frozen=True):
    """The negation of a state formula with path quantifiers."""

    operand: StateFormula
    span: Span | None = None


class StateBinary(Struct, frozen=True):
    """A connective of state formulas, at least one of which has path quantifiers."""

    op: BinaryOp
    left: StateFormula
    right: StateFormula
    span: Span | None = None


class PathUnary(Struct, frozen=True):
    """Next, eventually or always, on all (`universal`) or some paths."""

    universal: bool  # whether the quantifier is `A`
    op: UnaryOp  # `NEXT`, `EVENTUALLY` or `ALWAYS`
    operand: StateFormula
    interval: Interval | None = None  # `None` exactly for `NEXT`
    span: Span | None = None


class PathBinary(Struct, frozen=True):
    """`U`, `W`, `R` or `M` with an interval, on all (`universal`) or some paths."""

    universal: bool
    op: BinaryOp
    left: StateFormula
    right: StateFormula
    interval: Interval
    span: Span | None = None


StateFormula = StateAtom | ModelAtom | StateNot | StateBinary | PathUnary | PathBinary


def state_formulas(formula: StateFormula) -> Iterator[StateFormula]:
    """The formula and its subformulas, operators before operands, from left to right."""
    yield formula
    match formula:
        case StateNot(operand=operand) | PathUnary(operand=operand):
            yield from state_formulas(operand)
        case StateBinary(left=left, right=right) | PathBinary(left=left, right=right):
            yield from state_formulas(left)
            yield from state_formulas(right)


class Property(Struct, frozen=True):
    """A CTL property; `p --> q` is `AG (p -> AF q)`."""

    id: str
    text: str
    formula: StateFormula
    span: Span | None = None


class Cover(Struct, frozen=True):
    """A cover goal, `cover ID = formula`: some run should satisfy the formula at some instant."""

    id: str
    # true at the start of a run that reaches the goal: `eventually` applied to what is written
    formula: Formula
    span: Span | None = None
    # the property of `monitor as cover`, for model checking; `None` for `cover ID = …`
    ctl: Property | None = None


class BinKind(StrEnum):
    """The kinds of bins, which say what a hit means."""

    GOAL = "goal"
    IGNORE = "ignore"
    ILLEGAL = "illegal"


class Bin(Struct, frozen=True):
    """A bin of a coverpoint: hit wherever its formula is true."""

    name: str
    formula: Formula
    kind: BinKind = BinKind.GOAL
    span: Span | None = None


class Coverpoint(Struct, frozen=True):
    """`coverpoint NAME = expression {bins}`."""

    name: str
    bins: tuple[Bin, ...]  # in order; they may overlap and need not be exhaustive
    upon: Formula | None = None  # the formula at which bins are sampled; `None`: every position
    goal: int = 1  # hits that each bin needs
    weight: int = 1  # in the total, relative to other coverpoints and crosses; 0: does not count
    span: Span | None = None


class Cross(Struct, frozen=True):
    """`cross NAME = points`: the bins of several coverpoints at the same instant."""

    name: str
    points: tuple[str, ...]  # names of its coverpoints
    # combinations (one bin name per coverpoint) that are ignored
    ignored: frozenset[tuple[str, ...]] = frozenset()
    illegal: frozenset[tuple[str, ...]] = frozenset()  # combinations that are an error
    # the formula at which it is sampled, its own or else that of its coverpoints; `None`: every
    # position
    upon: Formula | None = None
    goal: int = 1  # hits that each combination needs
    weight: int = 1  # as in `Coverpoint`
    span: Span | None = None
