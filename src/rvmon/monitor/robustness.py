"""The robustness of attempts, found beside their verdicts, which it never touches.

The whole trace is looked at: what comes behind a decision counts as long as the window is open.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from rvmon.automaton.location import PASSED
from rvmon.automaton.machine import INFINITY, Token
from rvmon.dataflow.flow import Flow
from rvmon.dataflow.leaves import reads
from rvmon.dataflow.margins import OF_TRUTH, Margin, margin_reader
from rvmon.dataflow.plan import plan_of
from rvmon.dataflow.positions import Positions
from rvmon.dataflow.robust import Horizon, Rest, robustness
from rvmon.dataflow.steps import Steps, of_changes, value_at
from rvmon.formula.core import Constant, Literal, Sense
from rvmon.formula.expand import expanded
from rvmon.formula.state import FALSE, TRUE
from rvmon.monitor.bench import Bench, Clerk, Open
from rvmon.monitor.compiled import CompiledRequirement, CompiledSpec
from rvmon.monitor.lanes import Lanes
from rvmon.monitor.ledger import Ledger
from rvmon.monitor.monitor import Monitor
from rvmon.spec.checked import CheckedSpec
from rvmon.trace.sample import Sample, Scalar
from rvmon.verdict.attempt import Attempt, Decision
from rvmon.verdict.verdict import Verdict


@dataclass(frozen=True, slots=True)
class Robustness:
    """How far a formula is from the other truth value, in base units.

    Attributes:
        low: the least that it can be, whatever is not known and whatever had come after the end.
        high: the greatest.
        kept: the least, if all is well behind the end that only has to be kept up.
    """

    low: float
    high: float
    kept: float

    def of(self, attempt: Attempt) -> float | None:
        """The figure for a decided attempt: its distance from the other verdict, at least."""
        if self.low == self.high:
            return self.low
        match attempt.decision, attempt.verdict:
            case Decision.HELD_TO_END, _:
                return self.kept
            case Decision.PREFIX, Verdict.PASS:
                return self.low
            case Decision.PREFIX, Verdict.FAIL:
                return self.high
            case _:
                return None


Key = tuple[str, int]
"""Requirement and number of an attempt."""


@dataclass(frozen=True, slots=True)
class Margins:
    """The robustness of all attempts of a run.

    Attributes:
        attempts: by requirement and number.
        streams: by requirement, at the instants of samples: the robustness of what it owes there.
            Requirements with `let` or `for each` have none: it would depend on the attempt.
    """

    attempts: Mapping[Key, Robustness]
    streams: Mapping[str, Sequence[tuple[int, Robustness]]]

    def of(self, attempt: Attempt) -> Attempt:
        """An attempt with its figure."""
        found = self.attempts.get((attempt.requirement, attempt.number))
        return attempt if found is None else replace(attempt, robustness=found.of(attempt))


class MarginMonitor(Monitor):
    """Takes samples as every monitor does and gives margins in the place of verdicts."""

    def __init__(
        self,
        compiled: CompiledSpec,
        requirements: Sequence[CompiledRequirement],
        sources: frozenset[str] | None,
    ) -> None:
        super().__init__(compiled, requirements, "auto", "now", sources)

    def _make_lanes(self) -> Lanes:
        self.ledger = MarginLedger()
        return MarginLanes(
            self._compiled.checked, self._requirements, "auto", self._sources, self.ledger
        )

    def margins_ns(self, end: int | None) -> Margins:
        """End the run, at `end` ticks if that is later than all so far."""
        self.finish_ns(end)
        return self.ledger.margins(self._lanes.judges)


class MarginLanes(Lanes):
    """Lanes whose judges measure."""

    def _new_judge(self, compiled: CompiledRequirement, flow: Flow, captured: Captured) -> Bench:
        return MarginJudge(compiled, flow, self.ledger, captured, self.spec)


class MarginLedger(Ledger):
    """Numbers attempts as the ledger of records does."""

    def __init__(self) -> None:
        super().__init__()
        self._begun: list[tuple[int, int, Bench, Open]] = []
        self._found: dict[int, Robustness] = {}
        self._known: tuple[int, int] | None = None

    def started(self, instance: int, judge: Bench, attempt: Open) -> None:
        """See `Ledger`."""
        self._begun.append((attempt.triggered, instance, judge, attempt))

    def ended(self, judge: Bench, attempt: Open, end: int, reached: int) -> None:
        """See `Ledger`."""
        self._known = (end, reached)
        if isinstance(judge, MarginJudge):
            self._found[id(attempt)] = judge.measured(attempt.token[1][0], end, reached)

    def margins(self, judges: Sequence[Bench]) -> Margins:
        """What was found; all attempts have ended."""
        counts: dict[str, int] = {}
        found: dict[Key, Robustness] = {}
        for _, _, judge, attempt in sorted(self._begun, key=lambda entry: entry[:2]):
            name = judge.compiled.requirement.id
            counts[name] = counts.get(name, 0) + 1
            found[name, counts[name]] = self._found[id(attempt)]
        streams = {}
        for judge in judges:
            requirement = judge.compiled.requirement
            alone = not requirement.captures and requirement.for_each is None
            if alone and self._known is not None and isinstance(judge, MarginJudge):
                streams[requirement.id] = judge.stream(*self._known)
        return Margins(found, streams)


class MarginJudge(Bench):
    """Keeps how far all that is read was from its other truth value.

    Memory grows with the trace: an entry for every change.
    """

    def __init__(
        self,
        compiled: CompiledRequirement,
        flow: Flow,
        clerk: Clerk,
        captured: Captured,
        spec: CheckedSpec,
    ) -> None:
        super().__init__(compiled, flow, clerk, captured)
        self.restless = True
        self.plan = plan_of(expanded(compiled.obligation.owed), flow.gap)
        self.positions = Positions(flow.gap)
        self._visited: list[int] = []
        self._leaves = [self._leaf(core, spec) for _, core in self.plan.leaves]
        self._changes: list[list[tuple[int, Margin]]] = [[] for _ in self._leaves]
        self._measures: dict[Rest, Steps] = {}

    def _leaf(
        self, core: Literal | Constant, spec: CheckedSpec
    ) -> tuple[Callable[[], Margin], Margin | None]:
        """Reads a leaf; and what it is at the next position, if that is not the same."""
        if isinstance(core, Constant):
            fixed = OF_TRUTH[TRUE if core.value else FALSE]
            return (lambda: fixed), None
        flow, state = self.flow, core.proposition
        place = flow.graph.index[state]

        def truth() -> int:
            return flow.values[place]

        if core.sense is Sense.KNOWN_FALSE or state.leaf is None:
            return (lambda: OF_TRUTH[TRUE if truth() == FALSE else FALSE]), None
        read = margin_reader(state.leaf, truth, flow.inputs, self.captured, spec)
        about = reads(state.leaf)
        passes = about.momentary and not about.names & flow.inputs.absent
        later = OF_TRUTH[FALSE] if passes else None
        if core.sense is Sense.TRUE:
            return read, later
        return (lambda: _negated(read())), None if later is None else _negated(later)

    def begin(self, t: int, triggered: int) -> Open:
        """Start an attempt at the position `t`, which the flow is at."""
        if self.position < t:
            self.visit(t)
        token: Token = (PASSED + 1, (t,))
        attempt = Open(triggered, token, ())
        self.attempts.append(attempt)
        return attempt

    def visit(self, t: int) -> None:
        """Note what all leaves are at the position `t`, which the flow is at."""
        self.position = t
        position = t // self.positions.gap
        self.positions.visit(position)
        self._visited.append(t)
        for (read, later), changes in zip(self._leaves, self._changes, strict=True):
            own = read()
            while changes and changes[-1][0] >= position:
                changes.pop()
            if not changes or changes[-1][1] != own:
                changes.append((position, own))
            if later is not None and own != later:
                changes.append((position + 1, later))

    def pass_to(self, t: int) -> None:
        """Nothing is decided by time here."""

    def reach(self, t: int) -> None:
        """Nothing is decided by time here."""

    @property
    def next_due(self) -> int:
        """Nothing is decided by time here."""
        return INFINITY

    def held_at_end(self, attempt: Open, end: int, reached: int) -> bool:
        """Nothing is judged here."""
        raise NotImplementedError

    def measured(self, t: int, end: int, reached: int) -> Robustness:
        """The robustness of what is owed at the position at `t`.

        Args:
            t: an instant.
            end: the last instant of the trace.
            reached: the instant that time has come to.
        """
        if not self._measures:
            self.positions.end(end // self.positions.gap)
            known = Horizon(self.positions, end, reached)
            for rest in Rest:
                side = 1 if rest is Rest.GREATEST else 0
                leaves = [
                    of_changes([(position, margin[side]) for position, margin in changes])
                    for changes in self._changes
                ]
                self._measures[rest] = robustness(self.plan, leaves, known, rest)
        position = t // self.positions.gap
        low, high, kept = (
            value_at(self._measures[rest], position)
            for rest in (Rest.LEAST, Rest.GREATEST, Rest.END)
        )
        return Robustness(low, high, kept)

    def stream(self, end: int, reached: int) -> list[tuple[int, Robustness]]:
        """The robustness of what is owed at each position that was visited."""
        return [(t, self.measured(t, end, reached)) for t in self._visited]


Captured = Mapping[str, Scalar]


def _negated(margin: Margin) -> Margin:
    return -margin[1], -margin[0]


def margins_of(
    compiled: CompiledSpec,
    samples: Iterable[Sample],
    *,
    only: Sequence[str] | None = None,
    sources: frozenset[str] | None = None,
    end: int | None = None,
) -> Margins:
    """The robustness of all attempts on a trace.

    Args:
        compiled: the specification.
        samples: of the trace.
        only: ids of the requirements; default all.
        sources: the names that can arrive; `None`: all.
        end: the end of the trace, if it ended after its last sample.

    Cost: per node of a formula a pass over the changes of its operands.
    """
    chosen = [one for name, one in compiled.requirements.items() if only is None or name in only]
    monitor = MarginMonitor(compiled, chosen, sources)
    for sample in samples:
        monitor.step_ns(sample.t, sample.values)
    return monitor.margins_ns(end)
