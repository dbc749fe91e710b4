"""One sentence about a decision, with places for what differs between decisions that are alike."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Any, assert_never

from rvmon.logic.state_formula import State
from rvmon.trace.time import format_ticks


class Base(Enum):
    """What an instant or a duration in a sentence is counted from."""

    DECISION = 0
    """The instant of the decision."""

    START = 1
    """The instant at which what decided was instantiated."""

    AGE = 2
    """A duration: the time from that to the decision."""


@dataclass(frozen=True, slots=True)
class Place:
    """An instant or a duration.

    Attributes:
        base: what it is counted from.
        plus: so many ticks later.
    """

    base: Base
    plus: int = 0

    def ticks(self, decided: Any, start: Any) -> Any:
        """What stands there.

        Args:
            decided: the instant of the decision, ticks; or an array of such instants.
            start: the instant at which what decided was instantiated; or as many.
        """
        match self.base:
            case Base.DECISION:
                return decided + self.plus
            case Base.START:
                return start + self.plus
            case Base.AGE:
                return decided - start + self.plus
            case _:
                assert_never(self.base)


@dataclass(frozen=True, slots=True)
class Turned:
    """What a proposition was at the decision, and whether it became so just then.

    Attributes:
        proposition: which.
        seen: `true` or `false`.
    """

    proposition: State
    seen: str


@dataclass(frozen=True, slots=True)
class AfterTrigger:
    """How long after the trigger the decision was, if what decided began there."""


@dataclass(frozen=True, slots=True)
class LastWith:
    """When a proposition had a truth for the last time.

    Attributes:
        proposition: of which.
        value: the truth.
        verb: `been true`, `been false` or `occurred`.
        lasting: whether it is more than a matter of single instants.
    """

    proposition: State
    value: int
    verb: str
    lasting: bool


@dataclass(frozen=True, slots=True)
class Standing:
    """How the propositions of a requirement stood at a position.

    Attributes:
        gap: ticks between two positions; `None` if only samples are positions.
        begun: the position from which on it saw what is its own; `None`: it saw all.
        values: by proposition, its truth.
        since: by proposition, the position from which on it has had that.
        before: by proposition and truth, the last position at which it had another one.
    """

    gap: int | None
    begun: int | None
    values: Mapping[State, int]
    since: Mapping[State, int]
    before: Mapping[tuple[State, int], int | None]

    def last_with(self, proposition: State, value: int, t: int) -> int | None:
        """The last position up to `t`, not before the present one, with a value."""
        is_now = self.values[proposition] == value
        return t if is_now else self.before[proposition, value]


Part = str | Place | Turned | AfterTrigger | LastWith

Sentence = tuple[Part, ...]
"""Its parts in order."""


def rendered(sentence: Sentence, decided: int, start: int, triggered: int, flow: Standing) -> str:
    """A sentence about one decision.

    Args:
        sentence: about all that are like it.
        decided: its instant, ticks.
        start: the instant at which what decided was instantiated, ticks.
        triggered: the instant of the trigger of the attempt, ticks.
        flow: as it stood at the decision.
    """

    def part(one: Part) -> str:
        match one:
            case str():
                return one
            case Place():
                return format_ticks(one.ticks(decided, start))
            case Turned(proposition=proposition, seen=seen):
                since = flow.since[proposition]
                verb = "became" if start < since == decided else "was"
                long = f" (since {format_ticks(since)})" if since < decided else ""
                return f"{verb} {seen} at {format_ticks(decided)}{long}"
            case AfterTrigger():
                if start != triggered or start == decided:
                    return ""
                return f", {format_ticks(decided - start)} after the trigger"
            case LastWith(proposition=proposition, value=value, verb=verb):
                last = flow.last_with(proposition, value, decided)
                if last is None and flow.begun is not None:
                    return f"it had not {verb} since {format_ticks(flow.begun)}"
                if last is None:
                    return f"it had never {verb} before"
                if last == decided:
                    return f"it came at {format_ticks(last)}, too late"
                if flow.gap == 1 and one.lasting:
                    return f"it had {verb} until {format_ticks(last + 1)}"
                return f"it had last {verb} at {format_ticks(last)}"
            case _:
                assert_never(one)

    return "".join(map(part, sentence))
