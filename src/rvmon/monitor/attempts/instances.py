"""All instances of one run: whom a sample or an instant concerns, and whom to let go of."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from heapq import heappop, heappush

from rvmon.errors import TraceError
from rvmon.monitor.attempts.evaluator import Evaluator
from rvmon.monitor.attempts.instance import Instance, seen_by
from rvmon.monitor.attempts.keyed import MOST_OPEN, Keyed
from rvmon.runtime.values import NEVER
from rvmon.trace.sample import Scalar, Value
from rvmon.trace.time import format_ticks

_Entry = tuple[Keyed, Scalar, Evaluator]


class Instances:
    """The instances of all requirements of a run; each open one is looked at when it is due.

    Args:
        forgets: whether instances are let go of that are over.
        is_held: whether something besides, of an instance, is open.

    Attributes:
        keyed: by requirement, its instances.
    """

    def __init__(self, *, forgets: bool, is_held: Callable[[Instance], bool]) -> None:
        self.keyed: dict[str, Keyed] = {}
        self._forgets = forgets
        self._is_held = is_held
        self._alarms: list[tuple[int, int, Keyed, Scalar]] = []
        """When open instances are to be looked at; `_alarm_of` says which entries still hold."""
        self._alarm_of: dict[Evaluator, int] = {}
        self._alarms_set = 0

    def entries(self) -> Iterator[tuple[Evaluator, Instance]]:
        """The evaluators there are now, those of no value first, with their instances."""
        for keyed in self.keyed.values():
            yield keyed.template, keyed.doubted
        for keyed in self.keyed.values():
            for value, evaluator in keyed.open.items():
                yield evaluator, keyed.known[value]

    def through(self, limit: int) -> None:
        """Let time pass up to `limit`; what nothing happens in follows when it is looked at."""
        for keyed in self.keyed.values():
            keyed.template.through(limit)
        for entry in self._rung(limit):
            entry[2].through(limit)
            self._see_to(*entry)

    def reach(self, t: int) -> None:
        """Let time come to `t`, of which no position is known."""
        for keyed in self.keyed.values():
            keyed.template.reach(t)
        for entry in self._rung(t):
            entry[2].reach(t)
            self._see_to(*entry)

    def sample(self, t: int, values: Mapping[str, Value]) -> None:
        """Give a sample to those that it concerns, and to those in which something happens now."""
        asked = {evaluator: (keyed, value) for keyed, value, evaluator in self._rung(t)}
        for keyed in self.keyed.values():
            keyed.template.sample(t, seen_by(keyed.doubted, values))
            asked |= {keyed.open[value]: (keyed, value) for value in keyed.concerned(values)}
        for evaluator, (keyed, value) in asked.items():
            evaluator.sample(t, seen_by(keyed.known[value], values))
            self._see_to(keyed, value, evaluator)

    def _rung(self, limit: int) -> list[_Entry]:
        """The open instances in which something happens up to an instant."""
        found = []
        while self._alarms and self._alarms[0][0] <= limit:
            at, _, keyed, value = heappop(self._alarms)
            evaluator = keyed.open.get(value)
            if evaluator is not None and self._alarm_of.get(evaluator) == at:
                del self._alarm_of[evaluator]
                found.append((keyed, value, evaluator))
        return found

    def _see_to(self, keyed: Keyed, value: Scalar, evaluator: Evaluator) -> None:
        """Let go of an open instance if it is over, after something was done to it."""
        if self._forgets and keyed.is_over(evaluator) and not self._is_held(keyed.known[value]):
            keyed.close(value)
            self._alarm_of.pop(evaluator, None)
        else:
            self._set_alarm(keyed, value, evaluator, evaluator.alarm)

    def _set_alarm(self, keyed: Keyed, value: Scalar, evaluator: Evaluator, alarm: int) -> None:
        if self._alarm_of.get(evaluator) != alarm:
            self._alarm_of[evaluator] = alarm
            if alarm < NEVER:
                self._alarms_set += 1
                heappush(self._alarms, (alarm, self._alarms_set, keyed, value))

    def opened(self, keyed: Keyed, value: Scalar, evaluator: Evaluator) -> None:
        """Take the evaluator of an instance, which is looked at next."""
        keyed.opened(value, evaluator)
        self._set_alarm(keyed, value, evaluator, -NEVER)

    def let_go(self) -> None:
        """Let go of all instances that are over, after attempts were taken away."""
        for keyed in self.keyed.values():
            for value, evaluator in tuple(keyed.open.items()):
                self._see_to(keyed, value, evaluator)

    def admit(self, t: int, values: Mapping[str, Value]) -> None:
        """See that there is room for the instances that a sample asks for.

        Raises:
            TraceError: there would be too many at once.
        """
        for name, keyed in self.keyed.items():
            asked = len(keyed.open) + len(keyed.values_to_open(values))
            if asked > MOST_OPEN:
                source = keyed.each.value
                raise TraceError(
                    f"sample at {format_ticks(t)}: {name} would have {asked} instances of "
                    f"`{source.event}.{source.field}` open at once, of {MOST_OPEN} that there can "
                    "be: an upper bound in the consequent (`within D`) lets them close, or run "
                    "one monitor for each part of the values"
                )
