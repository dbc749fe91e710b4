"""Formulas of LTL as automata whose runs are those that satisfy them.

Time is dense, so that there is no next instant: U and its dual are all. A state of the automaton
has what holds while it lasts, what must hold from the next state on, and which formulas `p U q` it
does not keep waiting.

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
class WayState:
    """A state of the automaton."""

    # conditions and bounds of clocks that hold together while it lasts
    label: tuple[ex.Expression, ...]
    starts: bool  # whether runs start in it
    sets: int  # the sets of acceptance that it belongs to, as bits
    arcs: tuple[int, ...]  # the states that can be next


@dataclass(frozen=True, slots=True)
class Ways:
    """A generalised Büchi automaton: a run is accepted if it meets each of the sets for ever."""

    states: tuple[WayState, ...]
    sets: int


def check_linear(formula: ex.Expression, span: Span | None) -> None:
    """Refuse what a run alone does not say."""
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


def ways_of(formula: ex.Expression, span: Span | None) -> Ways:
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
    # Not those of the formula alone: what frees `G` is the negation of its left side.
    promises = sorted({promise for key in pending for promise in key.waiting}, key=repr)
    if len(promises) > MOST_SETS:
        raise model_error("TA019", "the formula has too many operators", span)
    states = tuple(
        WayState(tuple(key.label), place < len(first), key.sets(promises), arcs[place])
        for place, key in enumerate(pending)
    )
    return Ways(states, len(promises))


@dataclass(frozen=True, slots=True)
class _Case:
    """A way to satisfy some formulas now."""

    label: tuple[ex.Expression, ...]
    following: frozenset[ex.Expression]
    waiting: frozenset[ex.Expression]

    def is_as_good_as(self, other: _Case) -> bool:
        """Whether all that the other one allows is allowed here."""
        return (
            set(self.label) <= set(other.label)
            and self.following <= other.following
            and self.waiting <= other.waiting
        )

    def sets(self, promises: Sequence[ex.Expression]) -> int:
        """The sets of acceptance, as bits: one for each formula `p U q` that does not wait."""
        return sum(1 << n for n, promise in enumerate(promises) if promise not in self.waiting)


class _Tableau:
    """The cases of formulas."""

    def __init__(self) -> None:
        self._covers: dict[frozenset[ex.Expression], list[_Case]] = {}

    def cover(self, formulas: frozenset[ex.Expression]) -> list[_Case]:
        """All ways to satisfy some formulas together, without those that others make needless."""
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
                # It must be met some day: a run that waits for ever is caught by the set of
                # acceptance for it.
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
