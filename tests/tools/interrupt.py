"""A monitor that is put away and taken up again on the way: that must change nothing."""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence

from rvmon.monitor import Monitor
from rvmon.monitor.core.monitor import restore
from rvmon.trace.sample import Value
from rvmon.verdict.attempt import Attempt
from rvmon.verdict.report import Report


class Interrupted:
    """Before some of the calls, the monitor is replaced by the one that its snapshot gives.

    Args:
        monitor: fresh.
        rng: says before which calls.
        share: of the calls.
    """

    def __init__(self, monitor: Monitor, rng: random.Random, share: float = 0.1) -> None:
        self._monitor = monitor
        self._rng = rng
        self._share = share
        self.interruptions = 0

    def _interrupt(self) -> Monitor:
        if self._rng.random() < self._share:
            self.interruptions += 1
            self._monitor = restore(self._monitor.compiled, self._monitor.snapshot())
        return self._monitor

    def step_ns(self, t_ns: int, values: Mapping[str, Value]) -> Sequence[Attempt]:
        """See `Monitor.step_ns`."""
        return self._interrupt().step_ns(t_ns, values)

    def advance_ns(self, t_ns: int) -> Sequence[Attempt]:
        """See `Monitor.advance_ns`."""
        return self._interrupt().advance_ns(t_ns)

    def finish_ns(self, t_ns: int | None = None) -> Report:
        """See `Monitor.finish_ns`."""
        report = self._interrupt().finish_ns(t_ns)
        self._share = 0  # a finished run is not interrupted
        return report

    @property
    def open(self) -> Sequence[Attempt]:
        """See `Monitor.open`."""
        return self._interrupt().open

    @property
    def next_due(self) -> int | None:
        """See `Monitor.next_due`."""
        return self._interrupt().next_due
