"""The extremes of windows, and functions that are moved along, as they become settled."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

from rvmon.dataflow.margin_nodes import End, Horizon, Operator, Rest, Told
from rvmon.dataflow.margins import INFINITE
from rvmon.dataflow.nodes import Shift, Sweep, Window
from rvmon.dataflow.piecewise import FAR


class WindowExtreme(Operator):
    """The extreme of the operand over a window, by a monotonic wedge.

    Attributes:
        wedge: the values that may be the extreme of a window to come, the best one first.
        exits: of each the last integer whose window holds it.
        open: that of the value that goes on.
        late: from which integer on the operand has which value, behind what is in the wedge.
        known: the integer up to which the operand is known.
        next: the first integer whose value is not told.
    """

    def __init__(self, node: Window, horizon: Horizon) -> None:
        super().__init__(horizon)
        self.every = node.every
        self.over = node.over
        self.low, self.high, self.open = node.low, node.high, FAR
        if node.low > node.high:  # whatever the operand is, no window holds it
            self.low, self.high, self.open = FAR, -FAR, -FAR
        self.nothing = INFINITE if node.every else -INFINITE
        self.wedge: deque[float] = deque()
        self.exits: deque[int] = deque()
        self.late: deque[tuple[int, float]] = deque()
        self.known = horizon.first - 1
        self.next = horizon.first
        self.told: float | None = None

    @property
    def inputs(self) -> Sequence[Told]:
        """See `Operator`."""
        return (self,)

    def _limit(self) -> int:
        """The last integer of which no further position comes to lie in its window."""
        horizon = self.horizon
        return horizon.now if self.over is None else (horizon.reached - self.over) // horizon.gap

    def push(self, start: int, value: float, right: int) -> None:
        """See `Told`."""
        self.known = right
        before, limit = start - 1 - self.high, self._limit()
        if before > limit or self.late:
            self.late.append((start, value))
            self.go()
            return
        self._tell(before)
        self._enter(start, value)
        if before < limit:
            self._tell(min(right - self.high, limit))

    def cover(self, right: int) -> None:
        """See `Told`."""
        self.known = right
        self.go()

    def go(self) -> None:
        """See `Operator`."""
        self._go(min(self.known - self.high, self._limit()))

    def _go(self, until: int) -> None:
        """Tell all values up to an integer, of which the windows are known."""
        late = self.late
        while late and late[0][0] - 1 - self.high <= until:
            start, value = late.popleft()
            self._tell(start - 1 - self.high)
            self._enter(start, value)
        self._tell(until)

    def _enter(self, start: int, value: float) -> None:
        """Take a value into the wedge; the one before ends here."""
        exits = self.exits
        if exits:
            exits[-1] = start - 1 - self.low
        self._better(value)
        exits.append(self.open)

    def _better(self, value: float) -> None:
        """Have a value drive out those that it betters."""
        wedge, exits = self.wedge, self.exits
        if self.every:
            while wedge and wedge[-1] >= value:
                wedge.pop()
                exits.pop()
        else:
            while wedge and wedge[-1] <= value:
                wedge.pop()
                exits.pop()
        wedge.append(value)

    def _tell(self, until: int) -> None:
        """Tell all values up to an integer, of which the wedge holds the windows."""
        start = self.next
        if until < start:
            return
        wedge, exits = self.wedge, self.exits
        while start <= until:
            while exits and exits[0] < start:
                exits.popleft()
                wedge.popleft()
            value, right = self.nothing, until
            if exits:
                value = wedge[0]
                if exits[0] < until:
                    right = exits[0]
            if value == self.told:
                self.out.cover(right)
            else:
                self.told = value
                self.out.push(start, value, right)
            start = right + 1
        self.next = start

    def end(self, end: End) -> None:
        """See `Operator`."""
        self.late.append((end.last + 1, self.nothing))
        self._go(min(self._limit(), end.last))
        if self.over is not None and end.pending != self.nothing:
            self.nothing = end.pending
            for kept in (self.wedge, self.exits, self.late):
                kept.clear()
        self._go(end.last)


class SparseWindowExtreme(WindowExtreme):
    """The same where only samples are positions.

    Attributes:
        positions: those that have come and whose value is not told.
    """

    def __init__(self, node: Window, horizon: Horizon) -> None:
        super().__init__(node, horizon)
        self.positions: deque[int] = deque()

    def visit(self, position: int) -> None:
        """See `Operator`."""
        self.positions.append(position)

    def _enter(self, start: int, value: float) -> None:
        self._better(value)
        self.exits.append(start - self.low)

    def _tell(self, until: int) -> None:
        if until < self.next:
            return
        self.next = until + 1
        positions, wedge, exits = self.positions, self.wedge, self.exits
        if not positions or positions[0] > until:
            self.out.cover(until)
            return
        right = -FAR
        while right < until:
            position = positions.popleft()
            while exits and exits[0] < position:
                exits.popleft()
                wedge.popleft()
            right = positions[0] - 1 if positions and positions[0] <= until else until
            self.out.push(position, wedge[0] if wedge else self.nothing, right)


class Shifted(Operator):
    """An `until` or `since` so many integers further on.

    Attributes:
        waiting: from which integer on, in its own count, the operand has which value.
        known: the integer up to which that is known, in the same count.
    """

    def __init__(self, node: Shift, sweep: Sweep, horizon: Horizon) -> None:
        super().__init__(horizon)
        self.node = node
        self.sweep = sweep
        self.waiting: deque[tuple[int, float]] = deque()
        if node.offset < 0:
            self.waiting.append((horizon.first, INFINITE if sweep.dual else -INFINITE))
        self.known = horizon.first - 1 - node.offset

    @property
    def inputs(self) -> Sequence[Told]:
        """See `Operator`."""
        return (self,)

    def push(self, start: int, value: float, right: int) -> None:
        """See `Told`."""
        self.waiting.append((start - self.node.offset, value))
        self.cover(right)

    def cover(self, right: int) -> None:
        """See `Told`."""
        self.known = right - self.node.offset
        self.go()

    def go(self) -> None:
        """See `Operator`."""
        horizon, waiting = self.horizon, self.waiting
        until = min(self.known, horizon.now)
        if until < horizon.first:
            return
        if not waiting or waiting[0][0] > until:
            self.out.cover(until)
        while waiting and waiting[0][0] <= until:
            start, value = waiting.popleft()
            right = min(waiting[0][0] - 1, until) if waiting else until
            start = max(start, horizon.first)
            if start <= right:
                self.out.push(start, value, right)

    def end(self, end: End) -> None:
        """See `Operator`."""
        if self.node.offset > 0:
            opened = (end.instant - self.node.opens) // self.horizon.gap
            self._end_with(end, opened)
        self.known = FAR
        self.go()

    def _end_with(self, end: End, opened: int) -> None:
        """Take what is assumed of the operand behind the end; its windows opened up to `opened`."""
        self.waiting.append((end.last - self.node.offset + 1, end.behind(self.sweep)))
        if end.rest is Rest.END:
            self.waiting.append((opened + 1, -INFINITE))


class SparseShifted(Shifted):
    """The same where only samples are positions.

    An `until` has the value of the next one, a `since` that of the last.

    Attributes:
        positions: those that have come and whose value is not told.
    """

    def __init__(self, node: Shift, sweep: Sweep, horizon: Horizon) -> None:
        super().__init__(node, sweep, horizon)
        self.positions: deque[int] = deque()

    def visit(self, position: int) -> None:
        """See `Operator`."""
        self.positions.append(position)

    def go(self) -> None:
        """See `Operator`."""
        positions, waiting, ahead = self.positions, self.waiting, self.node.offset > 0
        until = min(waiting[-1][0] if ahead and waiting else self.known, self.horizon.now)
        while positions and positions[0] <= until:
            position = positions.popleft()
            while len(waiting) > 1 and (waiting[0] if ahead else waiting[1])[0] <= position - ahead:
                waiting.popleft()
            right = positions[0] - 1 if positions and positions[0] <= until else until
            self.out.push(position, waiting[0][1], right)
        self.out.cover(until)

    def _end_with(self, end: End, opened: int) -> None:
        if end.rest is Rest.END:
            self.waiting.append((opened, end.behind(self.sweep)))
        self.waiting.append((FAR, -INFINITE if end.rest is Rest.END else end.pending))
