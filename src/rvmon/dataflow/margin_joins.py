"""Functions that are joined value by value, and `until` and `since`, as they become settled."""

from __future__ import annotations

from abc import abstractmethod
from collections import deque
from collections.abc import Mapping, Sequence
from typing import Self

from rvmon.dataflow.margin_nodes import End, Horizon, Operator, Told
from rvmon.dataflow.margins import INFINITE
from rvmon.dataflow.nodes import Junction, Sweep
from rvmon.dataflow.piecewise import FAR


class Input:
    """One operand of a join, up to where all are known.

    Attributes:
        value: where the join has come to.
        known: the integer up to which it is known.
        waiting: from which integer on it has which value, behind that.
    """

    __slots__ = ("join", "known", "value", "waiting")

    def __init__(self, join: Join, known: int, value: float = -INFINITE) -> None:
        self.join = join
        self.known = known
        self.value = value
        self.waiting: deque[tuple[int, float]] = deque()

    def copy(self, join: Join) -> Input:
        """The same, of another join."""
        made = Input(join, self.known, self.value)
        made.waiting = deque(self.waiting)
        return made

    def push(self, start: int, value: float, right: int) -> None:
        """See `Told`."""
        waiting = self.waiting
        if waiting and self.join.thin and not self.join.horizon.asks(waiting[-1][0], start - 1):
            start = waiting.pop()[0]
        waiting.append((start, value))
        self.known = right
        self.join.go()

    def cover(self, right: int) -> None:
        """See `Told`."""
        self.known = right
        self.join.go()


class Join(Operator):
    """Operands brought to common steps.

    Args:
        count: of the operands.
        fixed: by their places, those that never change.
        thin: whether at positions that nobody asks for it may have any value.
        horizon: how much is known.
    """

    def __init__(
        self, count: int, fixed: Mapping[int, float], thin: bool, horizon: Horizon
    ) -> None:
        super().__init__(horizon)
        self.thin = thin
        self.known = horizon.first - 1
        self._inputs = [
            Input(self, FAR, fixed[place]) if place in fixed else Input(self, self.known)
            for place in range(count)
        ]

    @property
    def inputs(self) -> Sequence[Told]:
        """See `Operator`."""
        return self._inputs

    def copy(self, horizon: Horizon) -> Self:
        """See `Operator`."""
        made = super().copy(horizon)
        made._inputs = [one.copy(made) for one in self._inputs]
        return made

    def go(self) -> None:
        """See `Operator`."""
        inputs = self._inputs
        known = min([one.known for one in inputs])
        if known <= self.known:
            return
        self.known = known
        start = self._next()
        if start > known:
            self.covered(known)
        while start <= known:
            for one in inputs:
                if one.waiting and one.waiting[0][0] == start:
                    one.value = one.waiting.popleft()[1]
            after = self._next()
            self.joined(start, min(after - 1, known))
            start = after

    def _next(self) -> int:
        """The next integer at which an operand has another value."""
        return min([one.waiting[0][0] for one in self._inputs if one.waiting], default=FAR + 1)

    @abstractmethod
    def joined(self, start: int, right: int) -> None:
        """Take it that the operands have their values from `start` on, known up to `right`."""

    def covered(self, right: int) -> None:
        """Take it that they have them up to `right`."""
        self.out.cover(right)


class AllOrSome(Join):
    """All of its operands, or one of them."""

    def __init__(
        self, node: Junction, fixed: Mapping[int, float], thin: bool, horizon: Horizon
    ) -> None:
        super().__init__(len(node.operands), fixed, thin, horizon)
        self.choose = min if node.every else max
        self.told: float | None = None

    def joined(self, start: int, right: int) -> None:
        """See `Join`."""
        value = self.choose([one.value for one in self._inputs])
        if value == self.told and not self.horizon.sparse:
            self.out.cover(right)
        else:
            self.told = value
            self.out.push(start, value, right)


