"""The nodes of a plan as they measure: each takes the steps of its operands and gives its own.

A step is given as soon as nothing that may still come can change it. What is kept is what is not
settled: the extremes of the windows that are open (a monotonic wedge, O(1) amortised for a step),
and of an `until` without bounds the stretches whose value depends on what follows.

Source: Lemire 2006 (the wedge); Donze, Ferrere and Maler 2013, Efficient robust monitoring for STL.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from bisect import bisect_left
from collections import deque
from collections.abc import Iterator, Sequence
from copy import copy
from dataclasses import dataclass, field
from enum import Enum
from typing import Self, assert_never

from rvmon.dataflow.nodes import Junction, Leaf, Node, Shift, Sweep, Window
from rvmon.dataflow.piecewise import FAR
from rvmon.dataflow.positions import Positions
from rvmon.dataflow.steps import INFINITE, Step, Steps, add, at_positions, negated, replaced, split


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
        positions: those that have come.
        now: the integer up to which all letters are known.
        reached: the instant that time has come to, ticks.
        asked: the positions whose value is wanted, ascending.
        end: the last instant of the trace; `None` while it goes on.
        rest: what is assumed of the rest, once it has ended.
    """

    positions: Positions
    now: int = -FAR - 1
    reached: int = -FAR - 1
    asked: list[int] = field(default_factory=list)
    end: int | None = None
    rest: Rest = Rest.LEAST

    @property
    def pending(self) -> float:
        """The value of what lies behind the end, where it does not count as kept up."""
        return INFINITE if self.rest is Rest.GREATEST else -INFINITE

    def asks(self, left: int, right: int) -> bool:
        """Whether the value of some integer from `left` to `right` is wanted."""
        index = bisect_left(self.asked, left)
        return index < len(self.asked) and self.asked[index] <= right


class Operator(ABC):
    """One node while a trace goes by."""

    @abstractmethod
    def take(self, operands: Sequence[Steps], horizon: Horizon) -> list[Step]:
        """Take what became settled of the operands; returns what that settles of the node."""

    @abstractmethod
    def copy(self) -> Self:
        """The same, independent from now on."""


def operator_of(node: Node, *, thin: bool) -> Operator | None:
    """The operator of a node; `None` for a leaf.

    Args:
        node: of a plan.
        thin: whether its value matters at the positions that are asked for alone.
    """
    match node:
        case Leaf():
            return None
        case Junction():
            return _Junction(node, thin)
        case Window():
            return _Window(node)
        case Shift():
            return _Shift(node)
        case Sweep(future=True):
            return _Until(node, thin)
        case Sweep():
            return _Since(node)
        case _:
            assert_never(node)


class _Aligned:
    """Functions that come in steps of their own, brought to common ones."""

    def __init__(self, count: int) -> None:
        self.queues: list[deque[Step]] = [deque() for _ in range(count)]

    def copy(self) -> _Aligned:
        made = _Aligned(0)
        made.queues = [deque(queue) for queue in self.queues]
        return made

    def enter(self, operands: Sequence[Steps]) -> None:
        for queue, steps in zip(self.queues, operands, strict=True):
            for step in steps:
                add(queue, *step)

    def enter_asked(self, operands: Sequence[Steps], horizon: Horizon) -> None:
        """Enter steps of which those that nobody asks for may have any value."""
        for queue, steps in zip(self.queues, operands, strict=True):
            for left, right, value in steps:
                own = value if not queue or horizon.asks(left, right) else queue[-1][2]
                add(queue, left, right, own)

    def ready(self) -> Iterator[tuple[int, int, list[float]]]:
        """The common steps that are complete, each with the values of all functions."""
        queues = self.queues
        while all(queues):
            right = min([queue[0][1] for queue in queues])
            yield queues[0][0][0], right, [queue[0][2] for queue in queues]
            for queue in queues:
                _, last, value = queue.popleft()
                if last > right:
                    queue.appendleft((right + 1, last, value))


