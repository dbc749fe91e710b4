"""Samples that cannot be judged as they come: equal stamps, and what may be late."""

from __future__ import annotations

from collections.abc import Container, Mapping
from heapq import heappop, heappush
from typing import Any

from rvmon.errors import TimeOrderError
from rvmon.monitor.inputs.validate import Validator
from rvmon.readers.coalesce import Conflicts, coalesce
from rvmon.trace.sample import Sample, Value
from rvmon.trace.time import TIME_LIMIT, format_ticks, whole_ticks

WAYS_TO_SETTLE = ("now", "next")
"""When a sample is taken for complete: at once, or when another stamp follows."""

MOST_HELD = 65_536
"""So many samples at most wait for late ones; with more, the oldest are judged early."""


class Intake:
    """Holds samples back until no other can come at their instant or before (SEMANTICS 6).

    Args:
        delay: how much later than the newest sample one may come, ticks.
        events: the names that are events.

    Attributes:
        floor: no sample before this instant is taken any more.
        conflicts: signals that got two values at one instant.
        late: samples that came after their instant was settled: how many, and the first's instant.
        crowded: samples judged early because too many waited: the same.
    """

    def __init__(self, delay: int, events: Container[str]) -> None:
        self.delay = delay
        self.events = events
        self.floor = -TIME_LIMIT
        self.conflicts = Conflicts()
        self.late: tuple[int, int] | None = None
        self.crowded: tuple[int, int] | None = None
        self._held: list[tuple[int, int, Mapping[str, Value]]] = []
        self._taken = 0

    def take(self, t: int, values: Mapping[str, Value]) -> list[Sample]:
        """Take a sample; returns those that are settled by it, in order.

        Raises:
            TimeOrderError: it comes before the floor, and no delay is allowed; nothing changed.
        """
        if t < self.floor:
            if not self.delay:
                raise TimeOrderError(
                    f"sample at {format_ticks(t)}, but time has come to "
                    f"{format_ticks(self.floor)}: sort the samples, or allow a `max delay`"
                )
            count, first = self.late or (0, t)
            self.late = (count + 1, first)
            return []
        self._taken += 1
        heappush(self._held, (t, self._taken, values))
        ready = self.settle(t - self.delay)
        if self.delay and len(self._held) > MOST_HELD:
            oldest = self._held[0][0]
            count, first = self.crowded or (0, oldest)
            self.crowded = (count + 1, first)
            ready += self.settle(oldest + 1)
        return ready

    def settle(self, t: int) -> list[Sample]:
        """Learn that no sample before `t` will come; returns those that are settled, in order."""
        self.floor = max(self.floor, t)
        ready = []
        while self._held and self._held[0][0] < self.floor:
            instant, _, values = heappop(self._held)
            ready.append(Sample(instant, values))
        return list(coalesce(ready, self.events, self.conflicts))

    def state(self) -> Mapping[str, Any]:
        """What is held, as JSON has it."""
        held = [[t, place, dict(values)] for t, place, values in self._held]
        return {
            "floor": self.floor,
            "late": self.late,
            "crowded": self.crowded,
            "conflicts": self.conflicts.seen,
            "held": held,
        }

    def take_up(self, state: Mapping[str, Any], validator: Validator) -> None:
        """Hold what `state` gave.

        Raises:
            TraceError: a sample is none of the specification.
        """
        self.floor = _integer(state["floor"])
        self.late, self.crowded = map(_counted, (state["late"], state["crowded"]))
        for name, found in state["conflicts"].items():
            count, first = _counted(found) or (0, 0)
            self.conflicts.add(str(name), first, count)
        for t, place, values in state["held"]:
            checked = validator.check(whole_ticks(t), values)
            heappush(self._held, (whole_ticks(t), _integer(place), checked))
            self._taken = max(self._taken, place)

    def close(self) -> list[Sample]:
        """Learn that no sample will come; returns all that are held, in order."""
        return self.settle(TIME_LIMIT)


def _counted(found: Any) -> tuple[int, int] | None:
    """How many there were and the first's instant, as JSON has it."""
    if found is None:
        return None
    count, first = found
    return _integer(count), whole_ticks(first)


def _integer(number: Any) -> int:
    if type(number) is not int:
        raise TypeError(f"expected a whole number, found {number!r}")
    return number
