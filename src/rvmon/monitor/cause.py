"""Finds the part of a requirement that decided an attempt, and renders it as one sentence.

Decisions that differ only in instants share one sentence, a template with placeholders.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from enum import Enum
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

    # the obligation, or the literal if none lies above it
    node: formula.Literal | formula.Until | formula.Release
    # the instantiation of the obligation: for a network its instant in ticks; for an automaton the
    # number of the clock started then, `NO_CLOCK` for the trigger, or `AT_DECISION`
    start: int
    over: bool  # whether the decision is that its window closed
    literal: formula.Literal | None  # the proposition that decided it, if a single one did


class CauseFinder:
    """Finds the cause of a decision of an automaton.

    Truth values, as the deciding run reads them, and ages of clocks, ticks, are those at the
    decision; `by_time`: time alone decided, without a letter.
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
        """The cause of the decision of this residual; `None` if it is constant."""

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
            # The oldest clock first: the obligation that stood longest. Ids make the choice the
            # same in each run.
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


class Base(Enum):
    """The reference point of an instant or duration in a sentence."""

    DECISION = 0  # the instant of the decision
    START = 1  # the instant at which the deciding obligation was instantiated
    AGE = 2  # a duration: the time from `START` to `DECISION`


class Place(Struct, frozen=True):
    """A placeholder for an instant or a duration in a sentence: `plus` ticks after its base."""

    base: Base
    plus: int = 0

    def ticks(self, decided: int, start: int) -> int:
        """Its value, ticks; `start` is the instant at which the deciding obligation began."""
        match self.base:
            case Base.DECISION:
                return decided + self.plus
            case Base.START:
                return start + self.plus
            case Base.AGE:
                return decided - start + self.plus
            case _:
                assert_never(self.base)


class Turned(Struct, frozen=True):
    """A placeholder: whether a proposition `was` or `became` true or false at the decision.

    The history of the proposition is not enough: `whenever` may merge it with the trigger, and the
    merged proposition also changes with that. It did not become so if it was so at the trigger.
    """

    proposition: State
    text: str
    seen: str


class AfterTrigger(Struct, frozen=True):
    """A placeholder: the delay from trigger to decision, if the deciding obligation began there."""


class LastWith(Struct, frozen=True):
    """A placeholder: when a proposition last had a truth value, which may be `lasting`.

    Its verb is `been true`, `been false` or `occurred`.
    """

    proposition: State
    value: int
    verb: str
    lasting: bool


class TruthValues(NamedTuple):
    """The truth values of a requirement's propositions at a position, with their history."""

    origin: int  # the first instant of the run, ticks
    gap: int | None  # ticks between two positions; `None` if only samples are positions
    # for an instance of `for each`, its first position; `None`: all positions count
    begun: int | None
    truths: Sequence[int]  # of the propositions
    # of them, as the core noted them: of each since when it has this truth, and when it was last
    # another than FALSE, and than TRUE; `NEVER` if it was not
    words: Sequence[int]
    # by proposition the place of its truth, and of its words
    places: Mapping[State, tuple[int, int]]
    at_trigger: Mapping[str, int]  # by text of a leaf, its truth value at the trigger

    def since(self, proposition: State) -> int:
        """The position since which a proposition has had its truth value."""
        return self.words[self.places[proposition][1]]

    def last_with(self, proposition: State, value: int, t: int) -> int | None:
        """The last position up to `t`, the present one, at which it had a truth value."""
        place, at = self.places[proposition]
        if self.truths[place] == value:
            return t
        before = self.words[at + (1 if value == FALSE else 2)]
        return None if before == NEVER else before


NEVER = -(1 << 63)  # stands for an instant that there was not

Part = str | Place | Turned | AfterTrigger | LastWith

Sentence = tuple[Part, ...]  # a sentence template: text and placeholders in order


def rendered(
    sentence: Sentence, decided: int, start: int, triggered: int, flow: TruthValues
) -> str:
    """Fill in a sentence for one decision; instants are ticks, `start` that of its obligation."""
    return "".join(
        [
            part if type(part) is str else _filled(part, decided, start, triggered, flow)
            for part in sentence
        ]
    )


def _filled(part: Part, decided: int, start: int, triggered: int, flow: TruthValues) -> str:
    """A part of a sentence, for one decision; arguments as of `rendered`."""
    origin = flow.origin
    match part:
        case str():
            return part
        case Place(base=base):
            ticks = part.ticks(decided, start)
            return format_ticks(ticks if base is Base.AGE else ticks - origin)
        case Turned(proposition=proposition, seen=seen):
            since = flow.since(proposition)
            was_so = flow.at_trigger.get(part.text) == (TRUE if seen == "true" else FALSE)
            verb = "became" if start < since == decided and not was_so else "was"
            long = f" (since {format_instant(since, origin)})" if since < decided else ""
            return f"{verb} {seen} at {format_instant(decided, origin)}{long}"
        case AfterTrigger():
            if start != triggered or start == decided:
                return ""
            return f", {format_ticks(decided - start)} after the trigger"
        case LastWith(proposition=proposition, value=value, verb=verb):
            last = flow.last_with(proposition, value, decided)
            if last is None and flow.begun is not None:
                return f"it had not {verb} since {format_instant(flow.begun, origin)}"
            if last is None:
                return f"it had never {verb} before"
            if last == decided:
                return f"it came at {format_instant(last, origin)}, too late"
            if flow.gap == 1 and part.lasting:
                return f"it had {verb} until {format_instant(last + 1, origin)}"
            return f"it had last {verb} at {format_instant(last, origin)}"
        case _:
            assert_never(part)
