"""What runs do with requirements: triggered, passed, what decided, deadlines, automata."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

from rvmon.coverage.hits import Hit
from rvmon.coverage.model import Group, Item, Subject, group_of
from rvmon.coverage.traced import TracedJudge, TracedMachine, TracedRule
from rvmon.coverage.variants import Variant, variants_of
from rvmon.explain.graph import Graph, graph_of
from rvmon.monitor.attempts.attempt_judge import AttemptJudge
from rvmon.monitor.attempts.judges import judge_of
from rvmon.monitor.attempts.machine_judge import MachineJudge
from rvmon.monitor.build import build_monitor
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.online.evaluators import Evaluators
from rvmon.monitor.online.forms import Forms, forms_of
from rvmon.monitor.online.generated import GeneratedEvaluators, GeneratedMonitor
from rvmon.monitor.online.monitor import Monitor
from rvmon.spec.checked.formula import Binary, BinaryOp, Formula, Unary, UnaryOp
from rvmon.spec.checked.goals import BinKind
from rvmon.spec.checked.specification import CheckedSpec, Requirement
from rvmon.verdict.attempt import Attempt
from rvmon.verdict.cover_goals import goals_as_requirements
from rvmon.verdict.report import Report
from rvmon.verdict.verdict import Verdict

SHOWN = "shown"
"""The only item of a cover goal."""

TRIGGERED, PASSED = "triggered", "passed"
JUST_BEFORE, AT, AFTER = "just before the deadline", "at the deadline", "after the deadline"

FAILURE = "F"
"""The location of an automaton in which an attempt has failed."""

TENTH = 10
"""Just before a deadline is within this part of its time."""

MOST_LOCATIONS = 50
"""Larger automata are not shown: nobody would look at what of them was seen."""


def _item(name: str, *, by_failure: bool = False) -> Item:
    """An item; no run should show what only a failure does, so that has no goal."""
    fails = by_failure or name in (AFTER, FAILURE) or name.endswith(edge_name(("", FAILURE)))
    return Item(name, BinKind.IGNORE if fails else BinKind.GOAL)


def locations_of(name: str) -> str:
    """The group of the locations of a requirement's automaton; no name holds a backtick."""
    return f"`{name}` locations"


def edges_of(name: str) -> str:
    """The group of its edges."""
    return f"`{name}` edges"


def decides(part: str) -> str:
    """The item of a part that decided: without it, verdicts or their instants would be others."""
    return f"`{part}` decides"


def edge_name(step: tuple[str, str]) -> str:
    """The item of a step from one location of an automaton to another."""
    return " → ".join(step)


def _steps(graph: Graph) -> Iterator[tuple[str, str]]:
    """The steps of an automaton; to stay is none, as it is not looked at each time."""
    return ((one.source, one.target) for one in graph.edges if one.source != one.target)


class WatchedRequirement:
    """A requirement and what may be seen of it."""

    def __init__(self, compiled: CompiledRequirement) -> None:
        self.compiled = compiled
        self.requirement = compiled.requirement
        self.variants: Sequence[Variant] = variants_of(self.requirement)
        self.deadline = deadline_of(self.requirement.consequent)

    @cached_property
    def graph(self) -> Graph | None:
        """Its automaton as people see it; `None` if it has none, or a large one."""
        automaton = self.compiled.automaton
        if automaton is None or len(automaton.locations) > MOST_LOCATIONS:
            return None
        return graph_of(self.compiled, automaton, self.compiled.spec)

    @property
    def groups(self) -> Iterator[Group]:
        """What may be hit."""
        name = self.requirement.id
        items = [_item(TRIGGERED), _item(PASSED)]
        items += [_item(decides(one.part), by_failure=one.by_failure) for one in self.variants]
        if self.deadline is not None:
            items += map(_item, (JUST_BEFORE, AT, AFTER))
        yield group_of(name, Subject.REQUIREMENT, items)
        if self.graph is not None:
            edges = dict.fromkeys(map(edge_name, _steps(self.graph)))
            # What is owed for ever is met by the end of the run alone: no edge leads to `P`.
            entered = {self.graph.places[0].name, *(one.target for one in self.graph.edges)}
            places = [place.name for place in self.graph.places if place.name in entered]
            yield group_of(locations_of(name), Subject.STATES, [*map(_item, places)])
            yield group_of(edges_of(name), Subject.TRANSITIONS, [*map(_item, edges)])


