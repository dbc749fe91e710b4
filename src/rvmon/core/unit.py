"""Packs requirements with captured values: attempts with `let`, instances of `for each`.

Each such attempt or instance is a run of its own, forked from the state of the run that started it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property

from rvmon.core.atoms import Atoms, Names, Programs
from rvmon.core.nodes import NodeOp, Nodes
from rvmon.core.sections import Sections
from rvmon.logic.network_plan import plan_of
from rvmon.logic.plan import Plan, PlannedRule
from rvmon.logic.state_formula import State, StateOp
from rvmon.logic.state_graph import Reach, begins_with_attempt, graph_of, reach_of, varying
from rvmon.spec.checked.formula import NowValue
from rvmon.spec.checked.specification import Mode

_REPLAYS, _FRESH, _FORGETS, _KEEPS_PAST, _CAPTURES_NOW = 1, 2, 4, 8, 16

SHARED = (0, 0, -1, 0, 0, 0, -1, -1, *([0] * 10))
"""The unit fields of a part without captured values."""


class Unit:
    """A requirement with captured values."""

    def __init__(self, plan: Plan, number: int) -> None:
        self._plan = plan
        (self._rule,) = plan.rules
        self._number = number
        self._requirement = self._rule.requirement

    def fields(
        self, sections: Sections, names: Names, programs: Programs, nodes: Nodes, atoms: Atoms
    ) -> Iterator[int]:
        """The fields of its part record in plan.h, from `captured` to `lapsed`."""
        key = names.key
        yield len(self._rule.captured)
        yield self._requirement.for_each is not None
        yield self._number
        yield self._flags
        yield from self._starters
        yield -1 if key is None else names.events[key.event]
        yield -1 if key is None else names.field(key.event, key.field)
        graph = self._plan.graph
        vary = sorted(varying(graph))
        lapsed = [place for place, node in enumerate(nodes.all) if node.op is NodeOp.LAPSED]
        lists: Sequence[Sequence[int]] = (
            [programs.place(capture.value) for capture in self._requirement.captures],
            [number for number, atom in enumerate(atoms.all) if atom.captured],
            [one for one in vary if one not in graph.stateful or self._forgets(graph.nodes[one])],
            vary,
            lapsed,
        )
        for places in lists:
            yield from sections.listed(places)

    @property
    def _flags(self) -> int:
        reach = self._reach
        replays, fresh = self._replays, self._is_fresh
        found = _REPLAYS if replays else 0
        found |= _FRESH if fresh else 0
        found |= _FORGETS if fresh and reach is not None and reach.begins else 0
        reads_now = any(isinstance(one.value, NowValue) for one in self._requirement.captures)
        found |= _CAPTURES_NOW if reads_now else 0
        return found | (_KEEPS_PAST if replays or (reach is not None and not fresh) else 0)

    def _forgets(self, state: State) -> bool:
        """Whether a stateful node carries no memory into a new attempt."""
        begins = not self._replays and begins_with_attempt(state)
        return state.op is StateOp.PASSED or begins

    @cached_property
    def _replays(self) -> bool:
        """Whether an attempt with captures depends on samples before its trigger."""
        if not self._requirement.captures:
            return False
        judged = [rule for _, rule in self._plan.judges]
        return self._looks_back or any(
            graph_of(_consequent(rule)).remembers_captured for rule in judged
        )

    @cached_property
    def _looks_back(self) -> bool:
        plan = self._plan
        asked = [one for _, rule in plan.judges for one in (rule.required, rule.measured)]
        return any(plan_of(one, plan.gap).looks_back for one in asked if one is not None)

    @cached_property
    def _reach(self) -> Reach | None:
        each = self._requirement.for_each
        if each is None:
            return None
        states = [state for _, rule in self._plan.judges for state in self._shared(rule)]
        looks_back = self._looks_back
        return reach_of(graph_of(states), each, self._rule.trigger, looks_back=looks_back)

    @property
    def _is_fresh(self) -> bool:
        """Whether a new instance can be forked from the current state of the root run.

        In clocked time the root has, between two ticks, already moved to the letter of the next
        tick, so that the previous value of a trigger, which an edge needs, is gone. That does not
        matter where attempts start independently of the previous value.
        """
        reach = self._reach
        if reach is None or not reach.is_fresh:
            return False
        no_edge = self._requirement.pulse or self._requirement.mode is Mode.WHENEVER
        return self._plan.gap in (None, 1) or (reach.begins and no_edge)

    def _shared(self, rule: PlannedRule) -> Iterator[State]:
        """The state formulas evaluated by an instance, not by its attempts."""
        if not self._requirement.captures:
            yield from rule.states
        named = (rule.trigger, rule.determined, rule.blurs)
        yield from (state for state in named if state is not None)
        yield from rule.captures_known

    @property
    def _starters(self) -> tuple[int, int]:
        """Which judges start attempts in the root run, and which in instances, as bits."""
        bits = {rule: 1 << index for index, (_, rule) in enumerate(self._plan.judges)}
        known = bits[self._rule]
        hidden, doubted = self._rule.hidden, self._rule.doubted
        if hidden is not None:
            known |= bits[hidden]
        if doubted is not None and self._requirement.mode is Mode.UPON:
            return bits[doubted], known
        return known, known


def _consequent(rule: PlannedRule) -> Iterator[State]:
    """The state formulas evaluated by an attempt."""
    yield from rule.alphabet.propositions
    yield from rule.asked
    named = [rule.again, rule.unborn]
    if rule.requirement.mode is Mode.WHENEVER:
        named += [rule.trigger, rule.running]
    yield from (state for state in named if state is not None)
