"""Finds the part of a requirement that decided an attempt, and puts its instants into words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple, assert_never

from msgspec import Struct

from rvmon.logic import formula
from rvmon.logic.alphabet import TruthValue, holds
from rvmon.logic.progress import Phase, after, instance, phase, step
from rvmon.logic.residual import FAILS, HOLDS, NO_CLOCK, Atom, Residual
from rvmon.logic.state_formula import FALSE, TRUE, State
from rvmon.trace.time import format_instant, format_ticks

AT_DECISION = -2
"""The `start` of an obligation that was instantiated at the decision; not a clock number."""


class Cause(Struct, frozen=True):
    """The cause of a decision."""

    # the obligation, or the literal if no operator lies above it
    node: formula.Literal | formula.Until | formula.Release
    # when the obligation was instantiated: for a network the instant in ticks; for an automaton the
    # number of the clock started then, `NO_CLOCK` for the trigger, or `AT_DECISION`
    start: int
    over: bool  # whether it was decided because its window closed
    literal: formula.Literal | None  # the proposition that decided it, if a single one did


class CauseFinder:
    """Finds the cause of a decision of an automaton.

    `valuation` holds the truth values at the decision as the deciding run reads them, `ages` the
    ages of its clocks then (ticks); `by_time`: time alone decided, without a letter.
    """

    def __init__(
        self,
        valuation: Mapping[State, TruthValue],
        ages: Sequence[int],
        *,
        verdict: bool,
        by_time: bool,
    ) -> None:
        self.valuation = valuation
        self.ages = ages
        self.verdict = verdict
        self.by_time = by_time
        self.wanted = HOLDS if verdict else FAILS

    def of(self, residual: Residual) -> Cause | None:
        """The cause of the decision of a residual; `None` if the residual is constant."""

        def decided(atom: Atom) -> bool:
            alone: Residual = frozenset([frozenset([atom])])
            left = after(alone, self.ages) if self.by_time else step(alone, self.ages, self._read)
            return left == self.wanted

        # A pass needs one clause to hold whole; a failure needs an atom of each clause to fail, and
        # the shortest clause names the fewest suspects.
        clauses = sorted(residual, key=len)
        if self.verdict:
            clauses = [c for c in clauses if all(decided(atom) for atom in c)]
        candidates = sorted(
            {atom for clause in clauses for atom in clause if decided(atom)},
            # The oldest clock first: the obligation that was open longest. Ids make the choice
            # deterministic.
            key=lambda atom: (atom[1], atom[0].id),
        )
        for node, clock in candidates:
            cause = self._of_atom(node, clock)
            if cause is not None:
                return cause
        return None

    def _read(self, literal: formula.Literal) -> Residual:
        return HOLDS if holds(literal.sense, self.valuation[literal.proposition]) else FAILS

    def _of_atom(
        self, node: formula.Literal | formula.Next | formula.Until | formula.Release, clock: int
    ) -> Cause | None:
        match node:
            case formula.Literal():
                return Cause(node, AT_DECISION, False, node)
            case formula.Next(operand=operand):
                return self._of_instance(operand)
            case formula.Until() | formula.Release():
                if clock > NO_CLOCK and phase(node, self.ages[clock]) is Phase.OVER:
                    return Cause(node, clock, True, None)
                # `U` passes and `R` fails by its right operand, at the position where that is
                # decided; the other decision comes from the left operand.
                ends_it = isinstance(node, formula.Until) is self.verdict
                part = node.right if ends_it else node.left
                if isinstance(part, formula.Literal):
                    return Cause(node, clock, False, part)
                return self._of_instance(part) or Cause(node, clock, False, None)
            case _:
                assert_never(node)

    def _of_instance(self, node: formula.Core) -> Cause | None:
        match node:
            case formula.Constant():
                return None
            case formula.And(args=args) | formula.Or(args=args):
                decided = [arg for arg in args if instance(arg, self._read) == self.wanted]
                # A temporal operand explains more than a literal next to it.
                decided.sort(key=lambda arg: isinstance(arg, formula.Literal))
                causes = (self._of_instance(arg) for arg in decided)
                return next((cause for cause in causes if cause is not None), None)
            case formula.Literal() | formula.Next() | formula.Until() | formula.Release():
                return self._of_atom(node, AT_DECISION)
            case formula.Since() | formula.Previous():
                raise AssertionError("a residual has no past operators")
            case _:
                assert_never(node)


class TruthValues(NamedTuple):
    """The truth values of a requirement's propositions at a position, with their history."""

    origin: int  # the first instant of the run, ticks
    gap: int | None  # ticks between two positions; `None` if only samples are positions
    # for an instance of `for each`, its first position; `None`: all positions count
    first: int | None
    truths: Sequence[int]  # of the propositions
    # the state of the propositions as the core noted it, with three instants per proposition: since
    # when it has its truth, when it was last FALSE, and when it was last TRUE; `NEVER` if not yet
    words: Sequence[int]
    # by proposition, the index of its truth in `truths`, and of its instants in `words`
    places: Mapping[State, tuple[int, int]]
    at_trigger: Mapping[str, int]  # by text of a leaf, its truth value at the trigger

    def since(self, proposition: State) -> int:
        """The position since which a proposition has had its truth value."""
        return self.words[self.places[proposition][1]]

    def last_with(self, proposition: State, value: int, t: int) -> int | None:
        """The last position up to `t`, the current one, at which a proposition had a value."""
        place, at = self.places[proposition]
        if self.truths[place] == value:
            return t
        before = self.words[at + (1 if value == FALSE else 2)]
        return None if before == NEVER else before