def deadline_of(owed: Formula) -> int | None:
    """The ticks within which something has to come, if that is all that is owed."""
    match owed:
        case Unary(op=UnaryOp.EVENTUALLY, interval=interval):
            return None if interval is None else interval.high
        case Binary(op=BinaryOp.UNTIL, interval=interval):
            return None if interval is None else interval.high
        case _:
            return None


class WatchedRequirements:
    """The requirements and cover goals of a specification, ready to be watched on any runs.

    Attributes:
        groups: what may be hit.
    """

    def __init__(self, spec: CheckedSpec) -> None:
        plain = replace(spec, properties={}, covers={})
        self._goals = goals_as_requirements(spec).requirements
        self._own = CompiledSpec(plain)
        self._watched = {
            name: WatchedRequirement(one) for name, one in self._own.requirements.items()
        }
        self._variants = {
            # No requirement, and no goal, has a backtick in its name.
            f"`{name}` {number}": (name, variant)
            for name, watched in self._watched.items()
            for number, variant in enumerate(watched.variants, start=1)
        }
        others: dict[str, Requirement] = {
            key: replace(variant.requirement, id=key)
            for key, (_, variant) in self._variants.items()
        }
        self._others = CompiledSpec(replace(plain, requirements={**others, **self._goals}))
        self.groups = [group for one in self._watched.values() for group in one.groups]
        self.groups += [group_of(name, Subject.GOAL, [Item(SHOWN)]) for name in self._goals]

    def runs(self, settle: str, sources: frozenset[str] | None) -> tuple[RequirementRun, Monitor]:
        """What watches one run: the requirements, and beside them what else is judged."""
        others = build_monitor(self._others, settle=settle, sources=sources)
        return RequirementRun(self._own, settle, sources), others

    def hits(
        self, run: RequirementRun, reports: Sequence[Report]
    ) -> Iterator[tuple[str, Mapping[str, Hit]]]:
        """What a run that is over has hit, by group."""
        attempts: dict[str, list[Attempt]] = {}
        for attempt in (attempt for report in reports for attempt in report.attempts):
            if not attempt.in_doubt:
                attempts.setdefault(attempt.requirement, []).append(attempt)
        for name, watched in self._watched.items():
            own = attempts.get(name, [])
            found = dict(_of_attempts(own, watched.deadline))
            for key, (of, variant) in self._variants.items():
                if of == name:
                    found |= _hit(decides(variant.part), _apart(own, attempts.get(key, [])))
            yield name, found
            if watched.graph is not None:
                yield from _passages(watched.graph, name, run.passages(name))
        for name in self._goals:
            shown = [one for one in attempts.get(name, []) if one.verdict is Verdict.PASS]
            yield name, dict(_hit(SHOWN, [_instant(one) for one in shown]))


class RequirementRun(GeneratedMonitor):
    """Judges as every monitor does, and notes what automata do."""

    def __init__(self, compiled: CompiledSpec, settle: str, sources: frozenset[str] | None) -> None:
        requirements = tuple(compiled.requirements.values())
        key = (sources, TracedRule)
        if key not in compiled.forms:
            compiled.forms[key] = forms_of(compiled, requirements, sources, TracedRule)
        forms = compiled.forms[key]
        assert isinstance(forms, Forms)  # noqa: S101 - it is what was put there
        self._machines = {
            one.requirement.id: TracedMachine(one.automaton)
            for one in requirements
            if one.automaton is not None
        }
        machines = [
            None if machine is None else self._machines[one.requirement.id]
            for one, machine in zip(forms.requirements, forms.machines, strict=False)
        ]
        machines += [None] * (len(forms.machines) - len(machines))
        traced = replace(forms, machines=machines)
        super().__init__(traced, compiled, requirements, "auto", settle, sources, None)

    def _begin(self) -> None:
        for machine in self._machines.values():
            machine.passages.clear()
        super()._begin()

    def _make_evaluators(self) -> Evaluators:
        self._unit_evaluators = _TracedEvaluators(
            self._machines,
            self._forms,
            self._unit,
            self.options.compiled,
            self.options.engine,
            self.options.sources,
            self._ledger,
            self._take,
        )
        return self._unit_evaluators

    def passages(self, name: str) -> Mapping[tuple[int, int], Hit]:
        """From which location of its automaton to which attempts of a requirement went."""
        machine = self._machines.get(name)
        return {} if machine is None else dict(machine.passages)


