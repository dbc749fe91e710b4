"""One sentence about a decision, with places for what differs between decisions that are alike."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Any, assert_never

from rvmon.dataflow.flow import Flow
from rvmon.formula.state import State
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
class LastWith:
    """When a proposition had a truth for the last time.

    Attributes:
        proposition: of which.
        value: the truth.
    """

    proposition: State
    value: int


Sentence = tuple[str | Place | LastWith, ...]
"""Its parts in order."""


def told(sentence: Sentence, decided: int, start: int, flow: Flow) -> str:
    """A sentence about one decision.

    Args:
        sentence: about all that are like it.
        decided: its instant, ticks.
        start: the instant at which what decided was instantiated, ticks.
        flow: as it stood at the decision.
    """

    def part(one: str | Place | LastWith) -> str:
        match one:
            case str():
                return one
            case Place():
                return format_ticks(one.ticks(decided, start))
            case LastWith():
                seen = flow.last_with(flow.graph.index[one.proposition], one.value, decided)
                return "never" if seen is None else format_ticks(seen)
            case _:
                assert_never(one)

    return "".join(map(part, sentence))