class _Junction(Operator):
    """All of its operands, or one of them."""

    def __init__(self, node: Junction, thin: bool) -> None:
        self.choose = min if node.every else max
        self.thin = thin
        self.waiting = _Aligned(len(node.operands))

    def copy(self) -> Self:
        made = copy(self)
        made.waiting = self.waiting.copy()
        return made

    def take(self, operands: Sequence[Steps], horizon: Horizon) -> list[Step]:
        if self.thin:
            self.waiting.enter_asked(operands, horizon)
        else:
            self.waiting.enter(operands)
        made: list[Step] = []
        for left, right, values in self.waiting.ready():
            add(made, left, right, self.choose(values))
        return made


class _Window(Operator):
    """The extreme of the operand over a window, by a monotonic wedge.

    Attributes:
        wedge: the last integer whose window holds a value, and the value; the best one first.
        done: the first integer that is not worked out.
        held: what is worked out and must not be given yet.
    """

    def __init__(self, node: Window) -> None:
        self.node = node
        self.choose = min if node.every else max
        self.nothing = INFINITE if node.every else -INFINITE
        self.wedge: deque[tuple[int, float]] = deque()
        self.done = -FAR
        self.held: deque[Step] = deque()

    def copy(self) -> Self:
        made = copy(self)
        made.wedge = deque(self.wedge)
        made.held = deque(self.held)
        return made

    def take(self, operands: Sequence[Steps], horizon: Horizon) -> list[Step]:
        node = self.node
        if node.low > node.high:
            add(self.held, self.done, FAR, self.nothing)
            self.done = FAR + 1
        else:
            for step in at_positions(operands[0], horizon.positions, self.nothing):
                self._enter(*step)
        last = horizon.now
        if node.over is not None:
            last = (horizon.reached - node.over) // horizon.positions.gap
        if horizon.end is None:
            return split(self.held, min(last, horizon.now))
        if node.over is None:
            return split(self.held, FAR)
        made = split(self.held, last)
        for left, right, value in self.held:
            add(made, left, right, self.choose(value, horizon.pending))
        return made

    def _enter(self, left: int, right: int, value: float) -> None:
        wedge, choose = self.wedge, self.choose
        self._work_out(left - 1)
        while wedge and choose(wedge[-1][1], value) == value:
            wedge.pop()
        wedge.append((right - self.node.low if right < FAR else FAR, value))
        self._work_out(right)

    def _work_out(self, known: int) -> None:
        """Work out all windows that end at or before an integer."""
        wedge = self.wedge
        until = min(known - self.node.high, FAR) if known < FAR else FAR
        while wedge and self.done <= until:
            last, best = wedge[0]
            right = min(last, until)
            add(self.held, self.done, right, best)
            self.done = max(self.done, right + 1)
            if last <= right:
                wedge.popleft()


class _Shift(Operator):
    """The operand so many integers further on."""

    def __init__(self, node: Shift) -> None:
        self.node = node
        self.held: deque[Step] = deque()

    def copy(self) -> Self:
        made = copy(self)
        made.held = deque(self.held)
        return made

    def take(self, operands: Sequence[Steps], horizon: Horizon) -> list[Step]:
        offset = self.node.offset
        for left, right, value in operands[0]:
            start = left - offset if left > -FAR else left
            add(self.held, start, right - offset if right < FAR else right, value)
        if horizon.end is None:
            return split(self.held, horizon.now)
        made = split(self.held, FAR)
        if horizon.rest is not Rest.END:
            return made
        last = (horizon.end - self.node.opens) // horizon.positions.gap
        return replaced(made, last + 1, FAR, -INFINITE)


