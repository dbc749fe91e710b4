"""Which bins a stream of samples hits, found beside verdicts, which it never touches."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import Any

from rvmon.coverage.bins import Bins
from rvmon.coverage.core_run import CoverageRun
from rvmon.coverage.hits import Hits
from rvmon.coverage.model import Model, model_of
from rvmon.coverage.requirements import WatchedRequirements
from rvmon.errors import UnknownNameError
from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.inputs.intake import WAYS_TO_SETTLE
from rvmon.monitor.online.monitor import Monitor
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.trace.sample import Recording
from rvmon.trace.time import ticks_of_seconds


class SpecCoverage:
    """The coverage model of a specification, ready to watch any number of runs."""

    def __init__(self, spec: CheckedSpec) -> None:
        self.spec = spec

    def __reduce__(self) -> tuple[type[SpecCoverage], tuple[CheckedSpec]]:
        # What was generated here stays here.
        return SpecCoverage, (self.spec,)

    @cached_property
    def bins(self) -> Bins:
        """Its coverpoints and crosses."""
        return Bins(self.spec)

    @cached_property
    def requirements(self) -> WatchedRequirements:
        """Its requirements and cover goals."""
        return WatchedRequirements(self.spec)

    @cached_property
    def bin_model(self) -> Model:
        """What may be hit of coverpoints and crosses."""
        return model_of(self.bins.groups)

    @cached_property
    def model(self) -> Model:
        """What may be hit."""
        return model_of([*self.bins.groups, *self.requirements.groups])

    def monitor(
        self,
        *,
        settle: str = "now",
        sources: frozenset[str] | None = None,
        requirements: bool = True,
    ) -> CoverageMonitor:
        """What watches one run, sample by sample.

        Args:
            settle: `now` or `next`, as for `rvmon.session.Spec.monitor`.
            sources: the names that can arrive; `None`: all.
            requirements: whether requirements and cover goals are watched as well as bins, which
                costs more than to judge them: each is also judged without each of its parts.

        Raises:
            UnknownNameError: there is no such way to settle.
        """
        if settle not in WAYS_TO_SETTLE:
            ways = ", ".join(WAYS_TO_SETTLE)
            raise UnknownNameError(f"no way to settle `{settle}`: there are {ways}")
        watched = self.requirements if requirements else None
        return CoverageMonitor(self.bins, watched, settle, sources)

    def of(
        self, recording: Recording, end: int | None = None, *, requirements: bool = True
    ) -> Hits:
        r"""What a recording hits.

        Args:
            recording: read to its end.
            end: of the trace in ticks, before or behind its own; what comes later is not seen.
            requirements: as for `monitor`.

        >>> from rvmon import loads
        >>> spec = loads("signal x : real\ncoverpoint size = x {low: [0, 1), high: [1, inf)}\n")
        >>> hits = spec.coverage({"t": [0, 1, 2], "x": [0.5, 3.0, 0.2]})
        >>> {item: hit.count for item, hit in hits["size"].items()}
        {'low': 2, 'high': 1}
        """
        monitor = self.monitor(sources=recording.names, requirements=requirements)
        for sample in recording:
            if end is None or sample.t <= end:
                monitor.step_ns(sample.t, sample.values)
        return monitor.finish_ns(recording.end if end is None else end)


class CoverageMonitor:
    """Watches a stream of samples; made by `SpecCoverage.monitor`.

    Times are as for `rvmon.monitor.Monitor`: seconds, or ticks in the methods that end in `_ns`; so
    are the errors.

    Args:
        bins: are watched.
        requirements: the same; `None`: they are not.
        settle: when a sample is taken for complete.
        sources: the names that can arrive; `None`: all.
    """

    def __init__(
        self,
        bins: Bins,
        requirements: WatchedRequirements | None,
        settle: str,
        sources: frozenset[str] | None,
    ) -> None:
        self._watched = requirements
        self._bins = _BinRun(bins, settle, sources) if bins.groups else None
        self._requirements = [] if requirements is None else requirements.runs(settle, sources)
        # What refuses most comes first: a sample that one refuses none has taken.
        self._runs: list[Monitor] = [*self._requirements]
        self._runs += [] if self._bins is None else [self._bins]

    def step(self, t: float, values: Mapping[str, Any]) -> None:
        """Take one sample (seconds); see `step_ns`."""
        for run in self._runs:
            run.step(t, values)

    def step_ns(self, t_ns: int, values: Mapping[str, Any]) -> None:
        """Take one sample, as a monitor does."""
        for run in self._runs:
            run.step_ns(t_ns, values)

    def advance(self, t: float) -> None:
        """Say that no sample before `t` (seconds) will come."""
        self.advance_ns(ticks_of_seconds(t))

    def advance_ns(self, t_ns: int) -> None:
        """Say that no sample before `t_ns` will come."""
        for run in self._runs:
            run.advance_ns(t_ns)

    def reset(self) -> None:
        """Forget the run; the next sample starts another."""
        for run in self._runs:
            run.reset()

    @property
    def hits(self) -> Hits:
        """The bins and combinations hit so far; what requirements show is known at the end."""
        return {} if self._bins is None else self._bins.hits

    def finish(self, t: float | None = None) -> Hits:
        """End the run, at `t` seconds if that is later than all so far; see `finish_ns`."""
        return self.finish_ns(None if t is None else ticks_of_seconds(t))

    def finish_ns(self, t_ns: int | None = None) -> Hits:
        """End the run, at `t_ns` if that is later than all so far; returns all that it hit."""
        for run in self._runs:
            run.finish_ns(t_ns)
        hits = dict(self.hits)
        if self._watched is not None:
            found = self._watched.hits(self._requirements)
            hits |= {name: items for name, items in found if items}
        return hits


class _BinRun(CoverageRun):
    """Counts what is hit of bins."""

    def __init__(self, bins: Bins, settle: str, sources: frozenset[str] | None) -> None:
        self._bins = bins
        super().__init__(bins.planned, CompiledSpec(bins.spec), settle, sources)

    @property
    def hits(self) -> Hits:
        """What was hit so far."""
        return self._bins.hits(self._core.hits())
