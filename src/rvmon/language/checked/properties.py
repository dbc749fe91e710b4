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
    """A proposition that reads clocks or locations of a model; its text as written."""

    text: str
    span: Span | None = None


class StateNot(Struct, frozen=True):
    """The negation of a state formula with path quantifiers."""

    operand: StateFormula
    span: Span | None = None


class StateBinary(Struct, frozen=True):
    """A connective of state formulas, one of them at least with path quantifiers."""

    op: BinaryOp
    left: StateFormula
    right: StateFormula
    span: Span | None = None


class PathUnary(Struct, frozen=True):
    """On all (`universal`) or some paths: next, eventually, always."""

    universal: bool  # whether the quantifier is `A`
    op: UnaryOp  # `NEXT`, `EVENTUALLY` or `ALWAYS`
    operand: StateFormula  # the formula that holds there
    interval: Interval | None = None  # of durations; `None` exactly for `NEXT`
    span: Span | None = None  # its place in the text


class PathBinary(Struct, frozen=True):
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


class Property(Struct, frozen=True):
    """A CTL property; `p --> q` is `AG (p -> AF q)`."""

    id: str
    text: str
    formula: StateFormula
    span: Span | None = None


class Cover(Struct, frozen=True):
    """`cover ID = formula`: some run should show the formula at some instant."""

    id: str  # of the goal
    formula: Formula  # true at the start of a run that shows the goal: `eventually` what is written
    span: Span | None = None
    # the property that is shown, for model checking; `None` for `cover ID = …`
    ctl: Property | None = None


class BinKind(StrEnum):
    """The kinds of bins: the meaning of a hit."""

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
    weight: int = 1  # in the total, relative to other coverpoints and crosses; 0: for nothing
    span: Span | None = None


class Cross(Struct, frozen=True):
    """`cross NAME = points`: the bins of several coverpoints at the same instant."""

    name: str
    points: tuple[str, ...]  # names of its coverpoints
    # combinations (one bin name per point) that count for nothing
    ignored: frozenset[tuple[str, ...]] = frozenset()
    illegal: frozenset[tuple[str, ...]] = frozenset()  # combinations that are an error
    # the formula at which it is sampled: its own, else that of its coverpoints; `None`: every
    # position
    upon: Formula | None = None
    goal: int = 1  # hits that each combination needs
    weight: int = 1  # as of a coverpoint
    span: Span | None = None
