"""Which bins a stream of samples hits, found beside verdicts, which it never touches."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

from rvmon import native
from rvmon.coverage.bins import Bins
from rvmon.coverage.model import Hits, Model, model_of
from rvmon.coverage.requirements import WatchedRequirements
from rvmon.errors import UnknownNameError
from rvmon.monitor.compiled_spec import CompiledSpec
from rvmon.monitor.intake import WAYS_TO_SETTLE
from rvmon.monitor.monitor import Monitor
from rvmon.monitor.planned import PlannedCore
from rvmon.monitor.recording import RecordingRun
from rvmon.monitor.snapshot import Options
from rvmon.readers.source import Source
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.trace.sample import Recording
from rvmon.trace.time import ticks_of_seconds
from rvmon.verdict.report import Report, report_of


class _CoverageRun(Monitor):
    """Takes samples as every monitor does, and makes no report."""

    def _reported(self, end: int | None) -> Report:
        return report_of((), (), end=end)


class SpecCoverage:
    """The coverage model of a specification, ready to watch any number of runs."""

    def __init__(self, spec: CheckedSpec) -> None:
        self.spec = spec

    def __reduce__(self) -> tuple[type[SpecCoverage], tuple[CheckedSpec]]:
        # What was made here stays here.
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
        return CoverageMonitor(_Watched(self, requirements=requirements), settle, sources)

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
        source = Source(recording, end, is_cut=True)
        watched = _Watched(self, requirements=requirements)
        runs = [
            RecordingRun(self.spec, one, source, finds=False) for one in watched.planned.values()
        ]
        for piece in source.pieces():
            for run in runs:
                run.take(piece)
        for run in runs:
            run.finish()
        return watched.hits([run.core for run in runs])


class _Watched:
    """What of a coverage model is watched."""

    def __init__(self, model: SpecCoverage, *, requirements: bool) -> None:
        self._bins = model.bins
        self._requirements = model.requirements if requirements else None

    @cached_property
    def planned(self) -> Mapping[CompiledSpec, PlannedCore]:
        """What the core takes samples by: what refuses most comes first, the bins last.

        A sample that the first has taken is taken by all.
        """
        found = {} if self._requirements is None else dict(self._requirements.planned)
        if self._bins.groups:
            found[CompiledSpec(self._bins.spec)] = self._bins.planned
        return found

    def bin_hits(self, runs: Sequence[native.Monitor]) -> Hits:
        """The bins and combinations hit so far."""
        return self._bins.hits(runs[-1].hits()) if self._bins.groups else {}

    def hits(self, runs: Sequence[native.Monitor]) -> Hits:
        """All that was hit; the runs are over."""
        hits = dict(self.bin_hits(runs))
        if self._requirements is not None:
            own = runs[: len(self._requirements.planned)]
            hits |= {name: items for name, items in self._requirements.hits(own) if items}
        return hits


class CoverageMonitor:
    """Watches a stream of samples; made by `SpecCoverage.monitor`.

    Times are as for `rvmon.monitor.Monitor`: seconds, or ticks in the methods that end in `_ns`; so
    are the errors.

    Args:
        watched: says what is looked at.
        settle: when a sample is taken for complete.
        sources: the names that can arrive; `None`: all.
    """

    def __init__(self, watched: _Watched, settle: str, sources: frozenset[str] | None) -> None:
        self._watched = watched
        self._runs = [
            _CoverageRun(planned, compiled, Options(settle, sources, None))
            for compiled, planned in watched.planned.items()
        ]

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
        return self._watched.bin_hits([run.core for run in self._runs])

    def finish(self, t: float | None = None) -> Hits:
        """End the run, at `t` seconds if that is later than all so far; see `finish_ns`."""
        return self.finish_ns(None if t is None else ticks_of_seconds(t))

    def finish_ns(self, t_ns: int | None = None) -> Hits:
        """End the run, at `t_ns` if that is later than all so far; returns all that it hit."""
        for run in self._runs:
            run.finish_ns(t_ns)
        return self._watched.hits([run.core for run in self._runs])
