"""Which bins a stream of samples hits, found beside verdicts, which it never touches."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from rvmon.coverage.hits import Hits
from rvmon.coverage.model import Model
from rvmon.coverage.watcher import Bins, Watcher
from rvmon.errors import UnknownNameError
from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.inputs.intake import WAYS_TO_SETTLE
from rvmon.monitor.online.evaluators import Evaluators
from rvmon.monitor.online.monitor import Monitor
from rvmon.monitor.records.ledger import Ledger
from rvmon.plan.outages import Outages
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.trace.sample import Sample
from rvmon.trace.time import ticks_of_seconds


class CoverageMonitor:
    """Watches a stream of samples; made by `Spec.coverage_monitor`.

    Times are as for `rvmon.monitor.Monitor`: seconds, or ticks in the methods that end in `_ns`; so
    are the errors.

    Attributes:
        model: what may be hit.

    Args:
        bins: of the specification.
        settle: `now` or `next`, as for a monitor.
        sources: the names that can arrive; `None`: all.

    Raises:
        UnknownNameError: there is no such way to settle.
    """

    def __init__(
        self, bins: Bins, *, settle: str = "now", sources: frozenset[str] | None = None
    ) -> None:
        if settle not in WAYS_TO_SETTLE:
            ways = ", ".join(WAYS_TO_SETTLE)
            raise UnknownNameError(f"no way to settle `{settle}`: there are {ways}")
        self.model: Model = bins.model
        self._run = _Run(bins, settle, sources)

    def step(self, t: float, values: Mapping[str, Any]) -> None:
        """Take one sample (seconds); see `step_ns`."""
        self._run.step(t, values)

    def step_ns(self, t_ns: int, values: Mapping[str, Any]) -> None:
        """Take one sample, as a monitor does."""
        self._run.step_ns(t_ns, values)

    def advance(self, t: float) -> None:
        """Say that no sample before `t` (seconds) will come."""
        self._run.advance(t)

    def advance_ns(self, t_ns: int) -> None:
        """Say that no sample before `t_ns` will come."""
        self._run.advance_ns(t_ns)

    def reset(self) -> None:
        """Forget the run; the next sample starts another."""
        self._run.reset()

    @property
    def hits(self) -> Hits:
        """What was hit so far, by group and item; of what was held back nothing is told."""
        return self._run.hits

    def finish(self, t: float | None = None) -> Hits:
        """End the run, at `t` seconds if that is later than all so far; see `finish_ns`."""
        return self.finish_ns(None if t is None else ticks_of_seconds(t))

    def finish_ns(self, t_ns: int | None = None) -> Hits:
        """End the run, at `t_ns` if that is later than all so far; returns what it hit."""
        self._run.finish_ns(t_ns)
        return self._run.hits


class _Run(Monitor):
    """Takes samples as every monitor does, and judges nothing."""

    def __init__(self, bins: Bins, settle: str, sources: frozenset[str] | None) -> None:
        self._bins = bins
        super().__init__(CompiledSpec(bins.spec), (), "auto", settle, sources, None)

    def _make_evaluators(self) -> Evaluators:
        self._watcher = self._bins.watcher(Outages(self._bins.spec, self.options.sources))
        return _Watching(self._bins.spec, self.options.sources, self._ledger, self._watcher)

    @property
    def hits(self) -> Hits:
        """What was hit so far."""
        return {one.name: dict(one.hits) for one in self._watcher.groups if one.hits}


class _Watching(Evaluators):
    """Of all evaluators only the one that watches bins."""

    def __init__(
        self,
        spec: CheckedSpec,
        sources: frozenset[str] | None,
        ledger: Ledger,
        watcher: Watcher,
    ) -> None:
        super().__init__(spec, (), "auto", sources, ledger)
        self.main = watcher


def coverage_of(
    bins: Bins,
    samples: Iterable[Sample],
    *,
    sources: frozenset[str] | None = None,
    end: int | None = None,
) -> Hits:
    """What a trace hits.

    Args:
        bins: of the specification.
        samples: of the trace.
        sources: the names that can arrive; `None`: all.
        end: the end of the trace, if it ended after its last sample.
    """
    monitor = CoverageMonitor(bins, sources=sources)
    for sample in samples:
        monitor.step_ns(sample.t, sample.values)
    return monitor.finish_ns(end)
