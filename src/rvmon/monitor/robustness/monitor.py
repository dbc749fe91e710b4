"""The robustness of attempts, found beside their verdicts, which it never touches.

What comes behind a decision counts as long as the window is open.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from rvmon.errors import UnknownNameError
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.inputs.intake import WAYS_TO_SETTLE
from rvmon.monitor.online.evaluators import Evaluators
from rvmon.monitor.online.generated import GeneratedMonitor
from rvmon.monitor.robustness.evaluators import MeasuringEvaluators, measuring_forms
from rvmon.monitor.robustness.gauged import Gauged, measured
from rvmon.monitor.robustness.values import Measured
from rvmon.trace.time import ticks_of_seconds


class RobustnessMonitor:
    """Measures a stream of samples; made by `Spec.robustness_monitor`.

    Times are as for `rvmon.monitor.Monitor`: seconds, or ticks in the methods that end in `_ns`; so
    are the errors.

    Args:
        compiled: the specification.
        only: ids of the requirements; default all.
        settle: `now` or `next`, as for a monitor.
        sources: the names that can arrive; `None`: all.
        streams: whether to measure each position, and not the attempts alone.

    Raises:
        UnknownNameError: there is no such way to settle.
    """

    def __init__(
        self,
        compiled: CompiledSpec,
        only: Sequence[str] | None = None,
        settle: str = "now",
        sources: frozenset[str] | None = None,
        *,
        streams: bool = False,
    ) -> None:
        if settle not in WAYS_TO_SETTLE:
            ways = ", ".join(WAYS_TO_SETTLE)
            raise UnknownNameError(f"no way to settle `{settle}`: there are {ways}")
        requirements = compiled.requirements.items()
        chosen = [one for name, one in requirements if only is None or name in only]
        self._run = _Run(compiled, chosen, settle, sources, streams=streams)

    def step(self, t: float, values: Mapping[str, Any]) -> Sequence[Measured]:
        """Take one sample (seconds); see `step_ns`."""
        self._run.step(t, values)
        return self._run.followed()

    def step_ns(self, t_ns: int, values: Mapping[str, Any]) -> Sequence[Measured]:
        """Take one sample and return the figures that nothing can change any more."""
        self._run.step_ns(t_ns, values)
        return self._run.followed()

    def advance(self, t: float) -> Sequence[Measured]:
        """Say that no sample before `t` (seconds) will come; see `advance_ns`."""
        return self.advance_ns(ticks_of_seconds(t))

    def advance_ns(self, t_ns: int) -> Sequence[Measured]:
        """Say that no sample before `t_ns` will come; returns the figures that this settled."""
        self._run.advance_ns(t_ns)
        return self._run.taken()

    @property
    def open(self) -> Sequence[Measured]:
        """What is known now of the attempts that are not settled: bounds that only draw closer."""
        return self._run.open_figures()

    def finish(self, t: float | None = None) -> Sequence[Measured]:
        """End the run, at `t` seconds if that is later than all so far; see `finish_ns`."""
        return self.finish_ns(None if t is None else ticks_of_seconds(t))

    def finish_ns(self, t_ns: int | None = None) -> Sequence[Measured]:
        """End the run, at `t_ns` if that is later than all so far, and return the other figures."""
        self._run.finish_ns(t_ns)
        return self._run.taken()


class _Run(GeneratedMonitor):
    """Takes samples as every monitor does, and measures the attempts that it judges."""

    def __init__(
        self,
        compiled: CompiledSpec,
        requirements: Sequence[CompiledRequirement],
        settle: str,
        sources: frozenset[str] | None,
        *,
        streams: bool,
    ) -> None:
        self._streams = streams
        forms = measuring_forms(compiled, requirements, sources)
        super().__init__(forms, compiled, requirements, "auto", settle, sources, None)

    def _make_evaluators(self) -> Evaluators:
        self._ledger = self._gauged = Gauged()
        self._measured = MeasuringEvaluators(
            self._gauged,
            self._streams,
            self._forms,
            self._unit,
            self.options.compiled,
            self.options.engine,
            self.options.sources,
            self._gauged,
            self._take,
        )
        self._unit_evaluators = self._measured
        return self._measured

    def followed(self) -> Sequence[Measured]:
        """The figures that are settled now that a sample was taken; see `taken`."""
        if not self._by_unit:
            return self.taken()
        # Generated code may have taken it by itself.
        t = self._last = self._reached = self._floor = self._unit.after
        self._gauged.heard = t
        for judge in self._measured.beside_unit:
            judge.follow(t)
        return self._gauged.taken(over=False)

    def taken(self) -> Sequence[Measured]:
        """The figures that are settled and were not taken yet, in order of their instants."""
        over = self._report is not None
        if not over and self._reached is not None:
            for judge in self._measured.measuring:
                judge.settle(self._reached)
        return self._gauged.taken(over=over)

    def open_figures(self) -> Sequence[Measured]:
        """What is known of the open attempts."""
        if self._reached is None or self._report is not None:
            return ()
        made = list(self._gauged.waiting)
        for judge in self._measured.measuring:
            end = self._reached if self._last == self._reached else self._reached - 1
            found = judge.figures(end, self._reached) if judge.attempts else {}
            made += [
                measured(judge, attempt, found[judge.positions[attempt]], attempt.triggered)
                for attempt in judge.attempts
                if attempt not in self._gauged.vanished
            ]
        return made