class SinceValue(Join):
    """S(i) = max(meets(i), min(stays(i), S(i − 1))), or its dual."""

    def __init__(self, node: Sweep, fixed: Mapping[int, float], horizon: Horizon) -> None:
        super().__init__(2, fixed, False, horizon)
        self.dual = node.dual
        self.value = INFINITE if node.dual else -INFINITE

    def joined(self, start: int, right: int) -> None:
        """See `Join`."""
        self.value = _within(self.value, *_bounds(self._inputs, self.dual))
        self.out.push(start, self.value, right)


_Part = tuple[int, float, float, float, float]
"""First integer of a stretch; the least and the greatest value that it can have, whatever follows;
and the same given what has followed."""


class UntilValue(Join):
    """U(i) = max(meets(i), min(stays(i), U(i + 1))), or its dual.

    Of a stretch, U is what follows, kept between two bounds; so it is of several stretches at once.
    A stretch whose bounds leave open all that what follows may be has the value of that and is
    joined to it: of `always` and `eventually` those stretches remain that no later one betters.

    Attributes:
        asked_alone: whether its value matters at positions that are asked for alone.
        parts: the stretches that are not settled.
        starts: where only samples are positions, those in them.
    """

    def __init__(
        self, node: Sweep, fixed: Mapping[int, float], thin: bool, horizon: Horizon
    ) -> None:
        super().__init__(2, fixed, False, horizon)
        self.node = node
        self.asked_alone = thin
        self.parts: deque[_Part] = deque()
        self.starts: deque[int] | None = deque() if horizon.sparse and not thin else None

    def joined(self, start: int, right: int) -> None:
        """See `Join`."""
        if not self.parts:
            self.out.cover(start - 1)
        if self.starts is not None:
            self.starts.append(start)
        self._follow(start, *_bounds(self._inputs, self.node.dual))
        while self.parts and self.parts[0][3] == self.parts[0][4]:
            first, _, _, value, _ = self.parts.popleft()
            self._tell(first, value, self.parts[0][0] - 1 if self.parts else right)

    def covered(self, right: int) -> None:
        """See `Join`."""
        if not self.parts:
            self.out.cover(right)

    def _follow(self, start: int, low: float, high: float) -> None:
        """Append a stretch with its bounds."""
        parts = self.parts
        while parts:
            first, least, most, _, _ = parts[-1]
            leads_on = _within(low, least, most) == low and _within(high, least, most) == high
            if not leads_on and (not self.asked_alone or self.horizon.asks(first, start - 1)):
                break
            parts.pop()
            if leads_on or not parts:
                start = first
                continue
            before, its_least, its_most, _, _ = parts.pop()
            least, most = _within(least, its_least, its_most), _within(most, its_least, its_most)
            parts.append((before, least, most, least, most))
        parts.append((start, low, high, low, high))
        for index in range(len(parts) - 2, -1, -1):
            first, least, most, low_now, high_now = parts[index]
            low, high = _within(low, least, most), _within(high, least, most)
            if (low, high) == (low_now, high_now):
                break
            parts[index] = (first, least, most, low, high)

    def _tell(self, start: int, value: float, right: int) -> None:
        """Tell the value of a stretch, and so of each position in it."""
        starts = self.starts
        if starts is None:
            self.out.push(start, value, right)
            return
        while starts and starts[0] <= right:
            start = starts.popleft()
            more = starts and starts[0] <= right
            self.out.push(start, value, starts[0] - 1 if more else right)

    def end(self, end: End) -> None:
        """See `Operator`."""
        value, right = end.behind(self.node), end.last
        found = []
        while self.parts:
            start, least, most, _, _ = self.parts.pop()
            value = _within(value, least, most)
            found.append((start, value, right))
            right = start - 1
        for start, value, right in reversed(found):
            self._tell(start, value, right)


def _within(value: float, least: float, most: float) -> float:
    return least if value < least else most if value > most else value


def _bounds(inputs: Sequence[Input], dual: bool) -> tuple[float, float]:
    """Between which values an operator keeps that of its neighbour, from its two operands."""
    stays, meets = inputs[0].value, inputs[1].value
    if dual:
        return min(stays, meets), meets
    return meets, max(stays, meets)
