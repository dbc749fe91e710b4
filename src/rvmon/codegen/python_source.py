"""A plan as the source of a Python class."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rvmon.codegen.grown import last_values
from rvmon.codegen.python_class import listed, node_constants, node_functions, slots, takes
from rvmon.codegen.python_intake import IntakeWriter
from rvmon.codegen.python_leaf_cases import ConeWriter
from rvmon.codegen.python_nodes import NodeWriter, is_queued, roles_of
from rvmon.codegen.python_visit import VisitWriter, indented, is_straight
from rvmon.diagnostics.comment import comment
from rvmon.formula.state import State
from rvmon.plan.plan import Plan, PlannedRule
from rvmon.runtime.solo import only_location
from rvmon.runtime.table_machine import tables_of
from rvmon.spec.checked.specification import Mode

_TABULATED = 5
"""The letters of so many propositions stand in a table."""


def unit_source(plan: Plan, arriving: frozenset[str] | None = None) -> str:
    """The source of a class `Generated(Unit)`.

    All that comes from the specification stands in it as a literal of `repr`, as a number, as an
    operator of a fixed list, or in a comment that it cannot end.

    Args:
        plan: what to judge.
        arriving: the names that have a source; default all.
    """
    return "\n".join(_Writer(plan, arriving).lines()) + "\n"


class _Writer:
    def __init__(self, plan: Plan, arriving: frozenset[str] | None) -> None:
        self.plan = plan
        self.roles = roles_of(plan, {})
        names = (*plan.signals, *plan.events)
        present = tuple(name for name in names if arriving is None or name in arriving)
        self.judges = [
            *(_judge(rule) for rule in plan.rules),
            *("Rule" for rule in plan.rules if rule.hidden is not None),
        ]
        calm = all(judge == "SoloRule" for judge in self.judges)
        last = last_values(plan)
        roles = roles_of(plan, last, self.roles)
        queued = is_queued(plan, roles)
        later = NodeWriter(plan, roles if is_straight(roles) else self.roles, last, queued=queued)
        nodes = NodeWriter(plan, self.roles, {}, queued=queued)
        self.visit = VisitWriter(plan, nodes, later, calm=calm)
        self.cones = ConeWriter(plan, self.visit.grown, self.visit)
        self.intake = IntakeWriter(plan, self.visit, self.cones, present)

    def lines(self) -> Iterator[str]:
        yield from node_functions(self.visit.nodes)
        yield from self._letters()
        yield from self.intake.functions()
        yield "class Generated(Unit):"
        ids = ", ".join(rule.requirement.id for rule in self.plan.rules)
        yield f'    """{comment(f"Judges {ids}.")}"""'
        yield ""
        yield f"    __slots__ = {slots(self.plan)!r}"
        yield from indented(self._constants())
        yield ""
        yield from indented(self.intake.lines())
        yield from indented(takes(self.intake.values))
        yield from indented(self.intake.takers())
        yield ""
        yield from indented(self.visit.watch())
        yield from indented(self.visit.lines())
        yield from indented(["if self.growing:", "    self.grow()"], 2)
        yield ""
        yield from indented(ConeWriter(self.plan, self.visit.nodes, self.visit).looked_up())

    def _letters(self) -> Iterator[str]:
        for index, rule in enumerate(self.plan.judged):
            alphabet = rule.alphabet
            places = [self.plan.graph.index[state] for state in alphabet.propositions]
            if len(places) <= _TABULATED:
                listed = f"{tuple(alphabet.pessimistic)!r}, {tuple(alphabet.optimistic)!r}"
                yield f"LETTERS{index} = letter_table({listed})"
                yield ""
                yield ""
                yield f"def letters{index}(v):"
                yield f"    return LETTERS{index}[{_counted(places)}]"
            else:
                yield f"def letters{index}(v):"
                yield f"    worse = {_weighed(places, alphabet.pessimistic)}"
                yield f"    better = {_weighed(places, alphabet.optimistic)}"
                yield "    return worse, better"
            yield ""
            yield ""
            if rule.noted is not None and index < len(self.plan.rules):
                yield from self._noted(index, rule, rule.noted)

    def _noted(self, index: int, rule: PlannedRule, noted: Sequence[State]) -> Iterator[str]:
        """What a record keeps: what it is given, then values, since and until when they were."""
        index_of = self.plan.graph.index
        places = [index_of[state] for state in rule.alphabet.propositions]
        kept = ["seen", "t", "before", "rule.letter", "rule.other", "rule.position"]
        kept += [f"v[{index_of[state]}]" for state in noted if state in index_of]
        kept += [f"v[{place}]" for place in places] + [f"since[{place}]" for place in places]
        kept += [f"until[{3 * place + truth}]" for place in places for truth in (0, 2)]
        yield f"def noted{index}(seen, t, before, rule, v, since, until):"
        yield f"    return {listed(kept)}"
        yield ""
        yield ""

    def _constants(self) -> Iterator[str]:
        plan, roles = self.plan, self.roles
        yield from node_constants(plan, roles)
        if self.cones.joins:
            yield "ABOVE = closures(PARENTS)"
        yield f"LETTERS = {roles.letters!r}"
        yield f"TRIGGERS = {roles.triggers!r}"
        yield f"GROWING = {self.cones.growing()!r}"
        if all(rule.noted is not None for rule in plan.rules):
            yield f"NOTED = {listed(f'noted{index}' for index in range(len(plan.rules)))}"
        yield "RULES = ("
        for index, (rule, judge) in enumerate(zip(plan.judged, self.judges, strict=True)):
            hidden = index >= len(plan.rules)
            trigger = self._trigger(rule, hidden)
            yield f"    ({judge}, letters{index}, {trigger}),  # {comment(rule.requirement.id)}"
        yield ")"
        determined = [self._place(rule.determined) for rule in plan.rules]
        yield f"DETERMINED = {tuple(determined)!r}"

    def _trigger(self, rule: PlannedRule, hidden: bool) -> str:
        requirement = rule.requirement
        episodic = requirement.mode is Mode.WHENEVER
        places = f"{self._place(rule.again)}, {self._place(rule.unborn)}"
        kind = f"{requirement.pulse!r}, {episodic or hidden!r}, {hidden!r}"
        return f"{self._place(rule.trigger)}, {kind}, {places}"

    def _place(self, state: State | None) -> int:
        return -1 if state is None else self.plan.graph.index[state]


def _judge(rule: PlannedRule) -> str:
    """The class that judges a requirement."""
    if rule.requirement.mode is Mode.WHENEVER and rule.automaton is not None:
        tables = tables_of(rule.automaton)
        if only_location(tables.initial, tables.cuts, tables.bases, tables.rows) is not None:
            return "SoloRule"
    return "BulkRule" if rule.in_runs else "Rule"


def _counted(places: Sequence[int]) -> str:
    """The number of what some nodes are, counted through in threes."""
    terms = [
        f"{3**power} * v[{place}]" if power else f"v[{place}]"
        for power, place in zip(reversed(range(len(places))), places, strict=True)
    ]
    return " + ".join(terms) or "0"


def _weighed(places: Sequence[int], weights: Sequence[Sequence[int]]) -> str:
    return " + ".join(
        f"{tuple(own)!r}[v[{place}]]" for place, own in zip(places, weights, strict=True)
    )
