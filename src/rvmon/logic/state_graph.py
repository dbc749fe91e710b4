"""The state formulas of requirements as one graph with shared nodes.

Also finds the nodes that depend on captured values, and the events that concern single instances
of a `for each`.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import assert_never

from msgspec import Struct

from rvmon.language.checked import formula as rv
from rvmon.language.checked.specification import ForEach
from rvmon.language.print import format_formula, format_numeric
from rvmon.logic import state_formula as sf


def names_of(leaf: sf.Leaf) -> frozenset[str]:
    """The signals and events whose updates can change a leaf."""
    match leaf:
        case rv.Constant() | sf.Elapsed() | sf.Lost() | sf.Lapsed() | rv.BoundAtom():
            return frozenset()
        case sf.Unborn(signals=signals):
            return frozenset(name for name, _ in signals)
        case rv.SignalAtom(name=name) | rv.EventAtom(name=name) | rv.ProbeAtom(name=name):
            return frozenset({name})
        case rv.Compare(left=left, right=right):
            return sf.inputs_of(left, right)
        case _:
            assert_never(leaf)


def captured_names(leaf: sf.Leaf) -> frozenset[str]:
    """The captured values that a leaf compares with."""
    sides = (leaf.left, leaf.right) if isinstance(leaf, rv.Compare) else ()
    captured = (part for part in rv.numbers_in(*sides) if isinstance(part, rv.Captured))
    return frozenset(part.name for part in captured)


class Graph(Struct, frozen=True, eq=False):
    """State formulas as a directed acyclic graph; a place is an index into `nodes`."""

    nodes: tuple[sf.State, ...]  # the state formulas, operands first
    index: Mapping[sf.State, int]  # the place of each state formula
    operands: tuple[tuple[int, ...], ...]  # per node, the places of its operands
    # per node, the places of the nodes that have it as an operand
    parents: tuple[tuple[int, ...], ...]
    # per signal and event, the places of the leaves that read it
    by_name: Mapping[str, tuple[int, ...]]
    stateful: tuple[int, ...]  # places of the nodes that have memory or change by time alone
    remembers_captured: bool  # whether a node with memory depends on captured values


def start_capture(state: sf.State) -> str | None:
    """The name of the captured instant at which a window starts; `None` if there is none."""
    if state.amount is None:
        return None
    starts = [part.passed for part in _members(state) if part.passed and part.passed.starts]
    return starts[0].since if len(starts) == 1 else None


def starts_with_attempt(state: sf.State) -> bool:
    """Whether a window starts at a captured instant and reads no other captured value.

    Such a window needs no memory from before its attempt.
    """
    if state.amount is None or start_capture(state) is None:
        return False
    others = [part for part in _members(state) if not (part.passed and part.passed.starts)]
    limit = rv.itself(state.amount.limit) if isinstance(state.amount, rv.Amount) else None
    others += [part for part in state.args[1:] if part.leaf is None or part.leaf != limit]
    return not any(map(_reads_captured, _all_of(others)))


def _members(state: sf.State) -> Sequence[sf.State]:
    """The conjuncts that must be true at a position for it to be a member of the window."""
    members = state.args[0]
    return members.args if members.op is sf.StateOp.AND else (members,)


def _reads_captured(state: sf.State) -> bool:
    if state.passed is not None:
        return state.passed.since is not None
    return state.leaf is not None and bool(captured_names(state.leaf))


def leaf_texts(
    roots: Sequence[sf.State], determined: Collection[sf.State]
) -> tuple[tuple[sf.State, str], ...]:
    """The leaves whose values a record shows, with their text in the language.

    Leaves that differ only before birth have the same text. The one in `lasting` represents them,
    because the core stops updating the others. `x == x` is shown as `known(x)`. If the requirement
    also reads `known(x)` itself, that leaf comes later and so takes precedence.
    """
    graph = graph_of(roots)
    last = lasting(graph, roots, determined)
    found: dict[str, dict[bool, sf.State]] = {}
    for place, state in enumerate(graph.nodes):
        above = [graph.nodes[parent].op for parent in graph.parents[place]]
        if above and all(op is sf.StateOp.COMPARED for op in above):
            continue  # the comparison above the leaf shows its value
        leaf = state.leaf or state.compared
        if isinstance(leaf, sf.Shown) and not _is_captured(leaf):
            own = found.setdefault(_text_of(leaf), {})
            is_probe = isinstance(leaf, rv.ProbeAtom)
            if is_probe not in own or place in last:
                own[is_probe] = state
    return tuple((own[is_probe], text) for text, own in found.items() for is_probe in sorted(own))


def _is_captured(leaf: sf.Shown) -> bool:
    """Whether a comparison reads neither input nor windows: captured values and constants only."""
    sides = (leaf.left, leaf.right) if isinstance(leaf, rv.Compare) else ()
    return bool(sides) and not sf.inputs_of(*sides) and not rv.windows_in(*sides)


def _text_of(leaf: sf.Shown) -> str:
    """A leaf in the language; `x == x` is `known(x)`."""
    match leaf:
        case rv.Compare(op=rv.CompareOp.EQ, left=left, right=right) if left == right:
            return f"known({format_numeric(left)})"
        case _:
            return format_formula(leaf)


def lasting(
    graph: Graph, roots: Iterable[sf.State], determined: Collection[sf.State]
) -> frozenset[int]:
    """The nodes that still matter once every signal is born and all of `determined` is TRUE."""
    settled: list[int | None] = []
    for state, operands in zip(graph.nodes, graph.operands, strict=True):
        known = (
            sf.TRUE
            if state in determined
            else _settled(state, [settled[operand] for operand in operands])
        )
        settled.append(known)
    places = (graph.index[state] for state in roots)
    stack = [place for place in places if settled[place] is None]
    needed: set[int] = set()
    while stack:
        place = stack.pop()
        if place not in needed:
            needed.add(place)
            stack += [one for one in graph.operands[place] if settled[one] is None]
    return frozenset(needed)


def _settled(state: sf.State, operands: Sequence[int | None]) -> int | None:
    """The constant truth value of a node from then on; `None` if it may still change."""
    known = [operand for operand in operands if operand is not None]
    match state.op:
        case sf.StateOp.LEAF:
            if isinstance(state.leaf, rv.Constant):
                return sf.TRUE if state.leaf.value else sf.FALSE
            if isinstance(state.leaf, sf.Lost):
                return sf.UNKNOWN
            return sf.FALSE if isinstance(state.leaf, sf.Unborn) else None
        case sf.StateOp.NOT if known:
            return sf.TRUE - known[0]
        case sf.StateOp.SURE if known:
            return sf.TRUE if known[0] == sf.TRUE else sf.FALSE
        case sf.StateOp.AND if sf.FALSE in known or len(known) == len(operands):
            return min(known)
        case sf.StateOp.OR if sf.TRUE in known or len(known) == len(operands):
            return max(known)
        case _:
            return None


def _all_of(roots: Iterable[sf.State]) -> set[sf.State]:
    """State formulas and all their subformulas."""
    seen: set[sf.State] = set()
    stack = list(roots)
    while stack:
        state = stack.pop()
        if state not in seen:
            seen.add(state)
            stack.extend(state.args)
    return seen


def graph_of(roots: Iterable[sf.State]) -> Graph:
    """The graph of the roots and all their subformulas."""
    nodes = tuple(sorted(_all_of(roots), key=lambda state: state.id))
    index = {state: place for place, state in enumerate(nodes)}
    operands = tuple(tuple(index[arg] for arg in state.args) for state in nodes)
    parents: list[list[int]] = [[] for _ in nodes]
    by_name: dict[str, list[int]] = {}
    stateful: list[int] = []
    varies: set[int] = set()
    remembers = False
    for place, state in enumerate(nodes):
        for operand in dict.fromkeys(operands[place]):
            parents[operand].append(place)
        if state.leaf is not None:
            for name in names_of(state.leaf):
                by_name.setdefault(name, []).append(place)
            if captured_names(state.leaf):
                varies.add(place)
        elif varies.intersection(operands[place]):
            varies.add(place)
        if state.op in (sf.StateOp.PREVIOUS, sf.StateOp.SINCE, sf.StateOp.AMOUNT, sf.StateOp.DOUBT):
            # Memory that reads captured values differs between attempts. Each attempt needs its
            # own from the past, unless the memory starts with the attempt.
            remembers |= place in varies and not starts_with_attempt(state)
            stateful.append(place)
        elif isinstance(state.leaf, sf.Elapsed) or state.op is sf.StateOp.PASSED:
            stateful.append(place)
    return Graph(
        nodes, index, operands, tuple(tuple(places) for places in parents),
        {name: tuple(places) for name, places in by_name.items()}, tuple(stateful), remembers,
    )  # fmt: skip


class Reach(Struct, frozen=True):
    """How the instances of a `for each` requirement depend on the input.

    The key of an instance is its value of the `for each` field.
    """

    # the nodes that depend on the key, or that read the event of the `for each`
    own: frozenset[int]
    # by event, the field that must equal the key for it to concern an instance
    fields: Mapping[str, rv.FieldValue]
    others: frozenset[str]  # the names whose updates concern all instances
    is_fresh: bool  # whether an instance can be forked from the memory of an instance without a key
    starts: bool  # whether an attempt starts only where the event of the `for each` occurs


def reach_of(graph: Graph, each: ForEach, trigger: sf.State | None, *, looks_back: bool) -> Reach:
    """The dependencies of the instances of a requirement.

    For an instance without a key, occurrences of the event are unknown, and so are comparisons of
    its fields with any value.
    """
    event = each.value.event
    leaves = {place: state.leaf for place, state in enumerate(graph.nodes) if state.leaf}
    reads = {place for place, leaf in leaves.items() if each.name in captured_names(leaf)}
    own = frozenset(graph.by_name.get(event, ()))
    fields = {event: each.value}
    for name, places in graph.by_name.items():
        # If all leaves over an event compare the same field with the key, an occurrence concerns
        # only the instance with that key.
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


def keys_of(graph: Graph, each: ForEach, used: Iterable[sf.State]) -> dict[str, rv.FieldValue]:
    """By event, the field that selects the instance it concerns; other events concern all.

    `used` are the state formulas whose values are used; a bare leaf among them must be exact.

    An event has such a field if every leaf over it compares the field with the key, or is conjoined
    with a leaf that does: for any other instance the conjunction is FALSE, as without the event.
    """
    found = {each.value.event: each.value}
    roots = {graph.index[state] for state in used}
    for name, places in graph.by_name.items():
        leaves = {place: graph.nodes[place].leaf for place in places}
        fields = {
            place: field
            for place, leaf in leaves.items()
            if leaf is not None and (field := _compared(leaf, name, each.name)) is not None
        }
        if name in found or len({*fields.values()}) != 1:
            continue
        # A leaf over the event that is not compared with the key is harmless if each node above it
        # conjoins it with one that is.
        parents = {one for place in leaves.keys() - fields for one in graph.parents[place]}
        alone = roots.intersection(leaves.keys() - fields) or any(
            graph.nodes[parent].op is not sf.StateOp.AND
            or fields.keys().isdisjoint(graph.operands[parent])
            for parent in parents
        )
        if not alone:
            found[name] = next(iter(fields.values()))
    return found


def varying(graph: Graph) -> frozenset[int]:
    """The nodes that depend on captured values, or on whether these are still certain."""
    leaves = {place: state.leaf for place, state in enumerate(graph.nodes) if state.leaf}
    reads = [n for n, leaf in leaves.items() if isinstance(leaf, sf.Lapsed) or captured_names(leaf)]
    return above(graph, reads)


def above(graph: Graph, leaves: Iterable[int]) -> frozenset[int]:
    """The given nodes and all nodes that depend on them."""
    found = set(leaves)
    for place, operands in enumerate(graph.operands):
        if not found.isdisjoint(operands):
            found.add(place)
    return frozenset(found)


def _compared(leaf: sf.Leaf, event: str, name: str) -> rv.FieldValue | None:
    """The field of an event if the leaf is `event.field == name`, for a captured `name`."""
    match leaf:
        case rv.Compare(
            rv.CompareOp.EQ, rv.FieldValue() as field, rv.Captured(name=found)
        ) | rv.Compare(rv.CompareOp.EQ, rv.Captured(name=found), rv.FieldValue() as field) if (
            found == name and field.event == event
        ):
            return field
        case _:
            return None


def _occurs(state: sf.State, event: str) -> bool:
    """Whether a state formula is FALSE wherever an event does not occur."""
    match state.leaf:
        case None:
            pass
        case rv.EventAtom(name=name):
            return name == event
        case rv.Compare(left=left, right=right):
            return event in sf.events_of(left, right)
        case _:
            return False
    match state.op:
        case sf.StateOp.AND:
            return any(_occurs(arg, event) for arg in state.args)
        case sf.StateOp.OR:
            return all(_occurs(arg, event) for arg in state.args)
        case sf.StateOp.SURE | sf.StateOp.DOUBT:
            return _occurs(state.args[0], event)
        case _:
            return False
