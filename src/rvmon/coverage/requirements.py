"""Coverage of requirements: triggers, passes, decisive operands, deadlines, automata."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from struct import iter_unpack
from typing import NamedTuple

import numpy as np
from msgspec import structs

from rvmon import native
from rvmon.analysis.graph import Graph, graph_of
from rvmon.coverage import Group, Hit, Item, Subject, group_of
from rvmon.coverage.decisive_operands import Variant, variants_of
from rvmon.language.checked import formula as rv
from rvmon.language.checked.properties import BinKind
from rvmon.language.checked.specification import CheckedSpec, Mode, Requirement
from rvmon.monitor.compile import CompiledRequirement
from rvmon.monitor.compiled_spec import CompiledSpec
from rvmon.monitor.packed_plan import PlannedCore, planned_core
from rvmon.monitor.records import RECORD
from rvmon.verdicts import Verdict
from rvmon.verdicts.attempt import DECISIONS, VERDICTS, Decision
from rvmon.verdicts.report import Report

Passages = Mapping[tuple[int, int], Hit]
"""Passages of attempts, by source and target location of an automaton. A passage from the initial
location to itself is an attempt that began."""

_OPEN = DECISIONS.index(Decision.OPEN)


class Judged(NamedTuple):
    """An attempt that is not in doubt: instants in ticks (`decided` may be `None`) and verdict."""

    triggered: int
    decided: int | None
    verdict: Verdict


def attempts_of(ids: Sequence[str], run: native.Monitor) -> dict[str, list[Judged]]:
    """The attempts of each requirement, by its id, except those in doubt."""
    attempts: dict[str, list[Judged]] = {name: [] for name in ids}
    records = np.frombuffer(run.records()[0], RECORD)
    records = records[records["in_doubt"] == 0]
    columns = ("requirement", "triggered", "decided", "verdict", "decision")
    for number, triggered, decided, verdict, decision in zip(
        *(records[column].tolist() for column in columns), strict=True
    ):
        at = None if decision == _OPEN else decided
        attempts[ids[number]].append(Judged(triggered, at, VERDICTS[verdict]))
    return attempts


def passages_of(ids: Sequence[str], run: native.Monitor) -> dict[str, Passages]:
    """The passages of attempts through the automaton of each requirement, by its id."""
    passages: dict[str, Passages] = {}
    for number, name in enumerate(ids):
        locations, counted = run.passages(number)
        passages[name] = {
            divmod(place, locations): Hit(count, first)
            for place, (count, first) in enumerate(iter_unpack("=qq", counted))
            if count
        }
    return passages


def goals_as_requirements(spec: CheckedSpec) -> CheckedSpec:
    """A specification whose requirements are the cover goals of another, for samples in order."""
    requirements = {
        name: Requirement(
            name, Mode.UPON, rv.BoundAtom(rv.Bound.START), cover.formula, span=cover.span
        )
        for name, cover in spec.covers.items()
    }
    return structs.replace(
        spec, requirements=requirements, properties={}, covers={}, max_delay=None
    )


def goal_verdicts(report: Report) -> Mapping[str, Verdict]:
    """The verdict on each cover goal: `P` if the run shows it, `I` if it still might, else `NT`.

    No single run fails a goal.
    """
    verdicts = dict.fromkeys(report.verdicts, Verdict.NOT_TRIGGERED)
    for attempt in report.attempts:
        if attempt.verdict is Verdict.PASS:
            verdicts[attempt.requirement] = Verdict.PASS
        elif attempt.verdict is Verdict.INCONCLUSIVE and attempt.forecast is not Verdict.FAIL:
            verdicts[attempt.requirement] = Verdict.INCONCLUSIVE
    return verdicts


SHOWN = "shown"  # the only item of a cover goal

TRIGGERED, PASSED = "triggered", "passed"
JUST_BEFORE, AT, AFTER = "just before the deadline", "at the deadline", "after the deadline"

FAILURE = "F"  # the location of an automaton in which an attempt has failed
TENTH = 10  # a response within 1/TENTH of the time before its deadline counts as just before it
MOST_LOCATIONS = 50  # the size of the largest automata that become coverage groups


def _item(name: str, text: str = "", *, by_failure: bool = False) -> Item:
    """An item; it is not a goal if only a failing run can hit it."""
    fails = by_failure or name in (AFTER, FAILURE) or name.endswith(edge_name(("", FAILURE)))
    return Item(name, BinKind.IGNORE if fails else BinKind.GOAL, text=text)


def locations_of(name: str) -> str:
    """The name of the group of an automaton's locations; no requirement's id has a backtick."""
    return f"`{name}` locations"


def edges_of(name: str) -> str:
    """The name of the group of an automaton's edges."""
    return f"`{name}` edges"


