"""Finds shortest example timelines of requirements and conflicts; runs the whole analysis.

Examples are found by best-first search over relevant samples, instants and values.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
from heapq import heappop, heappush
from itertools import count
from operator import itemgetter

from msgspec import Struct

from rvmon.analysis.conflicts import Conflict
from rvmon.analysis.example import Budget, Example, SearchResult, small_step
from rvmon.analysis.findings import Examination, examine, findings_of
from rvmon.analysis.representative_inputs import SILENT, Choices, Silence, Valuation, choices_of
from rvmon.analysis.vacuity import Subject
from rvmon.core.pack import pack
from rvmon.diagnostics import Diagnostic
from rvmon.language.checked.classify import subformulas
from rvmon.language.checked.formula import Amount, Compare, windows_in
from rvmon.language.checked.specification import CheckedSpec, Requirement, TimeModel
from rvmon.monitor.compile import CompiledRequirement
from rvmon.monitor.compiled_spec import CompiledSpec, Kept
from rvmon.monitor.packed_plan import planned_as
from rvmon.monitor.records import report_of_run
from rvmon.monitor.requirement_plans import plan_alone
from rvmon.trace.sample import Sample, Value
from rvmon.trace.time import TIME_LIMIT
from rvmon.verdicts import Verdict

NEVER = (1 << 63) - 1  # later than any instant


class Played(Struct, frozen=True):
    """A short run with its verdicts."""

    example: Example  # the run with its verdicts if it ends here
    # a key: runs with equal keys have the same future, as far as the search looks
    situation: bytes
    cut: int  # the next instant after its end at which time alone may decide something, ticks


class Player:
    """Judges short runs."""

    def __init__(self, compiled: CompiledSpec, requirements: Sequence[CompiledRequirement]) -> None:
        self._ids = tuple(
            name
            for name in compiled.requirements
            if name in {requirement.requirement.id for requirement in requirements}
        )
        plan = plan_alone(compiled, self._ids, stepped=True)
        kept = Kept(pack(plan).data)
        self._planned = planned_as(compiled.checked, self._ids, kept, compiled)
        self._run = self._planned.monitor(frozenset())

    def play(self, samples: Sequence[Sample], end: int) -> Played:
        """Judge a short run of at least one sample that ends at `end` (ticks).

        Raises:
            ValueError: the core refuses a sample.
        """
        run = self._run
        run.reset()
        for sample in samples:
            if not run.judge(sample.t, sample.values, False):
                values = self._planned.plain(sample.t, sample.values)
                if not run.judge(sample.t, values, True):
                    raise ValueError("the core refuses a sample of the search")
        situation, cut = run.situation(end)
        run.finish(end)
        report = report_of_run(self._planned, run, samples[0].t, end)
        example = Example(tuple(samples), end, report.verdicts, report.attempts)
        return Played(example, situation, NEVER if cut is None else cut)


Goal = Callable[[Example], str | None]
"""Assigns an example to one of the wanted kinds; `None` if it is of no interest."""

_FREE_WAITS = 6
"""The number of free waits after a sample; each further wait counts as a sample."""


def verdict_of(name: str) -> Goal:
    """The goal of finding an example for each verdict of a requirement."""
    return lambda example: example.verdicts[name].value


def difference_of(first: str, second: str) -> Goal:
    """The goal of finding examples on which two requirements have different verdicts.

    The kind is `hard` if one of them fails, else `soft`.
    """

    def differs(example: Example) -> str | None:
        verdicts = example.verdicts[first], example.verdicts[second]
        if verdicts[0] is verdicts[1]:
            return None
        return "hard" if Verdict.FAIL in verdicts else "soft"

    return differs


class _Node(Struct, frozen=True):
    """A run to be judged."""

    samples: tuple[Sample, ...]  # the samples so far
    end: int  # the end of the run, ticks
    held: int  # the place of the current values in `_Search.held`
    activity: int  # see `_activity`; quieter runs come first
    at_cut: bool = False  # whether it waits at its end, after the last sample
    waits: int = 0  # the number of waits since the last sample

    @property
    def effort(self) -> int:
        """The number of samples, plus waits beyond a few: else endless waiting would come first."""
        return len(self.samples) + max(0, self.waits - _FREE_WAITS)


def shortest_examples(
    compiled: CompiledSpec,
    requirements: Sequence[CompiledRequirement],
    goal: Goal,
    wanted: Sequence[str],
    budget: Budget | None = None,
) -> SearchResult:
    """Look for the shortest example of each kind.

    Runs are judged by the core itself, so an example is right by construction. They are tried in
    order of the number of samples, then of the end. As waiting may lead to ever new situations,
    each wait beyond a few counts as a sample. A sample has one of the valuations that the formulas
    distinguish. It comes a short step after the last one, or within a tick of an instant at which
    a window opens or closes.

    Cost: about 25 microseconds per run.
    """
    budget = budget or Budget()
    search = _Search(compiled.checked, requirements, budget)
    player = Player(compiled, requirements)
    missing = set(wanted)
    examples: dict[str, Example] = {}
    seen: set[tuple[bytes, bool]] = set()
    heap: list[tuple[int, int, int, int, _Node, Iterator[_Node]]] = []
    number = count()
    runs = 0

    def add(nodes: Iterator[_Node], order: int) -> None:
        """Queue the next of several runs that are in order of effort, end and activity."""
        for node in nodes:
            heappush(heap, (node.effort, node.end, node.activity, order, node, nodes))
            return

    for first in search.first():
        add(iter((first,)), next(number))
    while heap and missing and runs < budget.runs:
        *_, order, node, nodes = heappop(heap)
        # The successor of a run is queued only when the run is taken, as most are never examined.
        add(nodes, order)
        played = player.play(node.samples, node.end)
        runs += 1
        kind = goal(played.example)
        if kind in missing:
            missing.discard(kind)
            examples[kind] = played.example
        if (played.situation, node.at_cut) in seen:
            continue
        seen.add((played.situation, node.at_cut))
        # If all have failed, no later sample changes a verdict.
        if all(verdict is Verdict.FAIL for verdict in played.example.verdicts.values()):
            continue
        for further in search.after(node, played.cut):
            add(further, next(number))
    return SearchResult(examples, runs, not heap and search.choices.complete)


def _activity(changes: Mapping[str, Value]) -> int:
    """The number of occurrences, and of values other than false, in a sample."""
    return sum(value is not False for value in changes.values())


class _Search:
    def __init__(
        self, spec: CheckedSpec, requirements: Sequence[CompiledRequirement], budget: Budget
    ) -> None:
        self.spec = spec
        self.choices = _choices(spec, requirements)
        self.gap = spec.period if spec.time is TimeModel.CLOCKED and spec.period else 1
        self.step = budget.step or small_step(
            spec, [requirement.requirement for requirement in requirements]
        )
        self.most = budget.samples
        self.held: list[Valuation] = []
        self._numbers: dict[str, int] = {}
        self._further = cache(self._sorted)

    def first(self) -> Iterator[_Node]:
        """The runs of one sample; signals have a value from the start."""
        defaults: dict[str, Value] = {}
        for valuation in self.choices.valuations:
            for name, value in valuation.items():
                if not isinstance(value, Silence):
                    defaults.setdefault(name, value)
        tried: set[int] = set()
        for valuation in self.choices.valuations:
            # In the first sample silent names get a default, or few valuations would remain.
            whole = {
                n: defaults[n] if v is SILENT else v for n, v in valuation.items() if n in defaults
            }
            number = self._number(whole)
            if len(whole) == len(defaults) and number not in tried:
                tried.add(number)
                changes = self._changes(whole, {})
                yield _Node((Sample(0, changes),), 0, number, _activity(changes))

    def after(self, node: _Node, cut: int) -> Iterator[Iterator[_Node]]:
        """The continuations of a run by a sample and by waiting, each kind in order."""
        end = node.end
        if len(node.samples) < self.most:
            yield self._sampled(node, end + (self.gap if node.at_cut else self.step))
        # Wait until just before and just after the instant at which a window opens or closes. If
        # that is the next position, pass it by a step.
        soon = cut - end <= self.gap and not node.at_cut
        for t in {end + self.step} if soon else {cut - 1, cut}:
            if end < t < TIME_LIMIT:
                waits = node.waits + 1
                wait = _Node(node.samples, t, node.held, node.activity, at_cut=True, waits=waits)
                yield iter((wait,))

    def _sampled(self, node: _Node, t: int) -> Iterator[_Node]:
        for activity, changes, valuation in self._further(node.held):
            given = {name: value for name, value in valuation.items() if value is not SILENT}
            number = self._number({**self.held[node.held], **given})
            yield _Node((*node.samples, Sample(t, changes)), t, number, node.activity + activity)

    def _sorted(self, place: int) -> list[tuple[int, dict[str, Value], Valuation]]:
        """The possible samples while the values at `place` are held, the fewest changes first."""
        held = self.held[place]
        brought = ((self._changes(one, held), one) for one in self.choices.valuations)
        samples = [(_activity(changes), changes, one) for changes, one in brought if changes]
        return sorted(samples, key=itemgetter(0))

    def _number(self, held: Valuation) -> int:
        number = self._numbers.setdefault(repr(sorted(held.items())), len(self.held))
        if number == len(self.held):
            self.held.append(held)
        return number

    def _changes(self, valuation: Valuation, held: Valuation) -> dict[str, Value]:
        """The contents of a sample: new values, relevant updates, occurrences."""
        changes: dict[str, Value] = {}
        for name, value in valuation.items():
            if isinstance(value, Silence):
                continue
            if name in self.spec.events:
                if value is not False:
                    changes[name] = value
            elif name in self.choices.remembered or name not in held or held[name] != value:
                changes[name] = value
        return changes


def _choices(spec: CheckedSpec, requirements: Sequence[CompiledRequirement]) -> Choices:
    leaves = {state.leaf: None for one in requirements for state, _ in one.leaves if state.leaf}
    names = {name for one in requirements for name in one.reads}
    rules = [one.requirement for one in requirements]
    names |= {one.for_each.value.event for one in rules if one.for_each}
    captured = [capture.value for one in rules for capture in one.captures]
    windows = [limit for one in rules for limit in _windows(one)]
    return choices_of(spec, list(leaves), names, captured, windows)


def _windows(requirement: Requirement) -> Iterator[Compare]:
    """The comparisons of numeric windows in a requirement."""
    for part in (*subformulas(requirement.trigger), *subformulas(requirement.consequent)):
        comparison = part.comparison if isinstance(part, Amount) else part
        if isinstance(comparison, Compare) and any(
            window.value is not None for window in windows_in(comparison.left, comparison.right)
        ):
            yield comparison


CONFLICT_RUNS = 400  # the most runs tried for the timeline of one conflict

_OPEN, _MET = "open", "met"


class Analysis(Struct, frozen=True):
    """The result of an analysis."""

    findings: tuple[Diagnostic, ...]
    examination: Examination  # the findings as data, with counts of undecided questions
    # for the first conflicts, the shortest run that triggers their requirements
    timelines: tuple[tuple[Conflict, Example], ...]


def analyse(compiled: CompiledSpec, *, seconds: float = 8.0, timelines: int = 3) -> Analysis:
    """Analyse a specification for up to `seconds`, with timelines for the first conflicts."""
    subjects = [
        Subject(one.requirement, one.obligation.trigger, one.automaton, one.reads)
        for one in compiled.requirements.values()
    ]
    examination = examine(compiled.checked, subjects, seconds)
    drawn = tuple(
        (conflict, example)
        for conflict in examination.conflicts[:timelines]
        if (example := conflict_example(compiled, conflict)) is not None
    )
    return Analysis(tuple(findings_of(compiled.checked, examination)), examination, drawn)


def conflict_example(compiled: CompiledSpec, conflict: Conflict) -> Example | None:
    """The shortest run found that triggers the requirements of a conflict at its offsets.

    A run on which none has failed yet is preferred.
    """
    chosen = [compiled.requirements[name] for name in dict.fromkeys(conflict.ids)]
    goal = _triggered_as(conflict.ids, conflict.offsets)
    step = min((offset for offset in conflict.offsets if offset), default=0)
    budget = Budget(runs=CONFLICT_RUNS, samples=3, step=step)
    examples = shortest_examples(compiled, chosen, goal, [_OPEN, _MET], budget).examples
    return examples.get(_OPEN) or examples.get(_MET)


def _triggered_as(ids: Sequence[str], offsets: Sequence[int]) -> Goal:
    def goal(example: Example) -> str | None:
        triggers = {
            name: {a.triggered for a in example.attempts if a.requirement == name} for name in ids
        }
        for first in triggers[ids[0]]:
            pairs = zip(ids, offsets, strict=True)
            if all(first + offset in triggers[name] for name, offset in pairs):
                return _MET if Verdict.FAIL in example.verdicts.values() else _OPEN
        return None

    return goal
