"""Samples go to a monitor of a specification while a test is played."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from rvmon.cdv.campaign import Collector
from rvmon.cdv.system import Values
from rvmon.coverage.hits import Hits

if TYPE_CHECKING:
    from rvmon.monitor import Monitor
    from rvmon.session import Spec
    from rvmon.verdict.report import Report


class Checker:
    """Judges one test after the other: `begin`, `observe` each sample, `finish`.

    Args:
        spec: what to judge by; names that it does not declare are passed over.
        collect: makes of it what gathers coverage of one run beside.
    """

    def __init__(self, spec: Spec, collect: Callable[[Spec], Collector] | None = None) -> None:
        self._spec = spec
        self._names = frozenset((*spec.checked.signals, *spec.checked.events))
        self._monitor: Monitor = spec.monitor()
        self._collect = collect
        self._collector: Collector | None = None

    def begin(self) -> None:
        """Forget the last test."""
        self._monitor.reset()
        self._collector = None if self._collect is None else self._collect(self._spec)

    def observe(self, t_ns: int, values: Values) -> None:
        """Take one whole sample."""
        known = {name: value for name, value in values.items() if name in self._names}
        if known:
            self._monitor.step_ns(t_ns, known)
            if self._collector is not None:
                self._collector.step_ns(t_ns, known)

    def finish(self, end_ns: int) -> Report:
        """The verdicts on a test that was observed up to `end_ns`."""
        return self._monitor.finish_ns(end_ns)

    def hits(self, end_ns: int) -> Hits:
        """What a test hit that was observed up to `end_ns`."""
        return {} if self._collector is None else self._collector.finish_ns(end_ns)