class _Since(Operator):
    """S(i) = max(meets(i), min(stays(i), S(i − 1))), or its dual."""

    def __init__(self, node: Sweep) -> None:
        self.dual = node.dual
        self.waiting = _Aligned(2)
        self.value = -INFINITE

    def copy(self) -> Self:
        made = copy(self)
        made.waiting = self.waiting.copy()
        return made

    def take(self, operands: Sequence[Steps], horizon: Horizon) -> list[Step]:
        self.waiting.enter(_sides(operands, horizon, self.dual))
        made: list[Step] = []
        for left, right, (stays, meets) in self.waiting.ready():
            self.value = max(meets, min(stays, self.value))
            add(made, left, right, self.value)
        return negated(made) if self.dual else made


_Part = tuple[int, int, float, float, float, float]
"""First and last integer of a stretch; the least and the greatest value that it can have, whatever
follows; and the same given what has followed."""


class _Until(Operator):
    """U(i) = max(meets(i), min(stays(i), U(i + 1))), or its dual.

    Of a stretch, U is what follows, kept between two bounds; so it is of several stretches at once.
    A stretch whose bounds leave open all that what follows may be has the value of that and is
    joined to it: of `always` and `eventually` those stretches remain that no later one betters.
    """

    def __init__(self, node: Sweep, thin: bool) -> None:
        self.node = node
        self.thin = thin
        self.waiting = _Aligned(2)
        self.parts: deque[_Part] = deque()

    def copy(self) -> Self:
        made = copy(self)
        made.waiting = self.waiting.copy()
        made.parts = deque(self.parts)
        return made

    def take(self, operands: Sequence[Steps], horizon: Horizon) -> list[Step]:
        self.waiting.enter(_sides(operands, horizon, self.node.dual))
        for left, right, (stays, meets) in self.waiting.ready():
            self._follow(left, right, meets, max(meets, stays), horizon)
        made = self._settled() if horizon.end is None else self._ended(horizon)
        return negated(made) if self.node.dual else made

    def _follow(self, left: int, right: int, low: float, high: float, horizon: Horizon) -> None:
        """Append a stretch with its bounds."""
        parts = self.parts
        while parts:
            start, last, least, most, _, _ = parts[-1]
            leads_on = _within(low, least, most) == low and _within(high, least, most) == high
            if not leads_on and (not self.thin or horizon.asks(start, last)):
                break
            parts.pop()
            if leads_on or not parts:
                left = start
                continue
            first, _, its_least, its_most, _, _ = parts.pop()
            least, most = _within(least, its_least, its_most), _within(most, its_least, its_most)
            parts.append((first, last, least, most, least, most))
        parts.append((left, right, low, high, low, high))
        for index in range(len(parts) - 2, -1, -1):
            start, last, least, most, low_now, high_now = parts[index]
            low, high = _within(low, least, most), _within(high, least, most)
            if (low, high) == (low_now, high_now):
                break
            parts[index] = (start, last, least, most, low, high)

    def _settled(self) -> list[Step]:
        made: list[Step] = []
        while self.parts and self.parts[0][4] == self.parts[0][5]:
            left, right, _, _, value, _ = self.parts.popleft()
            add(made, left, right, value)
        return made

    def _ended(self, horizon: Horizon) -> list[Step]:
        kept = horizon.rest is Rest.END and self.node.kept
        value = INFINITE if kept else horizon.pending
        value = -value if self.node.dual else value
        found: list[Step] = []
        while self.parts:
            left, right, least, most, _, _ = self.parts.pop()
            value = _within(value, least, most)
            found.append((left, right, value))
        return found[::-1]


def _within(value: float, least: float, most: float) -> float:
    return max(least, min(most, value))


def _sides(operands: Sequence[Steps], horizon: Horizon, dual: bool) -> tuple[Steps, Steps]:
    """The operands of an `until` or `since`; at integers that are no positions they lead on."""
    left, right = (negated(steps) if dual else steps for steps in operands)
    positions = horizon.positions
    return at_positions(left, positions, INFINITE), at_positions(right, positions, -INFINITE)