class _TracedEvaluators(GeneratedEvaluators):
    """Evaluators whose automata note what they do, with `let` and `for each` as well."""

    def __init__(self, machines: Mapping[str, TracedMachine], *arguments: Any) -> None:
        self._traced = machines
        super().__init__(*arguments)

    def judge_of(
        self, compiled: CompiledRequirement, engine: str, *arguments: Any, **kind: Any
    ) -> AttemptJudge:
        """See `rvmon.monitor.attempts.judges.judge_of`."""
        judge = judge_of(compiled, engine, *arguments, **kind)
        if not isinstance(judge, MachineJudge):
            return judge
        return TracedJudge(compiled, self._traced[compiled.requirement.id], *arguments, **kind)


def _instant(attempt: Attempt) -> int:
    return attempt.triggered if attempt.decided is None else attempt.decided


def _hit(item: str, instants: Sequence[int]) -> dict[str, Hit]:
    """An item that was hit at some instants; none: nothing."""
    return {item: Hit(len(instants), min(instants))} if instants else {}


def _of_attempts(attempts: Sequence[Attempt], deadline: int | None) -> Iterator[tuple[str, Hit]]:
    """What the attempts of a requirement alone say."""
    yield from _hit(TRIGGERED, [one.triggered for one in attempts]).items()
    passed = [one for one in attempts if one.verdict is Verdict.PASS]
    yield from _hit(PASSED, [_instant(one) for one in passed]).items()
    if deadline is None:
        return
    waited = [
        (one.decided, deadline - (one.decided - one.triggered))
        for one in passed
        if one.decided is not None
    ]
    near = [at for at, left in waited if 0 < left <= deadline / TENTH]
    yield from _hit(JUST_BEFORE, near).items()
    yield from _hit(AT, [at for at, left in waited if left == 0]).items()
    failed = [one for one in attempts if one.verdict is Verdict.FAIL]
    late = [_instant(one) for one in failed if _instant(one) - one.triggered > deadline]
    yield from _hit(AFTER, late).items()


def _apart(own: Iterable[Attempt], others: Iterable[Attempt]) -> list[int]:
    """The instants of attempts that only one of two requirements has, or decides otherwise."""
    first, second = (
        {(one.triggered, one.decided, one.verdict): _instant(one) for one in some}
        for some in (own, others)
    )
    return [
        at
        for here, there in ((first, second), (second, first))
        for key, at in here.items()
        if key not in there
    ]


def _passages(
    graph: Graph, name: str, passages: Mapping[tuple[int, int], Hit]
) -> Iterator[tuple[str, Mapping[str, Hit]]]:
    """The locations and edges of an automaton that were seen."""
    names = {place.location: place.name for place in graph.places}
    drawn = frozenset(_steps(graph))
    locations: dict[str, Hit] = {}
    edges: dict[str, Hit] = {}
    for (source, target), hit in passages.items():
        step = names[source], names[target]
        if step in drawn:
            edges[edge_name(step)] = hit
        for place in dict.fromkeys(step):
            known = locations.get(place)
            first = min(one.first or 0 for one in (hit, known or hit))
            locations[place] = Hit(hit.count + (known.count if known else 0), first)
    yield locations_of(name), locations
    yield edges_of(name), edges
