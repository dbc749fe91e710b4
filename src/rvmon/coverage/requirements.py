"""What runs do with requirements: triggered, passed, what decided, deadlines, automata."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from struct import iter_unpack
from typing import NamedTuple

import numpy as np

from rvmon import native
from rvmon.analysis.graph import Graph, graph_of
from rvmon.coverage import Group, Hit, Item, Subject, group_of
from rvmon.coverage.variants import Variant, variants_of
from rvmon.monitor.compile import CompiledRequirement
from rvmon.monitor.compiled_spec import CompiledSpec
from rvmon.monitor.planned import DECISIONS, VERDICTS, PlannedCore, planned_core
from rvmon.monitor.records import RECORD
from rvmon.spec.checked.formula import Binary, BinaryOp, Bound, BoundAtom, Formula, Unary, UnaryOp
from rvmon.spec.checked.goals import BinKind
from rvmon.spec.checked.specification import CheckedSpec, Mode, Requirement
from rvmon.verdict import Verdict
from rvmon.verdict.attempt import Decision
from rvmon.verdict.report import Report

Passages = Mapping[tuple[int, int], Hit]
"""From a location of an automaton to one; from the first to itself: attempts began."""

_OPEN = DECISIONS.index(Decision.OPEN)


class Judged(NamedTuple):
    """An attempt of which there surely was a trigger.

    Attributes:
        triggered: ticks.
        decided: the same; `None` if it was not.
        verdict: that it got.
    """

    triggered: int
    decided: int | None
    verdict: Verdict


def attempts_of(ids: Sequence[str], run: native.Monitor) -> dict[str, list[Judged]]:
    """The attempts of each requirement, but those in doubt."""
    found: dict[str, list[Judged]] = {name: [] for name in ids}
    records = np.frombuffer(run.records()[0], RECORD)
    records = records[records["in_doubt"] == 0]
    columns = ("requirement", "triggered", "decided", "verdict", "decision")
    for number, triggered, decided, verdict, decision in zip(
        *(records[column].tolist() for column in columns), strict=True
    ):
        at = None if decision == _OPEN else decided
        found[ids[number]].append(Judged(triggered, at, VERDICTS[verdict]))
    return found


def passages_of(ids: Sequence[str], run: native.Monitor) -> dict[str, Passages]:
    """Where attempts of each requirement went in its automaton; as `attempts_of`."""
    found: dict[str, Passages] = {}
    for number, name in enumerate(ids):
        locations, counted = run.passages(number)
        found[name] = {
            divmod(place, locations): Hit(count, first)
            for place, (count, first) in enumerate(iter_unpack("=qq", counted))
            if count
        }
    return found


def goals_as_requirements(spec: CheckedSpec) -> CheckedSpec:
    """A specification whose requirements are the cover goals of another, for samples in order."""
    requirements = {
        name: Requirement(name, Mode.UPON, BoundAtom(Bound.START), cover.formula, span=cover.span)
        for name, cover in spec.covers.items()
    }
    return replace(spec, requirements=requirements, properties={}, covers={}, max_delay=None)


def goal_verdicts(report: Report) -> Mapping[str, Verdict]:
    """What a run says of each goal: `P` shown, `I` still possible at its end, else `NT`.

    No single run fails a goal.
    """
    verdicts = dict.fromkeys(report.verdicts, Verdict.NOT_TRIGGERED)
    for attempt in report.attempts:
        if attempt.verdict is Verdict.PASS:
            verdicts[attempt.requirement] = Verdict.PASS
        elif attempt.verdict is Verdict.INCONCLUSIVE and attempt.forecast is not Verdict.FAIL:
            verdicts[attempt.requirement] = Verdict.INCONCLUSIVE
    return verdicts


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


def _item(name: str, text: str = "", *, by_failure: bool = False) -> Item:
    """An item; no run should show what only a failure does, so that has no goal."""
    fails = by_failure or name in (AFTER, FAILURE) or name.endswith(edge_name(("", FAILURE)))
    return Item(name, BinKind.IGNORE if fails else BinKind.GOAL, text=text)


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
        title = self.requirement.text
        yield group_of(name, Subject.REQUIREMENT, items, title=title)
        if self.graph is not None:
            edges: dict[str, list[str]] = {}
            for one in self.graph.edges:
                if one.source != one.target:
                    upon = " at ".join(part for part in (one.condition, one.when) if part)
                    edges.setdefault(edge_name((one.source, one.target)), []).append(upon)
            # What is required for ever is met by the end of the run alone: no edge leads to `P`.
            entered = {self.graph.places[0].name, *(one.target for one in self.graph.edges)}
            required = [
                _item(one.name, one.required) for one in self.graph.places if one.name in entered
            ]
            yield group_of(locations_of(name), Subject.STATES, required, title=title)
            steps = [_item(step, "; or ".join(upon)) for step, upon in edges.items()]
            yield group_of(edges_of(name), Subject.TRANSITIONS, steps, title=title)


def deadline_of(required: Formula) -> int | None:
    """The ticks within which something has to come, if that is all that is required."""
    match required:
        case Unary(op=UnaryOp.EVENTUALLY, interval=interval):
            return None if interval is None else interval.high
        case Binary(op=BinaryOp.UNTIL, interval=interval):
            return None if interval is None else interval.high
        case _:
            return None


class WatchedRequirements:
    """The requirements and cover goals of a specification, ready to be watched on any runs."""

    def __init__(self, spec: CheckedSpec) -> None:
        plain = replace(spec, properties={}, covers={})
        self._goals = goals_as_requirements(spec).requirements
        self._own = CompiledSpec(plain, is_kept=True)
        self._watched = {
            name: WatchedRequirement(one) for name, one in self._own.requirements.items()
        }
        self._variants = {
            # No requirement, and no goal, has a backtick in its name.
            name: {f"`{name}` {number}": one for number, one in enumerate(watched.variants, 1)}
            for name, watched in self._watched.items()
        }
        others: dict[str, Requirement] = {
            key: replace(variant.requirement, id=key)
            for variants in self._variants.values()
            for key, variant in variants.items()
        }
        self._others = CompiledSpec(
            replace(plain, requirements={**others, **self._goals}), is_kept=True
        )
        self.groups = [group for one in self._watched.values() for group in one.groups]
        self.groups += [group_of(name, Subject.GOAL, [Item(SHOWN)]) for name in self._goals]

    @cached_property
    def planned(self) -> Mapping[CompiledSpec, PlannedCore]:
        """What the core judges by: the requirements, and beside them what else is judged."""
        traced = {name for name, one in self._watched.items() if one.graph is not None}
        specs = [one for one in (self._own, self._others) if one.checked.requirements]
        return {one: planned_core(one, traced=traced) for one in specs}

    def hits(self, runs: Sequence[native.Monitor]) -> Iterator[tuple[str, Mapping[str, Hit]]]:
        """What was hit, by group."""
        attempts: dict[str, list[Judged]] = {}
        passages: dict[str, Passages] = {}
        for compiled, run in zip(self.planned, runs, strict=True):
            ids = tuple(compiled.checked.requirements)
            attempts |= attempts_of(ids, run)
            passages |= passages_of(ids, run)
        for name, watched in self._watched.items():
            own = attempts[name]
            found = dict(_of_attempts(own, watched.deadline))
            for key, variant in self._variants[name].items():
                found |= _hit(decides(variant.part), _apart(own, attempts[key]))
            yield name, found
            if watched.graph is not None:
                yield from _passages(watched.graph, name, passages[name])
        for name in self._goals:
            shown = [one for one in attempts[name] if one.verdict is Verdict.PASS]
            yield name, dict(_hit(SHOWN, map(_instant, shown)))


def _instant(attempt: Judged) -> int:
    return attempt.triggered if attempt.decided is None else attempt.decided


def _hit(item: str, instants: Iterable[int]) -> dict[str, Hit]:
    """An item that was hit at some instants; none: nothing."""
    found = [*instants]
    return {item: Hit(len(found), min(found))} if found else {}


def _of_attempts(attempts: Sequence[Judged], deadline: int | None) -> Iterator[tuple[str, Hit]]:
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


def _apart(own: Iterable[Judged], others: Iterable[Judged]) -> list[int]:
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
    graph: Graph, name: str, passages: Passages
) -> Iterator[tuple[str, Mapping[str, Hit]]]:
    """The locations and edges of an automaton that were seen.

    An attempt that leaves a location was there, known as it may not have been when it came.
    """
    names = {place.location: place.name for place in graph.places}
    drawn = frozenset(_steps(graph))
    came: dict[str, Hit] = {}
    left: dict[str, Hit] = {}
    edges: dict[str, Hit] = {}
    for (source, target), hit in passages.items():
        step = names[source], names[target]
        if step in drawn:
            edges[edge_name(step)] = hit
        _add(came, step[1], hit)
        if source != target:
            _add(left, step[0], hit)
    locations = {
        place: Hit(max(one.count for one in hits), min(one.first or 0 for one in hits))
        for place in (came | left)
        if (hits := [own[place] for own in (came, left) if place in own])
    }
    yield locations_of(name), locations
    yield edges_of(name), edges


def _add(found: dict[str, Hit], name: str, hit: Hit) -> None:
    known = found.get(name)
    if known is not None:
        hit = Hit(hit.count + known.count, min(hit.first or 0, known.first or 0))
    found[name] = hit