def decides(part: str) -> str:
    """The name of the item for a decisive operand, without which an attempt ends differently."""
    return f"`{part}` decides"


def edge_name(step: tuple[str, str]) -> str:
    """The name of the item for an edge, given its source and target."""
    return " → ".join(step)


class WatchedRequirement:
    """A requirement with its coverage items."""

    def __init__(self, compiled: CompiledRequirement) -> None:
        self.compiled = compiled
        self.requirement = compiled.requirement
        self.variants: Sequence[Variant] = variants_of(self.requirement)
        self.deadline = deadline_of(self.requirement.consequent)

    @cached_property
    def graph(self) -> Graph | None:
        """The graph of its automaton; `None` if it has none, or it is too large."""
        automaton = self.compiled.automaton
        if automaton is None or len(automaton.locations) > MOST_LOCATIONS:
            return None
        return graph_of(self.compiled, automaton, self.compiled.spec)

    @property
    def groups(self) -> Iterator[Group]:
        """Its coverage groups: itself, and the locations and edges of its automaton."""
        name = self.requirement.id
        items = [_item(TRIGGERED), _item(PASSED)]
        items += [_item(decides(one.part), by_failure=one.by_failure) for one in self.variants]
        if self.deadline is not None:
            items += map(_item, (JUST_BEFORE, AT, AFTER))
        title = self.requirement.text
        yield group_of(name, Subject.REQUIREMENT, items, title=title)
        if self.graph is not None:
            edges: dict[str, list[str]] = {}
            for edge in self.graph.edges:
                # A waiting attempt takes a loop at each letter, which is no progress to cover.
                if edge.source != edge.target:
                    upon = " at ".join(part for part in (edge.condition, edge.ages) if part)
                    edges.setdefault(edge_name((edge.source, edge.target)), []).append(upon)
            # An unbounded `always` passes only at the end of the run: no edge leads to `P`.
            entered = {self.graph.places[0].name, *(edge.target for edge in self.graph.edges)}
            required = [
                _item(place.name, place.required)
                for place in self.graph.places
                if place.name in entered
            ]
            yield group_of(locations_of(name), Subject.STATES, required, title=title)
            steps = [_item(step, "; or ".join(upon)) for step, upon in edges.items()]
            yield group_of(edges_of(name), Subject.TRANSITIONS, steps, title=title)


def deadline_of(required: rv.Formula) -> int | None:
    """The deadline in ticks of a consequent `F[0,b]` or `U[0,b]`; else `None`."""
    match required:
        case (
            rv.Unary(op=rv.UnaryOp.EVENTUALLY, interval=rv.Interval(high=high))
            | rv.Binary(op=rv.BinaryOp.UNTIL, interval=rv.Interval(high=high))
        ):
            return high
        case _:
            return None


