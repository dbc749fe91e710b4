"""Cover goals, coverpoints and crosses, as data."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from rvmon.diagnostics import Span
from rvmon.language.checked.ctl import Property
from rvmon.language.checked.formula import Formula


@dataclass(frozen=True, slots=True)
class Cover:
    """`cover ID = formula`: some run should show the formula at some instant.

    Attributes:
        id: of the goal.
        formula: true at the start of a run that shows the goal: `eventually` what is written.
        span: of the item.
        ctl: the property that is shown, for model checking; `None` for `cover ID = …`.
    """

    id: str
    formula: Formula
    span: Span | None = None
    ctl: Property | None = None


class BinKind(StrEnum):
    """The kinds of bins: the meaning of a hit."""

    GOAL = "goal"
    IGNORE = "ignore"
    ILLEGAL = "illegal"


@dataclass(frozen=True, slots=True)
class Bin:
    """A bin of a coverpoint: hit wherever its formula is true."""

    name: str
    formula: Formula
    kind: BinKind = BinKind.GOAL
    span: Span | None = None


@dataclass(frozen=True, slots=True)
class Coverpoint:
    """`coverpoint NAME = expression {bins}`.

    Attributes:
        name: of the coverpoint.
        bins: in order; they may overlap and need not be exhaustive.
        upon: the formula at which bins are sampled; `None`: every position.
        goal: hits that each bin needs.
        weight: in the total, beside other coverpoints and crosses; 0: for nothing.
        span: of the item.
    """

    name: str
    bins: tuple[Bin, ...]
    upon: Formula | None = None
    goal: int = 1
    weight: int = 1
    span: Span | None = None


@dataclass(frozen=True, slots=True)
class Cross:
    """`cross NAME = points`: the bins of several coverpoints at the same instant.

    Attributes:
        name: of the cross.
        points: names of its coverpoints.
        ignored: combinations (one bin name per point) that count for nothing.
        illegal: combinations that are an error.
        upon: where it is looked at: where its coverpoints are, unless it says so itself; `None`: at
            every position.
        goal: hits that each combination needs.
        weight: as of a coverpoint.
        span: of the item.
    """

    name: str
    points: tuple[str, ...]
    ignored: frozenset[tuple[str, ...]] = frozenset()
    illegal: frozenset[tuple[str, ...]] = frozenset()
    upon: Formula | None = None
    goal: int = 1
    weight: int = 1
    span: Span | None = None
