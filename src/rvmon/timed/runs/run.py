"""Runs of a network: symbolic, with the exact window of each wait, and with concrete times."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from fractions import Fraction
from math import prod

from rvmon.timed.model.network import Edge
from rvmon.timed.runs.constraints import Timing


@dataclass(frozen=True, slots=True)
class Window:
    """A range of durations in units of the model; `high` is `None` if it has no end."""

    low: int
    high: int | None
    low_strict: bool = False
    high_strict: bool = False

    def __contains__(self, duration: Fraction | int) -> bool:
        above = duration > self.low if self.low_strict else duration >= self.low
        if self.high is None:
            return above
        return above and (duration < self.high if self.high_strict else duration <= self.high)


@dataclass(frozen=True, slots=True)
class Action:
    """Edges that are taken together, each with the index of its automaton, the sender first."""

    edges: tuple[tuple[int, Edge], ...]

    @property
    def weight(self) -> float:
        """The product of the edges' weights."""
        return prod(edge.weight for _, edge in self.edges)


@dataclass(frozen=True, slots=True)
class Position:
    """Where a run is between two actions: the location of each automaton, the variables."""

    locations: tuple[int, ...]
    values: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class RunStep:
    """A wait, and the action behind it.

    Attributes:
        window: how long the wait can last, over all runs along this path.
        delay: how long it lasts in the concrete run.
        action: what is done then; `None` at the end of a run, or where nothing is done but the
            query's formula changes its truth.
        position: where the run is after the action.
    """

    window: Window
    delay: Fraction
    action: Action | None
    position: Position


class Ending(StrEnum):
    """How a run ends."""

    REACHED = "reached"
    """It shows what was sought."""

    DEADLOCK = "deadlock"
    """No edge can be taken any more; time can pass for ever."""

    TIME_LOCK = "time-lock"
    """No edge can be taken any more, and time stops."""

    IDLE = "idle"
    """It can stay where it is for ever."""

    LOOP = "loop"
    """It can go round for ever, and time passes without bound."""

    ZENO_LOOP = "zeno loop"
    """It can go round for ever, but time stops before a certain instant."""


@dataclass(frozen=True, slots=True)
class Run:
    """A path of the network and one way to run along it.

    Attributes:
        start: where it starts.
        steps: in order.
        ending: how it ends.
        loop: for loops the number of the first step that is repeated.
        timing: all timed runs along the path, if it is known.
    """

    start: Position
    steps: tuple[RunStep, ...]
    ending: Ending = Ending.REACHED
    loop: int | None = None
    timing: Timing | None = field(default=None, compare=False, repr=False)

    @property
    def duration(self) -> Fraction:
        """The sum of all delays of the concrete run."""
        return sum((step.delay for step in self.steps), Fraction(0))
