"""Samples go to a monitor of a specification while a test is played, and to what watches it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from rvmon.cdv.system import Values
from rvmon.cdv.watch import Watch
from rvmon.coverage.hits import Hit, Hits, illegal
from rvmon.verdict.illegal import IllegalHit

if TYPE_CHECKING:
    from rvmon.monitor import Monitor
    from rvmon.session import Spec
    from rvmon.verdict.report import Report


class Checker:
    """Judges one test after the other: `begin`, `observe` each sample, `finish`.

    Args:
        spec: what to judge by; names that it does not declare are passed over.
        watches: coverage models by which each test is watched beside.

    Attributes:
        hits: what the test that was finished last hit of them.
    """

    def __init__(self, spec: Spec, watches: Sequence[Watch] = ()) -> None:
        self._monitor: Monitor = spec.monitor()
        self._watched = [(watch, watch.monitor()) for watch in watches]
        self._steps: list[tuple[frozenset[str], Callable[[int, Values], object]]] = [
            (_names(spec), self._monitor.step_ns),
            *((_names(watch.spec), monitor.step_ns) for watch, monitor in self._watched),
        ]
        self.hits: Hits = {}

    def begin(self) -> None:
        """Forget the last test."""
        self._monitor.reset()
        for _, monitor in self._watched:
            monitor.reset()

    def observe(self, t_ns: int, values: Values) -> None:
        """Take one whole sample."""
        for names, step_ns in self._steps:
            known = {name: value for name, value in values.items() if name in names}
            if known:
                step_ns(t_ns, known)

    def finish(self, end_ns: int) -> Report:
        """The verdicts on a test that was observed up to `end_ns`."""
        found: list[IllegalHit] = []
        hits: dict[str, Mapping[str, Hit]] = {}
        for watch, monitor in self._watched:
            own = monitor.finish_ns(end_ns)
            hits |= own
            for group, item, hit in illegal(own, watch.spec.coverage_model.bin_model):
                found.append(IllegalHit(group.name, item.name, hit.count, hit.first or 0))
        self.hits = hits
        report = self._monitor.finish_ns(end_ns)
        return replace(report, illegal=tuple(found)) if found else report


def _names(spec: Spec) -> frozenset[str]:
    return frozenset((*spec.checked.signals, *spec.checked.events))