NEVER = -(1 << 63)  # the instant of what has not happened


class Moment(NamedTuple):
    """The instants of a decision (ticks) and the truth values then; its methods word them."""

    t: int  # the instant of the decision
    start: int  # the instant at which the deciding obligation was instantiated
    triggered: int
    flow: TruthValues

    def instant(self, t: int) -> str:
        """An instant as text."""
        return format_instant(t, self.flow.origin)

    @property
    def after_trigger(self) -> str:
        """The delay from trigger to decision, if the deciding obligation started at the trigger."""
        if self.start != self.triggered or self.start == self.t:
            return ""
        return f", {format_ticks(self.t - self.start)} after the trigger"

    def turned(self, proposition: State, text: str, seen: str) -> str:
        """The clause that a proposition `was` or `became` true or false at the decision.

        Its history alone does not tell: `whenever` may merge it with the trigger, and the merged
        proposition also changes with the trigger. So `became` is used only if the proposition had
        another value at the trigger.
        """
        since = self.flow.since(proposition)
        was_so = self.flow.at_trigger.get(text) == (TRUE if seen == "true" else FALSE)
        verb = "became" if self.start < since == self.t and not was_so else "was"
        long = f" (since {self.instant(since)})" if since < self.t else ""
        return f"{verb} {seen} at {self.instant(self.t)}{long}"

    def last_with(self, proposition: State, value: int, verb: str, *, lasting: bool) -> str:
        """The clause when a proposition last had a truth value.

        `verb` is `been true`, `been false` or `occurred`; `lasting`: whether the value can last
        longer than single instants.
        """
        last = self.flow.last_with(proposition, value, self.t)
        if last is None and self.flow.first is not None:
            return f"it had not {verb} since {self.instant(self.flow.first)}"
        if last is None:
            return f"it had never {verb} before"
        if last == self.t:
            return f"it came at {self.instant(last)}, too late"
        if self.flow.gap == 1 and lasting:
            return f"it had {verb} until {self.instant(last + 1)}"
        return f"it had last {verb} at {self.instant(last)}"


def without_cause(verdict: bool) -> str:
    """The reason for a decision that could not have been another."""
    return "there was no obligation" if verdict else "it can never hold"
