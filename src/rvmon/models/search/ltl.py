"""LTL formulas as generalised Büchi automata.

Time is dense and has no next instant, so U and its dual are the only temporal operators. A state of
the automaton determines the conditions that hold while it lasts, the formulas that must hold from
the next state on, and the formulas `p U q` that it does not keep waiting.

Source: Gerth, Peled, Vardi, Wolper, Simple On-the-fly Automatic Verification of Linear Temporal
Logic, 1995; Daniele, Giunchiglia, Vardi, Improved Automata Generation for LTL, 1999 (covers).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from rvmon.diagnostics import Span
from rvmon.models import model_error
from rvmon.models.network import expressions as ex
from rvmon.models.network.guards import is_discrete, normal_form, parts_of

MOST_STATES = 2_000
MOST_SETS = 28


@dataclass(frozen=True, slots=True)
class BuchiState:
    """A state of the automaton."""

    # conditions and clock bounds that all hold while the state lasts
    label: tuple[ex.Expression, ...]
    starts: bool  # whether runs may start in it
    sets: int  # the acceptance sets to which it belongs, as bits
    arcs: tuple[int, ...]  # the possible next states


@dataclass(frozen=True, slots=True)
class BuchiAutomaton:
    """A generalised Büchi automaton: it accepts a run that visits each set infinitely often."""

    states: tuple[BuchiState, ...]
    sets: int


def check_linear(formula: ex.Expression, span: Span | None) -> None:
    """Refuse operators of CTL, bounds and `deadlock` in an LTL formula."""
    for part in parts_of(formula):
        match part:
            case ex.PathFormula(ex.PathOp.FINALLY | ex.PathOp.GLOBALLY, _, None):
                pass
            case ex.PathFormula(ex.PathOp.FINALLY | ex.PathOp.GLOBALLY):
                fix = "bounds are decided in CTL, as in A[] (p imply A<>[<=5] q)"
                raise model_error("TA020", "a bound inside LTL is not decided", span, fix)
            case ex.PathFormula():
                fix = "ask for the parts one by one"
                what = "operators of CTL and of LTL in one formula"
                raise model_error("TA020", f"{what}: that is CTL*, and not decided", span, fix)
            case ex.Deadlock():
                fix = "ask for it with E<> or A[]"
                raise model_error("TA020", "one run does not show `deadlock`", span, fix)


def buchi_of(formula: ex.Expression, span: Span | None) -> BuchiAutomaton:
    """The automaton of a normalised formula; `span` is the place of its query."""
    tableau = _Tableau()
    first = tableau.cover(frozenset({formula}))
    number = {key: place for place, key in enumerate(first)}
    pending, arcs = list(first), list[tuple[int, ...]]()
    for key in pending:
        following = tableau.cover(key.following)
        for after in following:
            if after not in number:
                number[after] = len(pending)
                pending.append(after)
        if len(pending) > MOST_STATES:
            raise model_error("TA019", "the formula has too many cases", span, "split it")
        arcs.append(tuple(number[after] for after in following))
    # Collected from the states: the negated left side of a `G` is a promise not in the formula.
    promises = sorted({promise for key in pending for promise in key.waiting}, key=repr)
    if len(promises) > MOST_SETS:
        raise model_error("TA019", "the formula has too many operators", span)
    states = tuple(
        BuchiState(tuple(key.label), place < len(first), key.sets(promises), arcs[place])
        for place, key in enumerate(pending)
    )
    return BuchiAutomaton(states, len(promises))


@dataclass(frozen=True, slots=True)
class _Case:
    """One way to satisfy some formulas now: what holds now, what must follow, what is promised."""

    label: tuple[ex.Expression, ...]
    following: frozenset[ex.Expression]
    waiting: frozenset[ex.Expression]

    def is_as_good_as(self, other: _Case) -> bool:
        """Whether this case allows everything that the other one allows."""
        return (
            set(self.label) <= set(other.label)
            and self.following <= other.following
            and self.waiting <= other.waiting
        )

    def sets(self, promises: Sequence[ex.Expression]) -> int:
        """The acceptance sets as bits: one for each formula `p U q` that is not waiting."""
        return sum(1 << n for n, promise in enumerate(promises) if promise not in self.waiting)


class _Tableau:
    """The cases of sets of formulas, computed once for each set."""

    def __init__(self) -> None:
        self._covers: dict[frozenset[ex.Expression], list[_Case]] = {}

    def cover(self, formulas: frozenset[ex.Expression]) -> list[_Case]:
        """All ways to satisfy some formulas together, without those that another one covers."""
        known = self._covers.get(formulas)
        if known is None:
            known = []
            nothing = _Case((), frozenset(), frozenset())
            for case in self._cases(sorted(formulas, key=repr), nothing):
                if not any(other.is_as_good_as(case) for other in known):
                    known = [other for other in known if not case.is_as_good_as(other)]
                    known.append(case)
            self._covers[formulas] = known
        return known

    def _cases(self, todo: list[ex.Expression], case: _Case) -> Iterator[_Case]:
        if not todo:
            yield case
            return
        first, *rest = todo
        label, following, waiting = case.label, case.following, case.waiting
        match first:
            case ex.PathFormula(ex.PathOp.FINALLY, body, _, left):
                yield from self._cases([body, *rest], case)
                # The body must hold at some point. The acceptance set of this formula rules out
                # runs that wait forever.
                later = _Case(label, following | {first}, waiting | {first})
                yield from self._cases([left, *rest], later)
            case ex.PathFormula(ex.PathOp.GLOBALLY, body, _, left):
                freed = normal_form(left, positive=False)
                yield from self._cases([body, freed, *rest], case)
                later = _Case(label, following | {first}, waiting)
                yield from self._cases([body, *rest], later)
            case ex.BinaryOperation(ex.BinaryOp.AND, one, other) if not is_discrete(first):
                yield from self._cases([one, other, *rest], case)
            case ex.BinaryOperation(ex.BinaryOp.OR, one, other) if not is_discrete(first):
                yield from self._cases([one, *rest], case)
                yield from self._cases([other, *rest], case)
            case _ if first == ex.TRUE or first in label:
                yield from self._cases(rest, case)
            case _ if first in (ex.FALSE, _NOT_TRUE) or normal_form(first, positive=False) in label:
                return
            case _:
                yield from self._cases(rest, _Case((*label, first), following, waiting))


_NOT_TRUE = normal_form(ex.TRUE, positive=False)
