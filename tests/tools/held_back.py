"""A monitor that settles samples with the next stamp, told each of them in portions."""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence

from rvmon.spec.checked.specification import CheckedSpec
from rvmon.trace.health import Health, HealthKind
from rvmon.trace.sample import Value
from rvmon.verdict.attempt import Attempt
from rvmon.verdict.report import Report
from tests.tools.drive import OnlineMonitor
from tests.tools.health import readers_of


class HeldBack:
    """Tells a monitor each sample as several of one stamp, which come to the same.

    The order of the names is random; a signal may come with another value before its last, an event
    may be denied before it occurs, and of two payloads each may come by itself.

    Args:
        monitor: fresh, with `settle="next"`.
        spec: that it judges.
        rng: says how samples are cut.

    Attributes:
        monitor: the same.
    """

    def __init__(self, monitor: OnlineMonitor, spec: CheckedSpec, rng: random.Random) -> None:
        self.monitor = monitor
        self._spec = spec
        self._rng = rng
        self._conflicts: dict[str, tuple[int, int]] = {}

    def step_ns(self, t_ns: int, values: Mapping[str, Value]) -> Sequence[Attempt]:
        """Take a sample in portions; returns what all of them decided."""
        decided: list[Attempt] = []
        for portion in self._portions(t_ns, values):
            decided += self.monitor.step_ns(t_ns, portion)
        return decided

    def _portions(self, t: int, values: Mapping[str, Value]) -> list[dict[str, Value]]:
        portions: list[dict[str, Value]] = [{} for _ in range(self._rng.randint(1, 3))]
        names = list(values)
        self._rng.shuffle(names)
        last = len(portions) - 1
        for name in names:
            place = self._rng.randint(0, last)
            portions[place][name] = values[name]
            if place and self._rng.random() < 0.3:
                portions[place - 1].update(self._before(t, name, values[name], portions[place]))
        return portions

    def _before(self, t: int, name: str, value: Value, after: dict[str, Value]) -> dict[str, Value]:
        """What may come of a name before its value at the same stamp."""
        if isinstance(value, tuple):
            first, *rest = value
            after[name] = tuple(rest)
            return {name: (first,)}
        if name in self._spec.events:
            return {name: False if value is not None else None}
        if value is None or name in self._spec.ignoring:
            return {name: None}
        count, first_at = self._conflicts.get(name, (0, t))
        self._conflicts[name] = (count + 1, first_at)
        return {name: None}

    def health(self) -> list[Health]:
        """The findings that the other values gave rise to."""
        readers = readers_of(self._spec)
        return [
            Health(HealthKind.CONFLICT, name, count, first, readers.get(name, ()))
            for name, (count, first) in self._conflicts.items()
        ]

    def advance_ns(self, t_ns: int) -> Sequence[Attempt]:
        """See `Monitor.advance_ns`."""
        return self.monitor.advance_ns(t_ns)

    def finish_ns(self, t_ns: int | None = None) -> Report:
        """See `Monitor.finish_ns`."""
        return self.monitor.finish_ns(t_ns)

    @property
    def open(self) -> Sequence[Attempt]:
        """See `Monitor.open`."""
        return self.monitor.open

    @property
    def next_due(self) -> int | None:
        """See `Monitor.next_due`."""
        return self.monitor.next_due
