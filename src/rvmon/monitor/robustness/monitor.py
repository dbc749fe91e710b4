"""The robustness of attempts, found beside their verdicts, which it never touches.

What comes behind a decision counts as long as the window is open.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any
from weakref import WeakKeyDictionary

from rvmon.automaton.machine import Token
from rvmon.dataflow.margins import INFINITE
from rvmon.dataflow.network_plan import plan_of
from rvmon.dataflow.nodes import NetworkPlan
from rvmon.errors import UnknownNameError
from rvmon.formula.expand import expanded
from rvmon.monitor.attempts.attempt_judge import AttemptJudge, Open
from rvmon.monitor.attempts.evaluator import Evaluator
from rvmon.monitor.attempts.instance import Instance
from rvmon.monitor.attempts.keyed import Keyed
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.inputs.intake import WAYS_TO_SETTLE
from rvmon.monitor.online.evaluator_maker import Captured
from rvmon.monitor.online.evaluators import Evaluators
from rvmon.monitor.online.monitor import Monitor
from rvmon.monitor.records.ledger import Ledger, verdict_at_end
from rvmon.monitor.robustness.margin_judge import MarginJudge
from rvmon.monitor.robustness.values import Measured, Robustness
from rvmon.plan.graph import Graph
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.trace.sample import Value
from rvmon.trace.time import TIME_LIMIT, ticks_of_seconds
from rvmon.verdict.verdict import Verdict


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
        return self._run.taken()

    def step_ns(self, t_ns: int, values: Mapping[str, Any]) -> Sequence[Measured]:
        """Take one sample and return the figures that nothing can change any more."""
        self._run.step_ns(t_ns, values)
        return self._run.taken()

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


class _Run(Monitor):
    """Takes samples as every monitor does and gives margins in the place of verdicts."""

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
        super().__init__(compiled, requirements, "auto", settle, sources, None)

    def _make_evaluators(self) -> Evaluators:
        self._gauged = _Gauged()
        self._ledger = self._gauged
        return _MeasuringEvaluators(
            self.options.compiled.checked,
            self.options.requirements,
            self.options.sources,
            self._gauged,
            self._streams,
        )

    def taken(self) -> Sequence[Measured]:
        """The figures that are settled and were not taken yet, in order of their instants."""
        over = self._report is not None
        if not over and self._reached is not None:
            for judge in self._measuring:
                judge.settle(self._reached)
        return self._gauged.taken(over=over)

    @property
    def _measuring(self) -> list[MarginJudge]:
        return [judge for judge in self._evaluators.judges if isinstance(judge, MarginJudge)]

    def open_figures(self) -> Sequence[Measured]:
        """What is known of the open attempts."""
        if self._reached is None or self._report is not None:
            return ()
        made = list(self._gauged.waiting)
        for judge in self._measuring:
            end = self._reached if self._last == self._reached else self._reached - 1
            found = judge.figures(end, self._reached) if judge.attempts else {}
            made += [
                _measured(judge, attempt, found[judge.positions[attempt]], attempt.triggered)
                for attempt in judge.attempts
                if attempt not in self._gauged.vanished
            ]
        return made


class _MeasuringEvaluators(Evaluators):
    """Evaluators in which another judge, beside each of the usual ones, measures its attempts."""

    forgets = False

    def __init__(
        self,
        spec: CheckedSpec,
        requirements: Sequence[CompiledRequirement],
        sources: frozenset[str] | None,
        gauged: _Gauged,
        streams: bool,
    ) -> None:
        self._gauged = gauged
        self._streams = streams
        self._plans: dict[CompiledRequirement, NetworkPlan] = {}
        super().__init__(spec, requirements, "auto", sources, gauged)

    def _judges(
        self,
        compiled: CompiledRequirement,
        evaluator: Evaluator,
        captured: Captured,
        instance: Instance | None,
        *,
        started_elsewhere: bool = False,
    ) -> Sequence[AttemptJudge]:
        judges = super()._judges(
            compiled, evaluator, captured, instance, started_elsewhere=started_elsewhere
        )
        requirement = compiled.requirement
        alone = not requirement.captures and requirement.for_each is None
        is_main = compiled is self._by_id[requirement.id]
        beside = MarginJudge(
            compiled,
            self._plan_of(compiled),
            evaluator,
            self._gauged,
            captured,
            self.spec,
            every=self._streams and alone and is_main,
        )
        self._gauged.beside[judges[0]] = beside
        return [*judges, beside]

    def _plan_of(self, compiled: CompiledRequirement) -> NetworkPlan:
        if compiled not in self._plans:
            self._plans[compiled] = plan_of(expanded(compiled.obligation.owed), self.gap)
        return self._plans[compiled]

    def _make_keyed(self, compiled: CompiledRequirement) -> Keyed:
        keyed = super()._make_keyed(compiled)
        if any(self._plan_of(one).looks_back for one in compiled.judges.values()):
            # What measures an instance has to see what was before it.
            keyed.reach = replace(keyed.reach, is_fresh=False)
        return keyed

    def _replays(self, compiled: CompiledRequirement, graph: Graph) -> bool:
        return self._plan_of(compiled).looks_back or super()._replays(compiled, graph)

    def sample(self, t: int, values: Mapping[str, Value]) -> None:
        """See `Evaluators`."""
        self._gauged.heard = t
        super().sample(t, values)

    def finish(self, end: int, reached: int) -> None:
        """See `Evaluators`; the positions that were not settled are measured as well."""
        super().finish(end, reached)
        for judge in self.judges:
            if isinstance(judge, MarginJudge) and judge.every:
                for t, found in judge.figures(end, reached).items():
                    self._gauged.passed(judge, t, found)


class _Gauged(Ledger):
    """Numbers attempts as the ledger of records does, and keeps their figures until taken.

    Attributes:
        heard: the instant of the sample that came last.
        beside: by the judge of attempts, the one that measures them.
        vanished: attempts in doubt that were met and leave no record, up to their figures.
    """

    def __init__(self) -> None:
        super().__init__()
        self.heard = -TIME_LIMIT
        self.beside: WeakKeyDictionary[AttemptJudge, MarginJudge] = WeakKeyDictionary()
        self.vanished: set[Open] = set()
        self._found: list[tuple[MarginJudge, Open | None, int, Robustness]] = []
        self._ends: dict[AttemptJudge, Mapping[int, Robustness]] = {}

    def sure(self, judge: AttemptJudge, attempt: Open, t: int) -> None:
        """See `Ledger`; what was in doubt before is measured already."""
        super().sure(judge, attempt, t)
        if t == attempt.triggered:
            self._measure(judge, attempt)

    def doubtful(self, judge: AttemptJudge, attempt: Open, t: int) -> None:
        """See `Ledger`."""
        super().doubtful(judge, attempt, t)
        self._measure(judge, attempt)

    def _measure(self, judge: AttemptJudge, attempt: Open) -> None:
        sampled = judge.flow.gap is None
        self.beside[judge].measure(attempt, judge.flow.position if sampled else attempt.triggered)

    def decided(self, _: AttemptJudge, attempt: Open, verdict: bool, __: int, ___: Token) -> None:
        """See `rvmon.monitor.attempts.attempt_judge.Clerk`; there are no records."""
        if not attempt.sure and verdict and not attempt.void:
            self.vanished.add(attempt)

    def settled(self, judge: MarginJudge, attempt: Open, found: Robustness) -> None:
        """See `rvmon.monitor.robustness.margin_judge.Gauger`."""
        self._found.append((judge, attempt, attempt.triggered, found))

    def passed(self, judge: MarginJudge, t: int, found: Robustness) -> None:
        """See `rvmon.monitor.robustness.margin_judge.Gauger`."""
        self._found.append((judge, None, t, found))

    def ended(self, judge: AttemptJudge, attempt: Open, end: int, reached: int) -> None:
        """See `Ledger`; each attempt is seen by its own judge first."""
        if isinstance(judge, MarginJudge):
            if judge not in self._ends:
                self._ends[judge] = judge.figures(end, reached)
            self.settled(judge, attempt, self._ends[judge][judge.positions[attempt]])
        elif not attempt.sure:
            verdict, _ = verdict_at_end(judge, attempt, end, reached)
            if verdict is Verdict.PASS:
                self.vanished.add(attempt)

    @property
    def waiting(self) -> Sequence[Measured]:
        """The figures of attempts of which it is not known what becomes of them."""
        return [_measured(judge, attempt, found, t) for judge, attempt, t, found in self._found]

    def taken(self, *, over: bool) -> Sequence[Measured]:
        """What was found since the last time; all attempts are numbered.

        Args:
            over: whether the run is; before, those in doubt may still vanish or become sure.
        """
        if not self._found:
            return []
        found, self._found = self._found, []
        settled = []
        for one in sorted(found, key=lambda one: (one[2], one[0].compiled.rank, one[1] is None)):
            attempt = one[1]
            if attempt in self.vanished:
                self.vanished.discard(attempt)
            elif attempt is None or attempt.sure or over:
                settled.append(_measured(one[0], attempt, one[3], one[2]))
            else:
                self._found.append(one)
        return settled


def _measured(judge: MarginJudge, attempt: Open | None, found: Robustness, t: int) -> Measured:
    name = judge.compiled.requirement.id
    if attempt is None:
        return Measured(name, None, t, found)
    if attempt.sure:
        return Measured(name, attempt.number, t, found)
    # Where nothing triggered it, nothing is owed.
    possible = Robustness(found.low, INFINITE, found.kept)
    return Measured(name, attempt.doubtful_number, t, possible, in_doubt=True)
