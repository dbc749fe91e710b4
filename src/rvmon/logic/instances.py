"""What the instances of a `for each`, and attempts with captured values, depend on."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from rvmon.logic.state_formula import Lapsed, Leaf, State, StateOp, events_of
from rvmon.logic.state_graph import Graph, captured_names
from rvmon.spec.checked.formula import Captured, Compare, CompareOp, EventAtom, FieldValue
from rvmon.spec.checked.specification import ForEach


@dataclass(frozen=True, slots=True)
class Reach:
    """What an instance depends on; worked out once for a requirement.

    Attributes:
        own: the nodes whose value depends on the instance's, or that read its event.
        fields: by event, the field that has to have the value; else it does not concern it.
        others: the names that concern all instances.
        is_fresh: whether one can be made from what an instance of no value remembers.
        begins: whether nothing starts in it but where its event occurs.
    """

    own: frozenset[int]
    fields: Mapping[str, FieldValue]
    others: frozenset[str]
    is_fresh: bool
    begins: bool


def reach_of(graph: Graph, each: ForEach, trigger: State | None, *, looks_back: bool) -> Reach:
    """What the instances of a requirement depend on.

    Occurrences of its event that an instance of no value sees are unknown, and so are comparisons
    of their fields, with whatever value.
    """
    event = each.value.event
    leaves = {place: state.leaf for place, state in enumerate(graph.nodes) if state.leaf}
    reads = {place for place, leaf in leaves.items() if each.name in captured_names(leaf)}
    own = frozenset(graph.by_name.get(event, ()))
    fields = {event: each.value}
    for name, places in graph.by_name.items():
        found = {_compared(leaves[place], name, each.name) for place in places}
        field = found.pop()
        if name != event and not found and field is not None:
            fields[name] = field
    return Reach(
        above(graph, reads | own),
        fields,
        frozenset(graph.by_name.keys() - fields.keys()),
        above(graph, reads - own).isdisjoint(graph.stateful) and not looks_back,
        trigger is not None and _occurs(trigger, event),
    )


def keys_of(graph: Graph, each: ForEach, asked: Iterable[State]) -> dict[str, FieldValue]:
    """By event, the field whose value says which instance it concerns; other events concern all.

    What else is said of such an event is said together with that: wherever the field has another
    value, the conjunction is FALSE as if it did not occur.

    Args:
        graph: of the whole requirement.
        each: of that.
        asked: the state formulas of which somebody asks the values.
    """
    found = {each.value.event: each.value}
    roots = {graph.index[state] for state in asked}
    for name, places in graph.by_name.items():
        leaves = {place: graph.nodes[place].leaf for place in places}
        fields = {
            place: field
            for place, leaf in leaves.items()
            if leaf is not None and (field := _compared(leaf, name, each.name)) is not None
        }
        if name in found or len({*fields.values()}) != 1:
            continue
        parents = {one for place in leaves.keys() - fields for one in graph.parents[place]}
        alone = roots.intersection(leaves.keys() - fields) or any(
            graph.nodes[one].op is not StateOp.AND or fields.keys().isdisjoint(graph.operands[one])
            for one in parents
        )
        if not alone:
            found[name] = next(iter(fields.values()))
    return found


def varying(graph: Graph) -> frozenset[int]:
    """The nodes whose value depends on captured values, or on whether these are known."""
    leaves = {place: state.leaf for place, state in enumerate(graph.nodes) if state.leaf}
    reads = [n for n, leaf in leaves.items() if isinstance(leaf, Lapsed) or captured_names(leaf)]
    return above(graph, reads)


def above(graph: Graph, leaves: Iterable[int]) -> frozenset[int]:
    """Some nodes and all that depend on them."""
    found = set(leaves)
    for place, operands in enumerate(graph.operands):
        if not found.isdisjoint(operands):
            found.add(place)
    return frozenset(found)


def _compared(leaf: Leaf, event: str, name: str) -> FieldValue | None:
    """The field of an event that a leaf compares with a captured value, if it asks no more."""
    match leaf:
        case Compare(CompareOp.EQ, FieldValue() as field, Captured(name=found)):
            pass
        case Compare(CompareOp.EQ, Captured(name=found), FieldValue() as field):
            pass
        case _:
            return None
    return field if found == name and field.event == event else None


def _occurs(state: State, event: str) -> bool:
    """Whether a state formula is FALSE wherever an event does not occur."""
    match state.leaf:
        case None:
            pass
        case EventAtom(name=name):
            return name == event
        case Compare(left=left, right=right):
            return event in events_of(left, right)
        case _:
            return False
    match state.op:
        case StateOp.AND:
            return any(_occurs(one, event) for one in state.args)
        case StateOp.OR:
            return all(_occurs(one, event) for one in state.args)
        case StateOp.SURE | StateOp.DOUBT:
            return _occurs(state.args[0], event)
        case _:
            return False
