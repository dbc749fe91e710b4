"""Requirements with captured values in C: what is generated for each of their units.

Each attempt of a `let`, and each instance of a `for each`, is a monitor of its own, which begins as
that stands which it comes from.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

from rvmon.codegen.c_leaves import number_value
from rvmon.codegen.c_names import Names
from rvmon.codegen.c_nodes import groups_of, varying_source
from rvmon.codegen.c_tables import array
from rvmon.dataflow.network_plan import plan_of
from rvmon.formula.state import Lapsed, State
from rvmon.plan.graph import graph_of
from rvmon.plan.instances import Reach, reach_of, varying
from rvmon.plan.plan import Plan, PlannedRule
from rvmon.spec.checked.specification import Mode


class Unit:
    """What a requirement with captured values asks of its monitors.

    Args:
        plan: of that requirement alone.
    """

    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        (self.rule,) = plan.rules
        self.requirement = self.rule.requirement

    @property
    def sizes(self) -> dict[str, int]:
        """What the header says of it."""
        keeps_past = self.replays or (self._reach is not None and not self._is_fresh)
        return {
            "APART": len(self.rule.captured),
            "EACH": int(self.requirement.for_each is not None),
            "PAST_SAMPLES": int(keeps_past),
        }

    @property
    def replays(self) -> bool:
        """Whether a captured attempt has to look at what was before its values were."""
        if not self.requirement.captures:
            return False
        judged = [rule for _, rule in self.plan.judges]
        return self._looks_back or any(
            graph_of(_consequent(rule)).remembers_captured for rule in judged
        )

    @property
    def _looks_back(self) -> bool:
        return any(plan_of(rule.owed, self.plan.gap).looks_back for _, rule in self.plan.judges)

    @cached_property
    def _reach(self) -> Reach | None:
        each = self.requirement.for_each
        if each is None:
            return None
        states = [state for _, rule in self.plan.judges for state in self._shared(rule)]
        looks_back = self._looks_back
        return reach_of(graph_of(states), each, self.rule.trigger, looks_back=looks_back)

    @property
    def _is_fresh(self) -> bool:
        """Whether an instance can be made from what the first monitor stands at.

        Between two ticks of a clock that has gone on to what the next tick sees: what its trigger
        was at the last one, which an edge asks for, is gone. It is not asked for where attempts
        begin whatever the trigger was.
        """
        reach = self._reach
        if reach is None or not reach.is_fresh:
            return False
        no_edge = self.requirement.pulse or self.requirement.mode is Mode.WHENEVER
        return self.plan.gap in (None, 1) or (reach.begins and no_edge)

    def _shared(self, rule: PlannedRule) -> Iterator[State]:
        """The state formulas of an instance."""
        if not self.requirement.captures:
            yield from rule.states
        named = (rule.trigger, rule.determined, rule.blurs)
        yield from (state for state in named if state is not None)

    @property
    def _starters(self) -> tuple[int, int]:
        """The rules of which attempts start in the first monitor, and in instances, as bits."""
        bits = {rule: 1 << index for index, (_, rule) in enumerate(self.plan.judges)}
        known = bits[self.rule]
        hidden, doubted = self.rule.hidden, self.rule.doubted
        if hidden is not None:
            known |= bits[hidden]
        if doubted is not None and self.requirement.mode is Mode.UPON:
            return bits[doubted], known
        return known, known

    def source(self, names: Names) -> Iterator[str]:
        """Its own functions and tables.

        Args:
            names: of its plan.
        """
        graph, reach = self.plan.graph, self._reach
        vary = varying(graph)
        root, instance = self._starters
        yield f"#define ROOT_STARTERS {root}U"
        yield f"#define INSTANCE_STARTERS {instance}U"
        yield f"#define REPLAYS {int(self.replays)}"
        yield f"#define FRESH {int(self._is_fresh)}"
        yield f"#define FORGETS {int(self._is_fresh and reach is not None and reach.begins)}"
        if self.requirement.for_each is not None:
            source = self.requirement.for_each.value
            yield f"#define EACH_EVENT {names.event(source.event)}"
            yield f"#define EACH_FIELD {names.field(source.event, source.field)}"
        if self._is_fresh and reach is not None and reach.begins:
            yield array("uint8_t", "varying", [int(n in vary) for n in range(len(graph.nodes))])
        forks = bool(self.requirement.captures) and not self.replays
        if forks or self._is_fresh:
            yield from varying_source(self.plan, names, vary - set(graph.stateful))
        if self.requirement.captures:
            yield from self._capturing()

    def _capturing(self) -> Iterator[str]:
        nodes = self.plan.graph.nodes
        lapsed = groups_of(n for n, one in enumerate(nodes) if isinstance(one.leaf, Lapsed))
        yield array("int32_t", "lapsed", lapsed)
        yield f"#define LAPSED_COUNT {len(lapsed)}"
        inside = Names(self.plan, captured="values[{}]", payload="field_of(m, {}, {})")
        yield ""
        yield "/* The values that an attempt captures which begins at the position of a monitor. */"
        yield "static void capture(const monitor *m, double *values)"
        yield "{"
        for capture in self.requirement.captures:
            value = number_value(inside, capture.value)
            yield f"    {inside.captured(capture.name)} = {value};"
        yield "    (void)m;"
        yield "}"


def _consequent(rule: PlannedRule) -> Iterator[State]:
    """The state formulas of an attempt."""
    yield from rule.alphabet.propositions
    named = [rule.again, rule.unborn]
    if rule.requirement.mode is Mode.WHENEVER:
        named += [rule.trigger, rule.running]
    yield from (state for state in named if state is not None)
