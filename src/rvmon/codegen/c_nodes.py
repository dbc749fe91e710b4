"""The state formulas of a plan as straight-line C, so many nodes to a function.

A node whose operand changed is worked out together with all nodes of its group: that is cheaper
than finding out which of them have to be.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from itertools import chain

from rvmon.codegen.c_leaves import node_statements, node_value
from rvmon.codegen.c_names import Names
from rvmon.formula.state import State, StateOp
from rvmon.plan.plan import Plan, PlannedRule
from rvmon.spec.checked.formula import ProbeAtom

GROUP = 32
"""Nodes of a group: what changed in one stands in a word of so many bits."""


def group_of(place: int) -> int:
    """The group of a node."""
    return place // GROUP


def group_count(plan: Plan) -> int:
    """How many groups there are; at least one."""
    return max(-(-len(plan.graph.nodes) // GROUP), 1)


def groups_of(places: Iterable[int]) -> list[int]:
    """The groups of some nodes, each once."""
    return list(dict.fromkeys(map(group_of, places)))


@dataclass(slots=True)
class _Heard:
    """Who is to hear of changes in a group, by number: of which of its nodes, as bits."""

    letters: dict[int, int] = field(default_factory=dict)
    triggers: dict[int, int] = field(default_factory=dict)
    groups: dict[int, int] = field(default_factory=dict)

    def masks(self) -> Iterator[int]:
        """All sets of nodes that somebody is to hear of."""
        return chain(self.letters.values(), self.triggers.values(), self.groups.values())


def nodes_source(plan: Plan, names: Names) -> Iterator[str]:
    """The functions of groups, and `look`, which calls that of a number."""
    heard = _heard(plan)
    momentary = momentary_counts(plan)
    guards = guards_of(plan)
    stored = _stored(plan) | set(guards)
    for place, state in enumerate(plan.graph.nodes):
        yield from _node_function(place, node_statements(names, place, state))
    for group in range(group_count(plan)):
        yield ""
        yield f"static void look{group}(monitor *m, int64_t t, uint32_t *letters, uint32_t *asked)"
        yield "{"
        yield "    uint32_t changed = 0;"
        for place in range(GROUP * group, min(GROUP * (group + 1), len(plan.graph.nodes))):
            operands = [_operand(place, one, guards) for one in plan.graph.operands[place]]
            lines = [*_node(plan, names, place, momentary[place], operands)]
            if place in stored:
                lines.append(_storing(place, heard[group]))
            if place in guards:
                lines = [*_guarded(plan, names, place, guards, lines)]
            yield from (f"    {line}" for line in lines)
        own = heard[group]
        for index, mask in own.letters.items():
            yield f"    {_listed('letters', index, mask)}"
        for index, mask in own.triggers.items():
            yield f"    {_listed('asked', index, mask)}"
        for other, mask in own.groups.items():
            yield f"    m->soiled[{other}] |= (uint8_t){_any(mask)};"
        yield "    (void)m;"
        yield "    (void)t;"
        yield "    (void)changed;"
        yield "    (void)letters;"
        yield "    (void)asked;"
        yield "}"
    yield ""
    yield "static void look(monitor *m, int32_t group, int64_t t, uint32_t *letters,"
    yield "                 uint32_t *asked)"
    yield "{"
    yield "    switch (group) {"
    for group in range(group_count(plan)):
        yield f"    case {group}: look{group}(m, t, letters, asked); break;"
    yield "    default: break;"
    yield "    }"
    yield "}"


def varying_source(plan: Plan, names: Names, places: Iterable[int]) -> Iterator[str]:
    """The function `vary`, which works out nodes that remember nothing, the others standing."""
    momentary = momentary_counts(plan)
    yield ""
    yield "/* Work out anew what depends on captured values. */"
    yield "static void vary(monitor *m, int64_t t)"
    yield "{"
    for place in sorted(places):
        operands = [f"m->truth[{operand}]" for operand in plan.graph.operands[place]]
        lines = [*_node(plan, names, place, momentary[place], operands)]
        yield from (f"    {line}" for line in lines)
        yield f"    m->truth[{place}] = n{place};"
    yield "    (void)m;"
    yield "    (void)t;"
    yield "}"


def _listed(rules: str, index: int, mask: int) -> str:
    """Add a rule to a set of rules if some node changed."""
    return f"{rules}[{index // 32}] |= (uint32_t){_any(mask)} << {index % 32}U;"


def _any(mask: int) -> str:
    return f"((changed & UINT32_C({mask:#x})) != 0U)"


def _heard(plan: Plan) -> list[_Heard]:
    graph = plan.graph
    heard = [_Heard() for _ in range(group_count(plan))]

    def note(place: int, whom: dict[int, int], number: int) -> None:
        whom[number] = whom.get(number, 0) | 1 << place % GROUP

    for place, parents in enumerate(graph.parents):
        own = heard[group_of(place)]
        for other in groups_of(parents):
            if other != group_of(place):
                note(place, own.groups, other)
    for index, (_, rule) in enumerate(plan.judges):
        for state in rule.alphabet.propositions:
            place = graph.index[state]
            note(place, heard[group_of(place)].letters, index)
        for named in (rule.trigger, rule.running):
            if named is not None:
                place = graph.index[named]
                note(place, heard[group_of(place)].triggers, index)
    return heard


def _node_function(place: int, body: list[str]) -> Iterator[str]:
    if body:
        yield ""
        yield f"static uint8_t node{place}(monitor *m, int64_t t)"
        yield "{"
        yield from (f"    {line}" for line in body)
        yield "}"


UNDETERMINED = -1
"""The guard of nodes that are asked only until triggers were true or false."""


def guards_of(plan: Plan) -> dict[int, int]:
    """The nodes that need not be worked out always: where the value of which node says so.

    What depends on a `DOUBT` alone, in its group, stays as it is where that does.
    """
    graph = plan.graph
    asked = [state for _, rule in plan.judges for state in _asked(rule)]
    needed = set()
    stack = [graph.index[state] for state in asked]
    while stack:
        place = stack.pop()
        if place not in needed:
            needed.add(place)
            stack += graph.operands[place]
    found = {place: UNDETERMINED for place in range(len(graph.nodes)) if place not in needed}
    for place, state in enumerate(graph.nodes):
        operands = graph.operands[place]
        if state.op is StateOp.DOUBT:
            found[place] = place
        elif operands:
            first = found.get(operands[0], UNDETERMINED)
            alike = all(found.get(operand) == first for operand in operands)
            if first != UNDETERMINED and alike and group_of(first) == group_of(place):
                found[place] = first
    return found


def _asked(rule: PlannedRule) -> Iterator[State]:
    """The state formulas of a rule that matter also when its trigger was true or false."""
    named = (rule.trigger, rule.again, rule.unborn, rule.running, rule.blurs)
    yield from (state for state in named if state is not None)
    yield from rule.alphabet.propositions
    yield from rule.asked


def _guarded(
    plan: Plan, names: Names, place: int, guards: dict[int, int], lines: list[str]
) -> Iterator[str]:
    """What works a node out, where that has to be.

    A `DOUBT` has to be if its trigger is or was unknown, or may be hidden in this stretch; where no
    trigger is sure, if there is one.
    """
    guard = guards[place]
    if guard == place:
        now = _operand(place, plan.graph.operands[place][0], guards)
        seen = f"m->seen[{names.memory[place]}]"
        unsure = "!= IS_FALSE" if plan.graph.nodes[place].every else "== IS_UNKNOWN"
        yield f"const bool doubt{place} = ({now} {unsure}) || ({seen} == IS_UNKNOWN)"
        yield f"                          || (m->truth[{place}] != IS_FALSE);"
    yield f"if ({'m->undetermined' if guard == UNDETERMINED else f'doubt{guard}'}) {{"
    yield from (f"    {line}" for line in lines)
    yield "}"
    if guard == place:
        yield f"{seen} = {now};"


def _operand(place: int, operand: int, guards: dict[int, int]) -> str:
    """The truth of an operand; where it is worked out always, and before, as a local."""
    local = operand not in guards and group_of(operand) == group_of(place)
    return f"n{operand}" if local else f"m->truth[{operand}]"


def _node(
    plan: Plan, names: Names, place: int, momentary: int, operands: list[str]
) -> Iterator[str]:
    state = plan.graph.nodes[place]
    text = f"node{place}(m, t)"
    if not node_statements(names, place, state):
        text = node_value(names, place, state, operands)
    yield f"const uint8_t n{place} = {text};"
    if momentary:
        yield f"if ((n{place} != IS_FALSE) && (m->momentary[{place}] != 0U)) {{"
        yield f"    m->fades[{group_of(place)}] = 1;"
        yield "    m->fading = true;"
        yield "}"


def _storing(place: int, heard: _Heard) -> str:
    if any(mask >> place % GROUP & 1 for mask in heard.masks()):
        return f"changed |= noted(m, {place}, n{place}) << {place % GROUP}U;"
    return f"m->truth[{place}] = n{place};"


def _stored(plan: Plan) -> set[int]:
    """The nodes whose truth is read elsewhere than in their group."""
    graph = plan.graph
    if any(rule.is_apart for rule in plan.rules):
        return set(range(len(graph.nodes)))  # also by `varying_source`
    found = {graph.index[state] for rule in plan.rules for state in rule.states}
    found |= set(graph.reads)  # samples are compared with the leaves
    for place, parents in enumerate(graph.parents):
        if any(group_of(parent) != group_of(place) for parent in parents):
            found.add(place)
    return found


def momentary_counts(plan: Plan) -> list[int]:
    """Per node, how many names with a source make it one that speaks of one position only."""
    graph = plan.graph
    named = Counter(place for places in needs(plan) for place in places)
    return [
        max(named[place], int(graph.reads[place].momentary)) if place in graph.reads else 0
        for place in range(len(graph.nodes))
    ]


def needs(plan: Plan) -> list[list[int]]:
    """Per name, the leaves that speak of one position if that or another one has a source."""
    graph = plan.graph
    return [
        [
            place
            for place in graph.by_name.get(name, ())
            if graph.reads[place].momentary
            and (name in plan.events or isinstance(graph.nodes[place].leaf, ProbeAtom))
        ]
        for name in (*plan.signals, *plan.events)
    ]