class WatchedRequirements:
    """The requirements and cover goals of a specification, compiled for any number of runs."""

    def __init__(self, compiled: CompiledSpec) -> None:
        self._own = compiled
        self._goals = goals_as_requirements(compiled.checked).requirements
        self._watched = {
            name: WatchedRequirement(requirement)
            for name, requirement in self._own.requirements.items()
        }
        self._variants = {
            # Backticks keep the ids of variants distinct from those of requirements and goals.
            name: {
                f"`{name}` {number}": variant for number, variant in enumerate(watched.variants, 1)
            }
            for name, watched in self._watched.items()
        }
        others: dict[str, Requirement] = {
            key: replace(variant.requirement, id=key)
            for variants in self._variants.values()
            for key, variant in variants.items()
        }
        self._others = CompiledSpec(
            structs.replace(
                compiled.checked,
                requirements={**others, **self._goals},
                properties={},
                covers={},
            ),
            is_kept=compiled.is_kept,
            origin=compiled,
        )
        self.groups = [group for one in self._watched.values() for group in one.groups]
        self.groups += [group_of(name, Subject.GOAL, [Item(SHOWN)]) for name in self._goals]

    @cached_property
    def planned(self) -> Mapping[CompiledSpec, PlannedCore]:
        """The plans of the runs: one of the requirements, one of variants and cover goals."""
        traced = {name for name, one in self._watched.items() if one.graph is not None}
        specs = [spec for spec in (self._own, self._others) if spec.checked.requirements]
        return {spec: planned_core(spec, traced=traced) for spec in specs}

    def hits(self, runs: Sequence[native.Monitor]) -> Iterator[tuple[str, Mapping[str, Hit]]]:
        """The hits by group, of finished runs."""
        attempts: dict[str, list[Judged]] = {}
        passages: dict[str, Passages] = {}
        for compiled, run in zip(self.planned, runs, strict=True):
            ids = tuple(compiled.checked.requirements)
            attempts |= attempts_of(ids, run)
            passages |= passages_of(ids, run)
        for name, watched in self._watched.items():
            judged_attempts = attempts[name]
            hits = dict(_of_attempts(judged_attempts, watched.deadline))
            for key, variant in self._variants[name].items():
                hits |= _hit(decides(variant.part), _differing(judged_attempts, attempts[key]))
            yield name, hits
            if watched.graph is not None:
                yield from _passages(watched.graph, name, passages[name])
        for name in self._goals:
            shown = [judged for judged in attempts[name] if judged.verdict is Verdict.PASS]
            yield name, dict(_hit(SHOWN, map(_instant, shown)))


def _instant(attempt: Judged) -> int:
    return attempt.triggered if attempt.decided is None else attempt.decided


def _hit(item: str, instants: Iterable[int]) -> dict[str, Hit]:
    """The hits of an item at some instants; empty if there are none."""
    hit_instants = [*instants]
    return {item: Hit(len(hit_instants), min(hit_instants))} if hit_instants else {}


def _of_attempts(attempts: Sequence[Judged], deadline: int | None) -> Iterator[tuple[str, Hit]]:
    """The hits of the items on triggers, passes and deadlines."""
    yield from _hit(TRIGGERED, [attempt.triggered for attempt in attempts]).items()
    passed = [attempt for attempt in attempts if attempt.verdict is Verdict.PASS]
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
    failed = [attempt for attempt in attempts if attempt.verdict is Verdict.FAIL]
    late = [_instant(one) for one in failed if _instant(one) - one.triggered > deadline]
    yield from _hit(AFTER, late).items()


def _differing(originals: Iterable[Judged], variants: Iterable[Judged]) -> list[int]:
    """The instants of attempts that only one of two requirements has, or that they decide apart."""
    first, second = (
        {
            (judged.triggered, judged.decided, judged.verdict): _instant(judged)
            for judged in attempts
        }
        for attempts in (originals, variants)
    )
    return [
        at
        for some, others in ((first, second), (second, first))
        for key, at in some.items()
        if key not in others
    ]


def _passages(
    graph: Graph, name: str, passages: Passages
) -> Iterator[tuple[str, Mapping[str, Hit]]]:
    """The hits of the locations and edges of an automaton.

    A location counts the larger of the numbers of attempts that enter and that leave it, as an
    entry may have been unknown.
    """
    names = {place.location: place.name for place in graph.places}
    drawn = {(edge.source, edge.target) for edge in graph.edges if edge.source != edge.target}
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
        place: Hit(max(hit.count for hit in hits), min(hit.first or 0 for hit in hits))
        for place in (came | left)
        if (hits := [counted[place] for counted in (came, left) if place in counted])
    }
    yield locations_of(name), locations
    yield edges_of(name), edges


def _add(hits: dict[str, Hit], name: str, hit: Hit) -> None:
    known = hits.get(name)
    if known is not None:
        hit = Hit(hit.count + known.count, min(hit.first or 0, known.first or 0))
    hits[name] = hit
