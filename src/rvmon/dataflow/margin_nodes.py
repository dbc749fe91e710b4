"""The nodes of a plan as they measure: each is told the values of its operands and tells its own.

What a node is told is a step function over the integers, as it becomes settled: a value that holds
from an integer on, and the integer up to which that is known. Where only samples are positions, a
step belongs to the position at which it begins, and each position has one of its own. A value is
told as soon as nothing that may still come can change it; what is kept is what is not settled.

Source: Lemire 2006 (the wedge); Donze, Ferrere and Maler 2013, Efficient robust monitoring for STL.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from bisect import bisect_left
from collections import deque
from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, field, replace
from enum import Enum
from typing import Protocol, Self

from rvmon.dataflow.margins import INFINITE
from rvmon.dataflow.nodes import Sweep
from rvmon.dataflow.piecewise import FAR


class Rest(Enum):
    """What is assumed of the part of an operator that lies behind the end of the trace."""

    LEAST = "least"
    GREATEST = "greatest"
    END = "end"
    """The rule for the end: the greatest for an unbounded `R` that has begun, else the least."""


@dataclass(slots=True)
class Horizon:
    """How much of a trace is known.

    Attributes:
        gap: ticks between two integers, 1 in sampled time.
        sparse: whether only samples are positions.
        first: the first position.
        now: the integer up to which all letters are known.
        reached: the instant that time has come to, ticks.
        asked: the positions whose value is wanted, ascending.
    """

    gap: int
    sparse: bool
    first: int
    now: int
    reached: int = -FAR
    asked: list[int] = field(default_factory=list)

    def copy(self) -> Horizon:
        """The same, independent from now on."""
        return replace(self, asked=list(self.asked))

    def asks(self, left: int, right: int) -> bool:
        """Whether the value of some integer from `left` to `right` is wanted."""
        index = bisect_left(self.asked, left)
        return index < len(self.asked) and self.asked[index] <= right


@dataclass(frozen=True, slots=True)
class End:
    """The end of a trace.

    Attributes:
        instant: the last one, ticks.
        last: the last integer that may be a position.
        rest: what is assumed of what lies behind.
    """

    instant: int
    last: int
    rest: Rest

    @property
    def pending(self) -> float:
        """The value of what lies behind, where it does not count as kept up."""
        return INFINITE if self.rest is Rest.GREATEST else -INFINITE

    def behind(self, node: Sweep) -> float:
        """The value of an `until` behind the end."""
        return INFINITE if self.rest is Rest.END and node.kept else self.pending


class Told(Protocol):
    """What is told the steps of one function, in order and without gaps."""

    def push(self, start: int, value: float, right: int) -> None:
        """Hear that another value holds from `start` on, known up to `right`."""

    def cover(self, right: int) -> None:
        """Hear that the value holds up to `right`."""


class Operator(ABC):
    """One node while a trace goes by.

    Attributes:
        out: is told its values.
        horizon: how much is known.
    """

    out: Told

    def __init__(self, horizon: Horizon) -> None:
        self.horizon = horizon

    @property
    @abstractmethod
    def inputs(self) -> Sequence[Told]:
        """What is to be told the values of its operands, in their order."""

    def copy(self, horizon: Horizon) -> Self:
        """The same, independent from now on, and telling nobody."""
        made = copy(self)
        made.horizon = horizon
        for name, value in vars(self).items():
            if isinstance(value, deque):
                setattr(made, name, value.copy())
        return made

    @abstractmethod
    def go(self) -> None:
        """Tell what is settled by now."""

    def end(self, end: End) -> None:  # noqa: B027 (what is told at once leaves nothing)
        """Tell what is left, all operands having told all up to the end."""
